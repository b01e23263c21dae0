// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell_cutter.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// Triangles whose corners are points on edges, before and after these have been moved to the limit.
///
/// points:    in the order of their ends
/// triangles: cell by cell; hull: of each, whether it is part of the hull
/// cells:     those with triangles, ascending; ends: of each, where its triangles end
/// leads_out: the surface goes on in a cell that may not be cut
struct SurfaceSoup {
    std::vector<SurfacePoint> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::uint8_t> hull;
    std::vector<Index> cells;
    std::vector<std::size_t> ends;
    bool leads_out = false;
};

/// How far a surface is followed from the cells that are given.
///
/// follow:   into the neighbours that it leads to
/// not_into: but not into these: they are cut elsewhere
struct SurfaceReach {
    bool follow = true;
    std::span<const Index> not_into{};
};

/// Cuts a surface out of the cells of a mesh at some level, where it passes.
class SoupCutter {
public:
    /// mesh:  its first attribute is the field; without one, only hulls can be cut. It and the topology are kept by reference
    /// owned: a flag for each cell that may be cut; empty: all
    SoupCutter(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> owned, const SchemeOptions& scheme,
               Progress* progress)
        : mesh_(mesh), topology_(topology), owned_(owned), scheme_(scheme), progress_(progress) {}

    /// cells: without repetition
    [[nodiscard]] SurfaceSoup cut(const Cut& cut, int level, std::vector<Index> cells, const SurfaceReach& reach = {}) const;

    /// The cells through which the surface may pass, by the values at the vertices of level 1.
    [[nodiscard]] std::vector<Index> candidates(const Cut& cut) const;

private:
    [[nodiscard]] bool may_cut(Index cell) const { return owned_.empty() || owned_[cell] != 0; }
    [[nodiscard]] bool has_hull(Index cell) const;
    [[nodiscard]] std::vector<Index> reached(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                                             std::size_t last, const std::vector<Index>& slots, int level) const;
    void add_neighbors(Index cell, std::size_t side, const std::vector<Index>& slots, std::vector<Index>& found) const;

    const HexMesh& mesh_;
    const Topology& topology_;
    std::span<const std::uint8_t> owned_;
    SchemeOptions scheme_;
    Progress* progress_;
};

}  // namespace subvol::detail
