// SPDX-License-Identifier: Apache-2.0
// The tricubic sum of jets.cpp and its three derivatives in one pass: along lines first,
// then over the lines of a plane, then over the planes. That takes 64·2 + 16·3 + 4·4 multiplications for each channel instead
// of 64·4 with the products of all weights.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "jets.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tricubic_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// row_at: where row i + 4j + 16k begins, from i, j, k
template <class RowAt>
HWY_INLINE void sum(const RowAt& row_at, std::size_t stride, const std::array<CubicWeights, 3>& weights, double scale,
                    double* HWY_RESTRICT jet) {
    // Works on at most four channels at a time: rows are padded to a multiple of four, and a position with one field has
    // exactly four.
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    const auto& [u, v, w] = weights;
    for (std::size_t block = 0; block < stride; block += step) {
        auto f = hn::Zero(d), fu = hn::Zero(d), fv = hn::Zero(d), fw = hn::Zero(d);
        for (std::size_t k = 0; k < 4; ++k) {
            auto g = hn::Zero(d), gu = hn::Zero(d), gv = hn::Zero(d);  // of a plane
            for (std::size_t j = 0; j < 4; ++j) {
                auto h = hn::Zero(d), hu = hn::Zero(d);  // of a line
                for (std::size_t i = 0; i < 4; ++i) {
                    const auto x = hn::LoadU(d, row_at(i, j, k) + block);
                    h = hn::MulAdd(hn::Set(d, u.value[i]), x, h);
                    hu = hn::MulAdd(hn::Set(d, u.first[i]), x, hu);
                }
                const auto value = hn::Set(d, v.value[j]);
                g = hn::MulAdd(value, h, g);
                gu = hn::MulAdd(value, hu, gu);
                gv = hn::MulAdd(hn::Set(d, v.first[j]), h, gv);
            }
            const auto value = hn::Set(d, w.value[k]);
            f = hn::MulAdd(value, g, f);
            fu = hn::MulAdd(value, gu, fu);
            fv = hn::MulAdd(value, gv, fv);
            fw = hn::MulAdd(hn::Set(d, w.first[k]), g, fw);
        }
        // Derivatives by the parameters of the control cell: 2ˡ times those by the parameters of the small cell.
        const auto factor = hn::Set(d, scale);
        hn::StoreU(f, d, jet + block);
        hn::StoreU(hn::Mul(factor, fu), d, jet + stride + block);
        hn::StoreU(hn::Mul(factor, fv), d, jet + 2 * stride + block);
        hn::StoreU(hn::Mul(factor, fw), d, jet + 3 * stride + block);
    }
}

struct NumberedRows {
    const double* points;
    const Index* numbers;
    std::size_t stride;
    HWY_INLINE const double* operator()(std::size_t i, std::size_t j, std::size_t k) const {
        return points + numbers[i + 4 * j + 16 * k] * stride;
    }
};

void sum_numbered(const double* points, const GridPoints& grid, std::size_t stride, const std::array<CubicWeights, 3>& weights,
                  double scale, double* jet) {
    sum(NumberedRows{points, grid.data(), stride}, stride, weights, scale, jet);
}

/// Over 6×6×6 points: values from the inner four along each axis, a derivative from all six along its own.
void sum_block(const GridRows& grid, const std::array<WideWeights, 3>& weights, double scale, double* HWY_RESTRICT jet) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d), stride = grid.stride, along_v = grid.side * stride, along_w = grid.side * along_v;
    const WideWeights &u = weights[0], &v = weights[1], &w = weights[2];
    for (std::size_t block = 0; block < stride; block += step) {
        const double* const rows = grid.rows + block;
        const auto value_on_line = [&](std::size_t j, std::size_t k) HWY_ATTR {
            const double* const line = rows + stride + j * along_v + k * along_w;
            auto h = hn::Zero(d);
            for (std::size_t i = 0; i < 4; ++i) h = hn::MulAdd(hn::Set(d, u.value[i]), hn::LoadU(d, line + i * stride), h);
            return h;
        };
        auto f = hn::Zero(d), fu = hn::Zero(d), fv = hn::Zero(d), fw = hn::Zero(d);
        for (std::size_t k = 0; k < 6; ++k) {
            const bool inner_plane = k >= 1 && k <= 4;
            auto g = hn::Zero(d), gu = hn::Zero(d), gv = hn::Zero(d);  // of a plane
            for (std::size_t j = inner_plane ? 0 : 1; j < (inner_plane ? 6U : 5U); ++j) {
                const auto h = value_on_line(j, k);
                gv = hn::MulAdd(hn::Set(d, v.first[j]), h, gv);
                if (j < 1 || j > 4) continue;
                const auto value = hn::Set(d, v.value[j - 1]);
                g = hn::MulAdd(value, h, g);
                if (!inner_plane) continue;
                const double* const line = rows + j * along_v + k * along_w;
                auto hu = hn::Zero(d);
                for (std::size_t i = 0; i < 6; ++i)
                    hu = hn::MulAdd(hn::Set(d, u.first[i]), hn::LoadU(d, line + i * stride), hu);
                gu = hn::MulAdd(value, hu, gu);
            }
            fw = hn::MulAdd(hn::Set(d, w.first[k]), g, fw);
            if (!inner_plane) continue;
            const auto value = hn::Set(d, w.value[k - 1]);
            f = hn::MulAdd(value, g, f);
            fu = hn::MulAdd(value, gu, fu);
            fv = hn::MulAdd(value, gv, fv);
        }
        const auto factor = hn::Set(d, scale);
        hn::StoreU(f, d, jet + block);
        hn::StoreU(hn::Mul(factor, fu), d, jet + stride + block);
        hn::StoreU(hn::Mul(factor, fv), d, jet + 2 * stride + block);
        hn::StoreU(hn::Mul(factor, fw), d, jet + 3 * stride + block);
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(sum_numbered);
HWY_EXPORT(sum_block);

void sum_tricubic(const double* points, const GridPoints& grid, std::size_t stride, const std::array<CubicWeights, 3>& weights,
                  double scale, double* jet) {
    HWY_DYNAMIC_DISPATCH(sum_numbered)(points, grid, stride, weights, scale, jet);
}

void sum_tricubic(const GridRows& grid, const std::array<WideWeights, 3>& weights, double scale, double* jet) {
    HWY_DYNAMIC_DISPATCH(sum_block)(grid, weights, scale, jet);
}

}  // namespace subvol::detail
#endif
