// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "sharp_paths.h"
#include "surface_distances.h"
#include "surface_matrix.h"

namespace subvol::detail {

/// Draws the creases of a boundary to sharp edges of a surface.
class SharpPulls {
public:
    SharpPulls() = default;
    /// sharp:  referred to
    /// matrix: of the mesh whose creases the paths are, in the same order
    SharpPulls(const SharpEdges& sharp, const SharpPaths& paths, const SurfaceMatrix& matrix);

    /// Distances of the boundary's points on creases, across the curves, and of those at corners, along the axes.
    ///
    /// weight: of each point
    [[nodiscard]] std::vector<Pull> pulls(const std::vector<Vec3>& boundary, double weight) const;

    /// The distances of the points on creases from the curves: root mean square and largest.
    [[nodiscard]] std::array<double, 2> error(const std::vector<Vec3>& boundary) const;

private:
    struct OnCurve {
        Index row;
        Index curve;
    };

    const SharpEdges* sharp_ = nullptr;
    std::deque<CurveTree> curves_;
    std::vector<OnCurve> on_curves_;
    std::vector<std::pair<Index, Index>> corners_;  // rows and corners
};

}  // namespace subvol::detail
