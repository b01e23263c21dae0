// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "subvol/points_io.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// The properties of a Gaussian splat, in the order of `PlySplat`.
inline constexpr std::array<std::string_view, 11> kSplatProperties{"scale_0", "scale_1", "scale_2", "rot_0",  "rot_1", "rot_2",
                                                                   "rot_3",   "opacity", "f_dc_0",  "f_dc_1", "f_dc_2"};

using PlySplat = std::array<float, kSplatProperties.size()>;

/// σ of the Gaussian with the height and the integral of the kernel, in units of the support radius.
[[nodiscard]] double gaussian_width(const Kernel& kernel);

/// For each kernel the Gaussian that viewers of splats draw: the logarithms of its axes, its rotation as a quaternion w x y z,
/// the logit of its opacity and the constant term of its colour, both of the first channel.
///
/// turn: the rotation of the world into the viewers' space
[[nodiscard]] std::vector<PlySplat> ply_splats(const RbfVolume& volume, const Mat3& turn);

/// The rotation that takes the axis to -y, which viewers of splats have at the top.
[[nodiscard]] Mat3 turn_to_viewers(UpAxis up);

}  // namespace subvol::detail
