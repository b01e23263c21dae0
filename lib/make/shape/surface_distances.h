// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "subvol/fit_shape.h"
#include "subvol/progress.h"
#include "surface_tree.h"

namespace subvol::detail {

/// A distance that should be 0: that of a place of the boundary, a sum over up to three of its points, along a direction.
struct Pull {
    std::array<Index, 3> points;
    Vec3 weights, direction;
    double distance, weight;

    /// The place, or how it moves, by the boundary's points.
    [[nodiscard]] Vec3 sum_of(const std::vector<Vec3>& boundary) const {
        Vec3 x(0.0);
        for (std::size_t i = 0; i < 3; ++i) x += weights[static_cast<int>(i)] * boundary[points[i]];
        return x;
    }
};

/// Distances between a surface and boundaries: from the points of these, and from places that are spread evenly over the
/// surface.
class SurfaceDistances {
public:
    /// surface:  referred to; places: how many
    /// progress: asked whether the work is cancelled: what is returned then is of no use
    SurfaceDistances(const Surface& surface, std::size_t places, const Progress* progress = nullptr);

    /// The distances from all points of a boundary, then those from all places. The weights sum to `weight`, but for distances
    /// longer than a side of the boundary, which may be to the wrong place. Points over a hole of the surface, to whose edge
    /// they are nearest, have the weight 0.
    [[nodiscard]] std::vector<Pull> pulls(const Surface& boundary, double weight) const;

    [[nodiscard]] ShapeError error(const Surface& boundary) const;

    /// The points and places whose distances are above `far`, but for points over holes.
    [[nodiscard]] std::vector<Vec3> places_beyond(const Surface& boundary, double far) const;

private:
    /// Whether a place lies on an edge of only one triangle.
    [[nodiscard]] bool at_hole(const SurfacePlace& place) const;

    std::vector<std::array<std::uint8_t, 3>> open_sides_;  // of each triangle
    SurfaceTree tree_;
    std::vector<Vec3> places_;
    const Progress* progress_;
};

[[nodiscard]] inline bool is_cancelled(const Progress* progress) {
    return progress != nullptr && progress->cancelled();
}

}  // namespace subvol::detail
