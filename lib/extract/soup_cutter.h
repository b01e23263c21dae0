// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell_cutter.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// Triangles whose corners are points on edges, before and after these have been moved to the limit.
struct SurfaceSoup {
    std::vector<SurfacePoint> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::uint8_t> hull;  // of each triangle
    std::size_t cells = 0;
    bool leads_out = false;  // the surface goes on in a cell that may not be cut
};

/// Cuts a surface out of the cells of a mesh at some level, where it passes.
class SoupCutter {
public:
    /// mesh:  its first attribute is the field; without one, only hulls can be cut. It and the topology are kept by reference
    /// owned: a flag for each cell that may be cut; empty: all
    SoupCutter(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> owned, const SchemeOptions& scheme,
               Progress* progress)
        : mesh_(mesh), topology_(topology), owned_(owned), scheme_(scheme), progress_(progress) {}

    /// active: the control cells where the surface is; nothing before the first call for a cut
    [[nodiscard]] SurfaceSoup cut(const Cut& cut, int level, std::optional<std::vector<Index>>& active) const;

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
