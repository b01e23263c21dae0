// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "subvol/detail/principal_axes.h"
#include "subvol/rbf_volume.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// S^(−1/2), the symmetric root: maps the frame's ellipsoid to the unit ball. A separable kernel has its axes along it.
inline Mat3 inverse_symmetric_root(const Symmetric3& frame) {
    const PrincipalAxes axes = principal_axes(frame);
    Mat3 result(0.0);
    for (int a = 0; a < 3; ++a) result += glm::outerProduct(axes.directions[a], axes.directions[a]) / axes.half_axes[a];
    return result;
}

/// A bound of how much a kernel's value differs from its middle over the support, without the moment's part: |g·d| ≤ √(gᵀSg),
/// and the Hessian's part is at most half its norm times the trace of S.
inline double value_spread(const RbfChannel& channel, std::size_t i, const Mat3& frame) {
    const auto& g = channel.gradients[i];
    const Vec3 gradient(g[0], g[1], g[2]);
    const double spread = std::sqrt(std::max(0.0, glm::dot(gradient, frame * gradient)));
    if (channel.hessians.empty()) return spread;
    const Mat3 h = matrix(channel.hessians[i]);
    const double norm = std::sqrt(glm::dot(h[0], h[0]) + glm::dot(h[1], h[1]) + glm::dot(h[2], h[2]));
    return spread + 0.5 * norm * (frame[0][0] + frame[1][1] + frame[2][2]);
}

}  // namespace subvol::detail
