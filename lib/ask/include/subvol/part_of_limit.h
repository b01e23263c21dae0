// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/refine.h"
#include "subvol/scheme.h"

namespace subvol {

struct PartOptions {
    SchemeOptions scheme{};  ///< scheme of the limit
    /// How far a place of the part's own limit may lie from where it lies in the whole, of the diagonal of the part's box; > 0
    double tolerance = 1e-3;
    /// The same for the values of the part's fields, as a part of their ranges in the whole mesh; > 0
    double field_tolerance = 1e-2;
    int max_levels = 2;               ///< the part is refined no further, 0 to 4
    std::size_t max_cells = 200'000;  ///< the part is not refined beyond so many cells
    Progress* progress = nullptr;
};

/// Some cells of a mesh as a mesh of its own.
struct PartOfLimit {
    HexMesh mesh;
    int levels = 0;  ///< how often it was refined before it was cut out: cells c·8^levels and on are those of the c-th cell
    /// Largest distance that was found between a place in the part's own limit and the same place in the whole
    double distance_world = 0;
    double field_change = 0;   ///< largest difference of a field's values, as a part of the field's range in the whole mesh
    double volume_change = 0;  ///< the part's own volume is larger by this than that in the whole, as a part of the latter
};

/// Some cells of a mesh with the layers of cells about them that their limit depends on.
struct PartWithHalo {
    HexMesh mesh;
    std::vector<Index> numbers;  ///< for each cell its number in the mesh, or kNone: it is one of the layers
};

/// For what takes some cells out of the limit of a mesh: the limit in these cells is that in the whole mesh.
///
/// cells: a flag for each cell
[[nodiscard]] PartWithHalo part_with_halo(const HexMesh& mesh, std::span<const std::uint8_t> cells);

/// Some cells of a mesh, refined in it, as a mesh of their own: its points are those of the whole mesh of that level, and the
/// edges where it is cut out are creases.
///
/// cells:    a flag for each cell; the descendants of the k-th one are k·8^levels to (k+1)·8^levels − 1
/// on_limit: the points are moved to where they are in the limit of the whole
/// throws:   as `refine_cells`
[[nodiscard]] HexMesh refined_part(const HexMesh& mesh, std::span<const std::uint8_t> cells, const RefineOptions& options,
                                   bool on_limit = false);

/// Takes some cells out of a mesh so that their own limit is near to what they are in the limit of the whole mesh.
///
///     ┌───┬───┬───┐      The edges where the part ends are creases, unless its boundary runs on smoothly there in the whole.
///     │   │ A │   │      What is left is compared at the vertices of the next level, in the cells at the cut: in between, the
///     ├───┼───╆━━━┪      rules of a boundary take the place of those that the cells beside it gave. Where that is too much,
///     │   │ A ┃ B ┃      the whole is refined before it is cut, so that the cut follows its limit more closely.
///     └───┴───┺━━━┛
///
/// `measure_limit`, `slice_limit`, `limit_surface` and `rasterize` take cells out of the limit of the whole mesh itself.
///
/// cells:   a flag for each cell
/// returns: all cells: the mesh itself, without its unused points
/// throws:  Error(InvalidInput) as `refine`, or for options out of range
/// cost:    some refinements of the cells at the cut, and of the part if it is refined
[[nodiscard]] PartOfLimit part_of_limit(const HexMesh& mesh, std::span<const std::uint8_t> cells,
                                        const PartOptions& options = {});

namespace detail {

/// How far a part is from where it is in the whole.
[[nodiscard]] std::string part_words(const PartOfLimit& part);

/// What a user of the part must know: that it is off by more than 1 % of its size or of its volume, and what takes it out of
/// the whole. Empty if it is not.
[[nodiscard]] std::string part_warning(const PartOfLimit& part, OptionNames names);

}  // namespace detail

}  // namespace subvol
