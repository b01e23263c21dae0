// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "step_table.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "step_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void apply_rows(const StepTable& table, std::size_t first, std::size_t last, std::size_t stride, const double* HWY_RESTRICT in,
                double* HWY_RESTRICT out) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    for (std::size_t block = 0; block < stride; block += step) {
        const double* HWY_RESTRICT from = in + block;
        std::size_t run = first == 0 ? 0 : table.run_ends[first - 1];
        const std::uint16_t* HWY_RESTRICT column = table.columns.data() + (first == 0 ? 0 : table.column_ends[first - 1]);
        for (std::size_t row = first; row < last; ++row) {
            auto sum = hn::Zero(d);
            for (; run < table.run_ends[row]; ++run) {
                const std::size_t count = table.counts[run];
                auto terms = hn::LoadU(d, from + stride * column[0]);
                auto others = hn::Zero(d);  // a second sum, as each addition waits for the one before
                std::size_t i = 1;
                for (; i + 1 < count; i += 2) {
                    terms = hn::Add(terms, hn::LoadU(d, from + stride * column[i]));
                    others = hn::Add(others, hn::LoadU(d, from + stride * column[i + 1]));
                }
                if (i < count) terms = hn::Add(terms, hn::LoadU(d, from + stride * column[i]));
                sum = hn::MulAdd(hn::Set(d, table.weights[run]), hn::Add(terms, others), sum);
                column += count;
            }
            hn::StoreU(sum, d, out + block + stride * table.points[row]);
        }
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(apply_rows);

void StepTable::add(std::size_t point, const StencilRuns& row) {
    points.push_back(static_cast<std::uint16_t>(point));
    for (const auto& [weight, count] : row.runs) {
        weights.push_back(weight);
        counts.push_back(static_cast<std::uint16_t>(count));
    }
    for (const Index p : row.points) columns.push_back(static_cast<std::uint16_t>(p));
    run_ends.push_back(static_cast<std::uint32_t>(weights.size()));
    column_ends.push_back(static_cast<std::uint32_t>(columns.size()));
}

std::size_t StepTable::bytes() const {
    return 2 * (points.size() + counts.size() + columns.size()) + 4 * (run_ends.size() + column_ends.size()) +
           8 * weights.size();
}

void apply_step(const StepTable& table, std::size_t first, std::size_t last, std::size_t stride, const double* in,
                double* out) {
    HWY_DYNAMIC_DISPATCH(apply_rows)(table, first, last, stride, in, out);
}

}  // namespace subvol::detail
#endif
