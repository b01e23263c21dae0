// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// Some cells of a mesh with up to two layers of cells around them: all that the rules need for the next level.
///
/// Points are in the order of the whole mesh, so that every rule sums in the same order as there. Cells: first those that are
/// wanted, then the cells that share a point with them, then the cells that share a point with those.
struct Patch {
    HexMesh mesh;
    std::size_t wanted = 0;       // cells [0, wanted)
    std::size_t first_layer = 0;  // cells [wanted, first_layer)
};

/// Cuts patches out of a mesh.
class PatchSource {
public:
    /// Whether the faces of the mesh are known to have at most two cells, or are checked: a later error would name the numbers
    /// of a patch.
    enum class Faces { Check, Known };

    /// The mesh must be valid; it is kept by reference.
    ///
    /// throws: Error(InvalidInput) if more than two cells share a face, or two cells have the same corners
    explicit PatchSource(const HexMesh& mesh, Faces faces = Faces::Check);

    /// For patches of a few cells of a large mesh, whose faces are known.
    ///
    /// cells: sorted; with each cell that is to be cut all in the layers around it
    PatchSource(const HexMesh& mesh, std::span<const Index> cells);

    /// layers: 1 if the patch is refined once, else 2
    [[nodiscard]] Patch cut(std::span<const Index> cells, int layers) const;

private:
    /// Some cells and those that share a point with them, sorted.
    [[nodiscard]] std::vector<Index> cells_about(std::span<const Index> cells) const;
    [[nodiscard]] std::span<const Index> cells_at(Index point) const;

    const HexMesh& mesh_;
    std::vector<std::array<Index, 2>> creases_;      // sorted
    std::vector<std::array<Index, 4>> sharp_faces_;  // their points sorted, sorted
    std::vector<Index> points_;                      // sorted; empty: all
    FlatArray<std::size_t> offsets_;                 // cells_[offsets_[i] .. offsets_[i+1]) have point i of these
    std::vector<Index> cells_;
};

/// The next level of a patch: child 8k + j of its wanted cell k.
///
/// layers: of the child: 0 if it is not refined further, 1 if once, else 2
[[nodiscard]] Patch refine_patch(const Patch& patch, const SchemeOptions& scheme, int layers);

/// The same with the topology of the patch, interior creases ignored.
[[nodiscard]] Patch refine_patch(const Patch& patch, const Topology& topology, const SchemeOptions& scheme, int layers);

/// The children of some cells of a patch, wanted ones or of the first layer: child 8i + j of cells[i], without tags.
[[nodiscard]] HexMesh refine_cells(const Patch& patch, const Topology& topology, const SchemeOptions& scheme,
                                   std::span<const Index> cells);

/// The level-`levels` patch of some cells. Its wanted cells are the descendants of cells[0], then those of cells[1], and so on.
///
/// layers: of the result, as above
[[nodiscard]] Patch refine_patch(const PatchSource& source, std::span<const Index> cells, const SchemeOptions& scheme,
                                 int levels, int layers);

/// The patch of some of the wanted cells of another patch, which must have at least as many layers.
[[nodiscard]] Patch sub_patch(const Patch& patch, std::span<const Index> wanted, int layers);

}  // namespace subvol::detail
