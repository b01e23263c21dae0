// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// A kernel, or several, as a distribution in space: that of the cells of one sample interval that the kernels stand for.
struct Moments {
    double mass = 0;
    Vec3 center{0.0};
    Mat3 covariance{0.0};
};

/// value + gradient·d + ½ dᵀ bend d about a centre.
struct Quadratic {
    double value = 0;
    Vec3 gradient{0.0};
    Mat3 bend{0.0};

    [[nodiscard]] double at(const Vec3& d) const { return value + glm::dot(gradient + 0.5 * (bend * d), d); }
    [[nodiscard]] Vec3 gradient_at(const Vec3& d) const { return gradient + bend * d; }
};

/// radius: the support of the kernel, in sample intervals
[[nodiscard]] Moments moments_of(const Vec3& center, const Symmetric3& frame, double radius);

[[nodiscard]] Moments merged(std::span<const Moments> parts);

/// The frame with the shape of the covariance and the mass.
[[nodiscard]] Symmetric3 frame_of(const Moments& moments);

/// What kernel i of a volume adds to the field, about its centre.
[[nodiscard]] Quadratic quadratic_of(const RbfVolume& volume, const RbfChannel& channel, std::size_t i);

/// Stores a quadratic as that of kernel i, whose frame is set: without Hessians only its part along S⁻¹. Derivatives beyond
/// floats are left out.
void store(const Quadratic& q, const RbfVolume& volume, RbfChannel& channel, std::size_t i);

/// The quadratic about the centre of the whole that is nearest to those of the parts, in the mean of squares weighted with
/// their masses. Its mean over the parts is theirs.
///
/// full: all second derivatives; else only a multiple of S⁻¹, as of channels without Hessians
[[nodiscard]] Quadratic merged(std::span<const Moments> parts, std::span<const Quadratic> quadratics, const Moments& whole,
                               bool full);

/// A bound of |a(x) − b(x)| in a box.
[[nodiscard]] double largest_difference(const Quadratic& a, const Vec3& a_center, const Quadratic& b, const Vec3& b_center,
                                        const Box& box);

}  // namespace subvol::detail
