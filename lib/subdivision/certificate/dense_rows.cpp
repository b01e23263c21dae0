// SPDX-License-Identifier: Apache-2.0
// Eight rows at a time: their sums stay in registers, so each weight is loaded once.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "dense_rows.h"

#include <algorithm>

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

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(multiply_block);

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

}  // namespace subvol::detail
#endif
