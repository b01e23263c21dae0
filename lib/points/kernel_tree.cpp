// SPDX-License-Identifier: Apache-2.0
#include "kernel_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace subvol::detail {
namespace {

constexpr std::size_t kLeafSize = 16;
constexpr std::size_t kSerialLeaves = 256;  // subtrees below this are sorted by one thread
constexpr double kLeastPivot = 1e-12;       // of the trace of S: the square of a relative thickness

float rounded_down(double x) {
    return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

InverseRoot inverse_root(const std::array<float, 6>& frame) {
    const std::array<double, 6> s{double(frame[0]), double(frame[1]), double(frame[2]),
                                  double(frame[3]), double(frame[4]), double(frame[5])};
    const double least = std::max(kLeastPivot * (s[0] + s[3] + s[5]), std::numeric_limits<double>::min());
    // S = L Lᵀ, then A = L⁻¹.
    const double l00 = std::sqrt(std::max(s[0], least));
    const double l10 = s[1] / l00, l20 = s[2] / l00;
    const double l11 = std::sqrt(std::max(s[3] - l10 * l10, least));
    const double l21 = (s[4] - l20 * l10) / l11;
    const double l22 = std::sqrt(std::max(s[5] - l20 * l20 - l21 * l21, least));
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

KernelTree::KernelTree(std::span<const Vec3> centers, std::span<const std::array<float, 6>> frames)
    : order_(centers.size()), shapes_(centers.size()) {
    if (centers.empty()) return;
    std::size_t leaves = 1;
    while (leaves * kLeafSize < centers.size()) leaves *= 2;
    first_leaf_ = leaves - 1;
    boxes_.resize(2 * leaves - 1);
    std::iota(order_.begin(), order_.end(), Index{0});
    sort_below(centers, 0, leaves);
    tbb::parallel_for(std::size_t{0}, leaves, [&](std::size_t leaf) { fill_leaf(centers, frames, leaf); });
    for (std::size_t node = first_leaf_; node-- > 0;) {
        const FloatBox &a = boxes_[2 * node + 1], &b = boxes_[2 * node + 2];
        for (std::size_t k = 0; k < 3; ++k) {
            boxes_[node].lower[k] = std::min(a.lower[k], b.lower[k]);
            boxes_[node].upper[k] = std::max(a.upper[k], b.upper[k]);
        }
    }
}

void KernelTree::sort_below(std::span<const Vec3> centers, std::size_t begin_leaf, std::size_t leaves) {
    if (leaves == 1) return;
    const auto at = [&](std::size_t leaf) { return order_.begin() + static_cast<std::ptrdiff_t>(first_slot(leaf)); };
    const std::size_t half = leaves / 2;
    const auto first = at(begin_leaf), middle = at(begin_leaf + half), last = at(begin_leaf + leaves);
    Box box;
    for (auto i = first; i != last; ++i) box.add(centers[*i]);
    const Vec3 size = box.size();
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    std::nth_element(first, middle, last, [&](Index a, Index b) {
        return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
    });
    const auto left = [&] { sort_below(centers, begin_leaf, half); };
    const auto right = [&] { sort_below(centers, begin_leaf + half, half); };
    if (leaves > kSerialLeaves) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

void KernelTree::fill_leaf(std::span<const Vec3> centers, std::span<const std::array<float, 6>> frames, std::size_t leaf) {
    Box box;
    for (std::size_t slot = first_slot(leaf); slot < first_slot(leaf + 1); ++slot) {
        const std::size_t i = order_[slot];
        const auto& s = frames[i];
        const double trace = double(s[0]) + double(s[3]) + double(s[5]);
        // As thick as `inverse_root` makes it: each axis may have grown by its least pivot.
        const Vec3 reach = glm::sqrt(glm::max(Vec3(s[0], s[3], s[5]), Vec3(0.0)) + Vec3(3 * kLeastPivot * trace));
        shapes_[slot] = {centers[i], inverse_root(s)};
        box.add(centers[i] - reach);
        box.add(centers[i] + reach);
    }
    FloatBox& result = boxes_[first_leaf_ + leaf];
    for (int k = 0; k < 3; ++k) {
        result.lower[static_cast<std::size_t>(k)] = rounded_down(box.lower[k]);
        result.upper[static_cast<std::size_t>(k)] = rounded_up(box.upper[k]);
    }
}

}  // namespace subvol::detail
