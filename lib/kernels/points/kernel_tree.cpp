// SPDX-License-Identifier: Apache-2.0
#include "kernel_tree.h"

#include <cmath>
#include <limits>

#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"

namespace subvol::detail {
namespace {

constexpr std::size_t kLeafSize = 16;
constexpr double kLeastPivot = 1e-12;  // of the trace of S: the square of a relative thickness

float rounded_down(double x) {
    return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

void check_rbf_volume(const RbfVolume& volume) {
    if (!is_radial(volume.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial: frames define no axes for it", {}, "a radial kernel");
    }
    if (volume.size() >= kNone) {
        throw Error(ErrorCode::InvalidInput, std::to_string(volume.size()) + " kernels are too many", {}, "fewer than 2³²");
    }
    validate(volume);
}

InverseRoot inverse_root(const Symmetric3& frame) {
    const Mat3 s = matrix(frame);
    const double least = std::max(kLeastPivot * (s[0][0] + s[1][1] + s[2][2]), std::numeric_limits<double>::min());
    // S = L Lᵀ, then A = L⁻¹.
    const double l00 = std::sqrt(std::max(s[0][0], least));
    const double l10 = s[1][0] / l00, l20 = s[2][0] / l00;
    const double l11 = std::sqrt(std::max(s[1][1] - l10 * l10, least));
    const double l21 = (s[2][1] - l20 * l10) / l11;
    const double l22 = std::sqrt(std::max(s[2][2] - l20 * l20 - l21 * l21, least));
    InverseRoot result;
    auto& a = result.a;
    a[0] = 1 / l00;
    a[2] = 1 / l11;
    a[5] = 1 / l22;
    a[1] = -l10 * a[0] * a[2];
    a[4] = -l21 * a[2] * a[5];
    a[3] = -(l20 * a[0] + l21 * a[1]) * a[5];
    return result;
}

KernelTree::KernelTree(std::span<const Vec3> centers, std::span<const Symmetric3> frames)
    : tree_(centers, kLeafSize, [&](Index i) { return box_of(centers[i], frames[i]); }), shapes_(centers.size()) {
    parallel_each(shapes_.size(), [&](std::size_t slot) {
        const std::size_t i = kernel(slot);
        shapes_[slot] = {centers[i], inverse_root(frames[i])};
    });
}

/// As thick as `inverse_root` makes the ellipsoid: each axis may have grown by its least pivot.
KernelTree::FloatBox KernelTree::box_of(const Vec3& center, const Symmetric3& frame) {
    const Vec3 squares(frame[0], frame[3], frame[5]);
    const double trace = squares.x + squares.y + squares.z;
    const Vec3 reach = glm::sqrt(glm::max(squares, Vec3(0.0)) + Vec3(3 * kLeastPivot * trace));
    const Vec3 lower = center - reach, upper = center + reach;
    return {{rounded_down(lower.x), rounded_down(lower.y), rounded_down(lower.z)},
            {rounded_up(upper.x), rounded_up(upper.y), rounded_up(upper.z)}};
}

}  // namespace subvol::detail
