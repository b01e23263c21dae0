// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "field_fit.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// A slope in the world taken into a kernel's frame, h with g·d = h·(A d): h = A⁻ᵀ g = A S g.
[[nodiscard]] inline Vec3 to_frame(const Symmetric3& frame, const Vec3& g) {
    return inverse_root(frame).times(matrix(frame) * g);
}

/// The terms of a channel in the kernels' frames, and back.
[[nodiscard]] std::vector<KernelTerms> terms_of(const RbfVolume& volume, const RbfChannel& channel);
void set_terms(RbfChannel& channel, std::span<const Symmetric3> frames, std::span<const KernelTerms> terms);

}  // namespace subvol::detail
