// SPDX-License-Identifier: Apache-2.0
// One row after the other: the sum of its weights times the values of sixteen cells. The
// sums of all sixteen stay in registers, so each weight is loaded once and each value once.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "subvol/detail/class_tables.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "apply_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 4>;  // four sums of four lanes, or eight of two: they all stay in registers

void apply(const WeightTable& table, const double* HWY_RESTRICT in, double* HWY_RESTRICT out) {
    const Lanes d;
    constexpr std::size_t kStep = hn::MaxLanes(Lanes()), kVectors = kTableLanes / kStep;
    for (std::size_t row = 0; row < table.rows(); ++row, out += kTableLanes) {
        hn::Vec<Lanes> sums[kVectors];
        for (auto& sum : sums) sum = hn::Zero(d);
        for (std::size_t i = table.offsets[row]; i < table.offsets[row + 1]; ++i) {
            const auto weight = hn::Set(d, table.weights[i]);
            const double* HWY_RESTRICT point = in + kTableLanes * table.columns[i];
            for (std::size_t v = 0; v < kVectors; ++v) sums[v] = hn::MulAdd(weight, hn::Load(d, point + v * kStep), sums[v]);
        }
        for (std::size_t v = 0; v < kVectors; ++v) hn::Store(sums[v], d, out + v * kStep);
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(apply);

void apply_table(const WeightTable& table, const double* in, double* out) {
    HWY_DYNAMIC_DISPATCH(apply)(table, in, out);
}

}  // namespace subvol::detail
#endif
