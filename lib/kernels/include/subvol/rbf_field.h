// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "subvol/rbf_volume.h"

namespace subvol {

/// Where the sum of the weights is not above this there is no value, neither in a field nor in a picture.
inline constexpr double kLeastWeight = 0.02;

struct RbfFieldOptions {
    std::size_t channel = 0;             ///< which channel of the volume
    double least_weight = kLeastWeight;  ///< where the sum of the weights is not above this the field has no value
};

struct FieldJet {
    double value = 0;
    Vec3 gradient{0.0};  ///< world⁻¹
};

/// The field of an RBF volume at points: Σ wᵢ (vᵢ + gᵢ·d + mᵢ eᵢ + ½ dᵀHᵢd) / Σ wᵢ with d = x−μᵢ, eᵢ = dᵀ Sᵢ⁻¹ d, wᵢ the kernel
/// at R√eᵢ inside eᵢ < 1. The boundary is not tested.
///
/// It holds a copy of the kernels in a tree of boxes and does not refer to the volume. Kernels may differ in size and shape.
///
/// throws: Error(InvalidInput) as `validate`, if there is no such channel, or the kernel is not radial
/// cost:   about 100 bytes and 0.3 µs per kernel to build, 1 µs of one core per point where 12 kernels overlap; thread-safe;
///         sums are in the order of the tree, hence results are bitwise the same for any number of threads
/// source: docs/science.md
class RbfField {
public:
    explicit RbfField(const RbfVolume& volume, const RbfFieldOptions& options = {});
    ~RbfField();
    RbfField(RbfField&&) noexcept;
    RbfField& operator=(RbfField&&) noexcept;

    [[nodiscard]] std::optional<double> value(const Vec3& x) const;

    /// The gradient of `value` is exact for the compact kernel and by differences for others.
    [[nodiscard]] std::optional<FieldJet> value_and_gradient(const Vec3& x) const;

    /// Values at many points, in parallel; NaN where there is no value.
    [[nodiscard]] std::vector<double> evaluate(std::span<const Vec3> points) const;

private:
    struct Kernels;
    std::unique_ptr<const Kernels> kernels_;
};

}  // namespace subvol
