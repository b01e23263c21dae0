// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/limit_level.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// Layers of cells around a cell that values and gradients of its limit depend on.
inline constexpr int kHaloOfLimit = 3;

/// What tolerances of the limit are relative to.
struct LimitExtent {
    Box box{};  ///< box of the points that cells use
    /// Least and largest value of each attribute at these points, of all channels together
    std::vector<std::array<double, 2>> ranges{};
    double cell = 0;  ///< the diagonal of the largest cell's box; 0: not known

    /// The length that tolerances of positions are parts of.
    [[nodiscard]] double length() const;

    /// Adds the extent of another part of the mesh, which has the same attributes; an empty extent has none.
    void add(const LimitExtent& more);
};

[[nodiscard]] LimitExtent limit_extent(const HexMesh& mesh);
/// The length of its extent.
[[nodiscard]] double tolerance_length(const HexMesh& mesh);

/// `find_limit_cells` for some cells of a part of a mesh: they are cut as in the whole mesh, as values are compared with their
/// ranges there.
///
/// cells:  those that are cut, ascending; the others only lie around them
/// ranges: least and largest value of each attribute in the whole mesh, of all channels together
[[nodiscard]] LimitCells find_limit_cells(const HexMesh& part, std::span<const Index> cells, RefineOptions refinement,
                                          const LimitCellsOptions& options, std::span<const std::array<double, 2>> ranges);

/// `on_limit` of a part of a mesh. Points whose cells are all in the part get the bits that they have in the whole mesh.
[[nodiscard]] HexMesh on_limit_of_part(HexMesh part, Scheme scheme);

/// Some cells refined and moved to the limit: with the bits of `on_limit` of the whole mesh, refined.
///
/// mesh:    perhaps a part, with `kHaloOfLimit` layers around these cells
/// cells:   of this mesh, each once
/// returns: the descendants of cells[0], then those of cells[1], and so on
/// throws:  as `refine`
[[nodiscard]] HexMesh limit_of_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options);

}  // namespace subvol::detail
