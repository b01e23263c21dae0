// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "step_table.h"

#include <algorithm>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "step_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void apply_rows(const StepTable& table, std::span<const std::uint16_t> rows, std::size_t stride, const double* HWY_RESTRICT in,
                StepRows& to) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    for (const std::uint16_t row : rows) {
        if (to.marks[row] == to.mark) continue;
        to.marks[row] = to.mark;
        for (std::size_t block = 0; block < stride; block += step) {
            const double* HWY_RESTRICT from = in + block;
            const std::uint16_t* HWY_RESTRICT column = table.columns.data() + table.column_begins[row];
            auto sum = hn::Zero(d);
            for (std::size_t run = table.run_begins[row]; run < table.run_begins[row + 1U]; ++run) {
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
            hn::StoreU(sum, d, &to.values[row * stride + block]);
        }
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(apply_rows);

void StepTable::add(const StencilRuns& row) {
    for (const auto& [weight, count] : row.runs) {
        weights.push_back(weight);
        counts.push_back(static_cast<std::uint16_t>(count));
    }
    for (const Index p : row.points) columns.push_back(static_cast<std::uint16_t>(p));
    run_begins.push_back(static_cast<std::uint32_t>(weights.size()));
    column_begins.push_back(static_cast<std::uint32_t>(columns.size()));
}

std::size_t StepTable::bytes() const {
    return 8 * (run_begins.size() + weights.size()) + 2 * (counts.size() + columns.size());
}

void StepRows::begin(const StepTable& table, std::size_t stride) {
    if (values.size() < table.rows() * stride) values.resize(table.rows() * stride);
    if (marks.size() < table.rows()) marks.resize(table.rows(), 0);
    if (++mark == 0) {
        std::fill(marks.begin(), marks.end(), 0);
        mark = 1;
    }
}

void apply_step(const StepTable& table, std::span<const std::uint16_t> rows, std::size_t stride, const double* in,
                StepRows& to) {
    HWY_DYNAMIC_DISPATCH(apply_rows)(table, rows, stride, in, to);
}

}  // namespace subvol::detail
#endif
