// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "subvol/detail/bucket_sort.h"
#include "subvol/surface.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The quad of a cell's side, counter-clockwise seen from outside, its smallest id first.
[[nodiscard]] std::array<Index, 4> outward_quad(const Topology& topology, Index cell, Index face);

/// `boundary_surface` of the faces for whose points, in any order, `where` is true. The others are not looked at.
[[nodiscard]] Surface boundary_surface_where(const HexMesh& mesh,
                                             const std::function<bool(const std::array<Index, 4>&)>& where);

/// Collects the triangles of a surface and the points of the mesh that they use, in the order of their first use.
class SurfaceBuilder {
public:
    explicit SurfaceBuilder(std::size_t mesh_points) : renumbered_(mesh_points, kNone) {}

    /// The quad's smallest id comes first.
    void add(const std::array<Index, 4>& quad) {
        const std::array<Index, 4> q{number(quad[0]), number(quad[1]), number(quad[2]), number(quad[3])};
        triangles_.push_back({q[0], q[1], q[2]});
        triangles_.push_back({q[0], q[2], q[3]});
    }

    /// The points that the quads use, in the order of the surface's.
    [[nodiscard]] const std::vector<Index>& used() const { return used_; }

    /// position(point of the mesh) is called in parallel.
    template <class Position>
    Surface finish(const Position& position) {
        Surface surface{std::vector<Vec3>(used_.size()), std::move(triangles_)};
        parallel_each(used_.size(), [&](std::size_t i) { surface.points[i] = position(used_[i]); });
        return surface;
    }

private:
    Index number(Index p) {
        if (renumbered_[p] == kNone) {
            renumbered_[p] = static_cast<Index>(used_.size());
            used_.push_back(p);
        }
        return renumbered_[p];
    }

    std::vector<Index> renumbered_, used_;
    std::vector<std::array<Index, 3>> triangles_;
};

}  // namespace subvol::detail
