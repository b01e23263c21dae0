#pragma once

#include <array>

#include "subvol/principal_axes.h"
#include "subvol/vec.h"

namespace subvol::detail {

inline Mat3 frame_matrix(const std::array<float, 6>& f) {
    return {Vec3(f[0], f[1], f[2]), Vec3(f[1], f[3], f[4]), Vec3(f[2], f[4], f[5])};
}

/// S^(−1/2), the symmetric root: maps the frame's ellipsoid to the unit ball. A separable kernel has its axes along it.
inline Mat3 inverse_symmetric_root(const std::array<float, 6>& frame) {
    const PrincipalAxes axes = principal_axes(frame);
    Mat3 result(0.0);
    for (int a = 0; a < 3; ++a) result += glm::outerProduct(axes.directions[a], axes.directions[a]) / axes.half_axes[a];
    return result;
}

}  // namespace subvol::detail
