// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_walls.h"
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

/// A place of a surface, and the unit normal there.
struct SurfaceSample {
    Vec3 place, normal;
};

/// Places spread evenly over a surface: at equal steps of its area, in each triangle at the next of a sequence of low
/// discrepancy.
///
/// source: [roberts2018]
[[nodiscard]] std::vector<SurfaceSample> samples_on(const Surface& surface, std::size_t count);

/// Sums of distances and their squares.
struct DistanceSums {
    ShapeError error;  ///< squares instead of roots, and areas instead of parts
    std::size_t points = 0, covered = 0, places = 0, reached = 0;
    double area = 0;

    /// The roots of means.
    [[nodiscard]] ShapeError result() const;
};

/// Distances between the surface of a target and boundaries: from the points of these, and from places that are spread evenly
/// over the surface, as far as it is to be reached.
class SurfaceDistances {
public:
    /// target:   its surface is referred to; places: how many
    /// progress: asked whether the work is cancelled: what is returned then is of no use
    SurfaceDistances(const WallTarget& target, std::size_t places, const Progress* progress = nullptr);

    /// The distances from all points of a boundary, then those from all places. The weights sum to `weight`, but for distances
    /// longer than a side of the boundary, which may be to the wrong place. Points over a hole of the surface, to whose edge
    /// they are nearest, have the weight 0.
    [[nodiscard]] std::vector<Pull> pulls(const Surface& boundary, double weight) const;

    void add_errors(const Surface& boundary, DistanceSums& sums) const;

    /// A flag for each point of a boundary: whether it is over a hole of the surface, to whose edge it is nearest.
    [[nodiscard]] std::vector<std::uint8_t> over_holes(const Surface& boundary) const;

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
