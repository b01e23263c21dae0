// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

/// √(1/4π): a viewer's colour is .5 + this · the constant term of its spherical harmonics.
inline constexpr double kConstantHarmonic = 0.28209479177387814;

/// The Gaussian of a kernel that viewers of splats draw.
struct SplatGaussian {
    std::array<double, 3> half_axes{};  ///< σ along each axis, world
    std::array<double, 4> rotation{};   ///< a quaternion w x y z
    double opacity = 0;                 ///< at least 1/255
    std::array<double, 3> harmonic{};   ///< the constant term of the colour of the screen
};

/// The Gaussians with the height and the integral of the kernels, and the colours of their first channel.
///
/// turn: a rotation of the world
[[nodiscard]] std::vector<SplatGaussian> splat_gaussians(const RbfVolume& volume, const TransferFunction& function,
                                                         const Mat3& turn = Mat3(1.0));

/// Those of viewers, which have no colour map: by viridis over the range of the first channel.
[[nodiscard]] std::vector<SplatGaussian> viewer_gaussians(const RbfVolume& volume, const Mat3& turn);

}  // namespace subvol::detail
