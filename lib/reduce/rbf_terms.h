// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "field_fit.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

[[nodiscard]] inline Mat3 matrix(const std::array<float, 6>& f) {
    return {Vec3(f[0], f[1], f[2]), Vec3(f[1], f[3], f[4]), Vec3(f[2], f[4], f[5])};
}

/// A slope in the world taken into a kernel's frame, h with g·d = h·(A d): h = A⁻ᵀ g = A S g.
[[nodiscard]] inline Vec3 to_frame(const std::array<float, 6>& frame, const Vec3& g) {
    return inverse_root(frame).times(matrix(frame) * g);
}

/// The terms of a channel in the kernels' frames, and back.
[[nodiscard]] std::vector<KernelTerms> terms_of(const RbfVolume& volume, const RbfChannel& channel);
void set_terms(RbfChannel& channel, std::span<const std::array<float, 6>> frames, std::span<const KernelTerms> terms);

}  // namespace subvol::detail
