// SPDX-License-Identifier: Apache-2.0
// Eight rows at a time: their sums stay in registers, so each weight is loaded once.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "dense_rows.h"

#include <algorithm>
#include <cmath>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The sums of eight rows: eight x, eight y, eight z.
void multiply_block(const double* HWY_RESTRICT weights, const double* HWY_RESTRICT vectors, std::size_t columns,
                    double* HWY_RESTRICT sums) {
    constexpr std::size_t kRows = DenseRows::kRowsTogether;
    const hn::CappedTag<double, kRows> d;
    constexpr std::size_t kStep = hn::MaxLanes(hn::CappedTag<double, kRows>()), kVectors = kRows / kStep;
    hn::Vec<decltype(d)> x[kVectors], y[kVectors], z[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) x[v] = y[v] = z[v] = hn::Zero(d);
    for (std::size_t c = 0; c < columns; ++c, weights += kRows, vectors += 3) {
        const auto vx = hn::Set(d, vectors[0]), vy = hn::Set(d, vectors[1]), vz = hn::Set(d, vectors[2]);
        for (std::size_t v = 0; v < kVectors; ++v) {
            const auto weight = hn::LoadU(d, weights + v * kStep);
            x[v] = hn::MulAdd(weight, vx, x[v]);
            y[v] = hn::MulAdd(weight, vy, y[v]);
            z[v] = hn::MulAdd(weight, vz, z[v]);
        }
    }
    for (std::size_t v = 0; v < kVectors; ++v) {
        hn::StoreU(x[v], d, sums + v * kStep);
        hn::StoreU(y[v], d, sums + kRows + v * kStep);
        hn::StoreU(z[v], d, sums + 2 * kRows + v * kStep);
    }
}

void largest_difference(const double* HWY_RESTRICT a, const double* HWY_RESTRICT b, std::size_t count,
                        double* HWY_RESTRICT most) {
    const hn::CappedTag<double, 4> d;
    constexpr std::size_t kStep = hn::MaxLanes(hn::CappedTag<double, 4>());
    auto x = hn::Zero(d), y = x, z = x;
    std::size_t k = 0;
    for (; k + kStep <= count; k += kStep, a += 3 * kStep, b += 3 * kStep) {
        hn::Vec<decltype(d)> ax, ay, az, bx, by, bz;
        hn::LoadInterleaved3(d, a, ax, ay, az);
        hn::LoadInterleaved3(d, b, bx, by, bz);
        x = hn::Max(x, hn::Abs(hn::Sub(ax, bx)));
        y = hn::Max(y, hn::Abs(hn::Sub(ay, by)));
        z = hn::Max(z, hn::Abs(hn::Sub(az, bz)));
    }
    most[0] = hn::GetLane(hn::MaxOfLanes(d, x));
    most[1] = hn::GetLane(hn::MaxOfLanes(d, y));
    most[2] = hn::GetLane(hn::MaxOfLanes(d, z));
    for (; k < count; ++k, a += 3, b += 3) {
        for (std::size_t c = 0; c < 3; ++c) most[c] = std::max(most[c], std::abs(a[c] - b[c]));
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(multiply_block);
HWY_EXPORT(largest_difference);

DenseRows::DenseRows(const Eigen::MatrixXd& matrix)
    : rows_(static_cast<std::size_t>(matrix.rows())), columns_(static_cast<std::size_t>(matrix.cols())) {
    for (std::size_t first = 0; first < rows_; first += kRowsTogether) {
        for (std::size_t c = 0; c < columns_; ++c) {
            for (std::size_t r = first; r < first + kRowsTogether; ++r) {
                blocks_.push_back(r < rows_ ? matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) : 0);
            }
        }
    }
}

void DenseRows::multiply(std::span<const Vec3> vectors, std::span<Vec3> products) const {
    const auto block = HWY_DYNAMIC_DISPATCH(multiply_block);
    const double* weights = blocks_.data();
    for (std::size_t first = 0; first < rows_; first += kRowsTogether, weights += kRowsTogether * columns_) {
        double sums[3 * kRowsTogether];
        block(weights, &vectors.front().x, columns_, sums);
        for (std::size_t r = 0; r < std::min(kRowsTogether, rows_ - first); ++r) {
            products[first + r] = {sums[r], sums[kRowsTogether + r], sums[2 * kRowsTogether + r]};
        }
    }
}

Vec3 largest_difference(std::span<const Vec3> a, std::span<const Vec3> b) {
    Vec3 most(0.0);
    if (!a.empty()) HWY_DYNAMIC_DISPATCH(largest_difference)(&a.front().x, &b.front().x, a.size(), &most.x);
    return most;
}

}  // namespace subvol::detail
#endif
