// SPDX-License-Identifier: Apache-2.0
#include "sharp_pulls.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "subvol/detail/across.h"

namespace subvol::detail {

SharpPulls::SharpPulls(const SharpEdges& sharp, const SharpPaths& paths, const SurfaceMatrix& matrix) : sharp_(&sharp) {
    for (const SharpCurve& curve : sharp.curves) curves_.emplace_back(curve);
    std::set<Index> known;
    for (const auto& [point, corner] : paths.corners) {
        const Index row = matrix.row_of(point);
        corners_.emplace_back(row, corner);
        known.insert(row);
    }
    for (std::size_t k = 0; k < paths.creases.size(); ++k) {
        for (const Index row : matrix.crease_rows()[k]) {
            if (known.insert(row).second) on_curves_.push_back({row, paths.curves[k]});
        }
    }
}

std::vector<Pull> SharpPulls::pulls(const std::vector<Vec3>& boundary, double weight) const {
    std::vector<Pull> made;
    const auto add = [&](Index row, const Vec3& direction, const Vec3& off) {
        made.push_back({{row, row, row}, {1, 0, 0}, direction, glm::dot(direction, off), weight});
    };
    for (const OnCurve& at : on_curves_) {
        const Vec3& x = boundary[at.row];
        const CurvePlace place = curves_[at.curve].nearest(x);
        const Vec3 off = x - place.point;
        for (const Vec3& direction : across(place.along)) add(at.row, direction, off);
        if (place.end) add(at.row, place.along, off);
    }
    for (const auto& [row, corner] : corners_) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 direction(0.0);
            direction[axis] = 1;
            add(row, direction, boundary[row] - sharp_->corners[corner]);
        }
    }
    return made;
}

std::array<double, 2> SharpPulls::error(const std::vector<Vec3>& boundary) const {
    double sum = 0, most = 0;
    const auto add = [&](double distance) {
        sum += distance * distance;
        most = std::max(most, distance);
    };
    for (const OnCurve& at : on_curves_) {
        add(glm::distance(boundary[at.row], curves_[at.curve].nearest(boundary[at.row]).point));
    }
    for (const auto& [row, corner] : corners_) add(glm::distance(boundary[row], sharp_->corners[corner]));
    const std::size_t count = on_curves_.size() + corners_.size();
    return {count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0, most};
}

}  // namespace subvol::detail
