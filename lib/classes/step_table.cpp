// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "step_table.h"

#include <algorithm>
#include <type_traits>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "step_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Stride: a number, or a constant that the compiler knows.
template <class Stride>
void apply_rows(const StepTable& table, std::span<const std::uint16_t> rows, Stride stride, const double* HWY_RESTRICT in,
                StepRows& to) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    const double* HWY_RESTRICT weights = table.weights.data();
    const std::uint16_t* HWY_RESTRICT columns = table.columns.data();
    const std::uint32_t* HWY_RESTRICT begins = table.begins.data();
    std::uint32_t* HWY_RESTRICT marks = to.marks.data();
    double* HWY_RESTRICT values = to.values.data();
    const std::uint32_t mark = to.mark;
    for (const std::size_t row : rows) {
        if (marks[row] == mark) continue;
        marks[row] = mark;
        const std::size_t begin = begins[row], end = begins[row + 1];
        for (std::size_t block = 0; block < stride; block += step) {
            const double* HWY_RESTRICT from = in + block;
            // Four sums, as each addition waits for the one before.
            auto a = hn::Zero(d), b = hn::Zero(d), c = hn::Zero(d), e = hn::Zero(d);
            for (std::size_t n = begin; n < end; n += StepTable::kTerms) {
                a = hn::MulAdd(hn::Set(d, weights[n]), hn::LoadU(d, from + stride * columns[n]), a);
                b = hn::MulAdd(hn::Set(d, weights[n + 1]), hn::LoadU(d, from + stride * columns[n + 1]), b);
                c = hn::MulAdd(hn::Set(d, weights[n + 2]), hn::LoadU(d, from + stride * columns[n + 2]), c);
                e = hn::MulAdd(hn::Set(d, weights[n + 3]), hn::LoadU(d, from + stride * columns[n + 3]), e);
            }
            hn::StoreU(hn::Add(hn::Add(a, b), hn::Add(c, e)), d, values + row * stride + block);
        }
    }
}

void apply(const StepTable& table, std::span<const std::uint16_t> rows, std::size_t stride, const double* in, StepRows& to) {
    if (stride == 4) {  // positions and one value
        apply_rows(table, rows, std::integral_constant<std::size_t, 4>(), in, to);
    } else {
        apply_rows(table, rows, stride, in, to);
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(apply);

void StepTable::add(const StencilRuns& row) {
    auto point = row.points.begin();
    for (const auto& [weight, count] : row.runs) {
        weights.insert(weights.end(), count, weight);
        for (std::uint32_t i = 0; i < count; ++i) columns.push_back(static_cast<std::uint16_t>(*point++));
    }
    while (weights.size() % kTerms != 0) {
        weights.push_back(0);
        columns.push_back(columns.back());
    }
    begins.push_back(static_cast<std::uint32_t>(weights.size()));
}

std::size_t StepTable::bytes() const {
    return begins.size() * sizeof(begins[0]) + weights.size() * (sizeof(weights[0]) + sizeof(columns[0]));
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
    HWY_DYNAMIC_DISPATCH(apply)(table, rows, stride, in, to);
}

}  // namespace subvol::detail
#endif
