// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "tricubic_sums.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tricubic_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void sum(const double* HWY_RESTRICT points, const GridPoints& grid, std::size_t stride,
         const std::array<CubicWeights, 3>& weights, double scale, double* HWY_RESTRICT jet) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    const auto& [u, v, w] = weights;
    for (std::size_t block = 0; block < stride; block += step) {
        auto f = hn::Zero(d), fu = hn::Zero(d), fv = hn::Zero(d), fw = hn::Zero(d);
        const double* HWY_RESTRICT from = points + block;
        const Index* HWY_RESTRICT number = grid.data();
        for (std::size_t k = 0; k < 4; ++k) {
            auto g = hn::Zero(d), gu = hn::Zero(d), gv = hn::Zero(d);  // of a plane
            for (std::size_t j = 0; j < 4; ++j) {
                auto h = hn::Zero(d), hu = hn::Zero(d);  // of a line
                for (std::size_t i = 0; i < 4; ++i, ++number) {
                    const auto x = hn::LoadU(d, from + *number * stride);
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

HWY_EXPORT(sum);

void sum_tricubic(const double* points, const GridPoints& grid, std::size_t stride, const std::array<CubicWeights, 3>& weights,
                  double scale, double* jet) {
    HWY_DYNAMIC_DISPATCH(sum)(points, grid, stride, weights, scale, jet);
}

}  // namespace subvol::detail
#endif
