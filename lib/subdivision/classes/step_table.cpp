// SPDX-License-Identifier: Apache-2.0
// Rows in groups of four that are summed side by side:
//
//     weights   w0  w1  w2  …                    once, if the four rows have the same weights: most rows are one of a few masks
//     columns   r0 r1 r2 r3 | r0 r1 r2 r3 | …    for each term the points of the four rows, next to each other
//     to        r0 r1 r2 r3                      the numbers of the points that the rows make
//
// Rows are sorted by their pattern of weights. Those with the same pattern form groups first; what is left, fewer than three of
// a kind, is grouped by the number of terms, and then each row has weights of its own. A row with an odd number of terms ends
// with a weight of 0, so that the loop takes two terms at a time.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "step_table.h"

#include <algorithm>
#include <tuple>
#include <type_traits>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "step_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Two sums a row, as each addition waits for the one before. Stride: a number, or a constant that the compiler knows
template <bool kSame, class Stride>
HWY_INLINE void apply_group(const StepTable::Group& group, const double* HWY_RESTRICT weights,
                            const std::uint16_t* HWY_RESTRICT columns, Stride stride, const double* HWY_RESTRICT from,
                            double* HWY_RESTRICT to) {
    const hn::CappedTag<double, 4> d;
    const std::size_t step = hn::Lanes(d);
    constexpr std::size_t kRows = StepTable::kRows;
    for (std::size_t block = 0; block < stride; block += step) {
        const double* HWY_RESTRICT in = from + block;
        const double* HWY_RESTRICT weight = weights;
        const std::uint16_t* HWY_RESTRICT column = columns;
        auto a0 = hn::Zero(d), a1 = hn::Zero(d), a2 = hn::Zero(d), a3 = hn::Zero(d);
        auto b0 = hn::Zero(d), b1 = hn::Zero(d), b2 = hn::Zero(d), b3 = hn::Zero(d);
        for (std::size_t t = 0; t < group.terms; t += 2, weight += kSame ? 2 : 2 * kRows, column += 2 * kRows) {
            const auto at = [&](std::size_t n) { return hn::LoadU(d, in + stride / 4 * column[n]); };
            const auto w = [&](std::size_t term, std::size_t row) {
                return hn::Set(d, weight[kSame ? term : term * kRows + row]);
            };
            a0 = hn::MulAdd(w(0, 0), at(0), a0);
            a1 = hn::MulAdd(w(0, 1), at(1), a1);
            a2 = hn::MulAdd(w(0, 2), at(2), a2);
            a3 = hn::MulAdd(w(0, 3), at(3), a3);
            b0 = hn::MulAdd(w(1, 0), at(4), b0);
            b1 = hn::MulAdd(w(1, 1), at(5), b1);
            b2 = hn::MulAdd(w(1, 2), at(6), b2);
            b3 = hn::MulAdd(w(1, 3), at(7), b3);
        }
        hn::StoreU(hn::Add(a0, b0), d, to + group.to[0] * stride + block);
        hn::StoreU(hn::Add(a1, b1), d, to + group.to[1] * stride + block);
        hn::StoreU(hn::Add(a2, b2), d, to + group.to[2] * stride + block);
        hn::StoreU(hn::Add(a3, b3), d, to + group.to[3] * stride + block);
    }
}

template <class Stride>
void apply_groups(std::span<const StepTable::Group> groups, const double* weights, const std::uint16_t* columns, Stride stride,
                  const double* from, double* to) {
    for (const StepTable::Group& group : groups) {
        const auto apply_one = group.same ? apply_group<true, Stride> : apply_group<false, Stride>;
        apply_one(group, weights + group.weights, columns + group.columns, stride, from, to);
    }
}

void apply(std::span<const StepTable::Group> groups, const double* weights, const std::uint16_t* columns, std::size_t stride,
           const double* from, double* to) {
    if (stride == 4) {  // positions and one value
        apply_groups(groups, weights, columns, std::integral_constant<std::size_t, 4>(), from, to);
    } else {
        apply_groups(groups, weights, columns, stride, from, to);
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(apply);

/// A row of a stencil block, read in place. terms: rounded up to an even number
struct StepTable::Source {
    std::uint16_t terms, pattern, to;
    std::span<const StencilTable::Run> runs;
    std::span<const Index> points;
};

StepTable::StepTable(const StencilTable::Block& block, std::span<const Row> rows) {
    std::vector<std::size_t> lengths;  // of the patterns
    for (std::size_t p = 0; p + 1 < block.pattern_offsets.size(); ++p) {
        std::size_t& length = lengths.emplace_back(0);
        for (std::size_t r = block.pattern_offsets[p]; r < block.pattern_offsets[p + 1]; ++r) length += block.runs[r].count;
    }
    std::vector<std::size_t> begins{0};  // of the points of each row
    for (const std::uint16_t pattern : block.row_patterns) begins.push_back(begins.back() + lengths[pattern]);

    std::vector<Source> sources;
    for (const auto& [row, to] : rows) {
        const std::uint16_t pattern = block.row_patterns[row];
        const std::size_t first = block.pattern_offsets[pattern], last = block.pattern_offsets[pattern + 1U];
        sources.push_back({static_cast<std::uint16_t>((lengths[pattern] + 1) / 2 * 2), pattern, to,
                           std::span(block.runs).subspan(first, last - first),
                           std::span(block.points).subspan(begins[row], lengths[pattern])});
    }
    std::ranges::sort(sources, {}, [](const Source& s) { return std::tuple(s.terms, s.pattern, s.to); });
    std::vector<Source> others;  // too few of a pattern
    for (std::size_t first = 0, end = 0; first < sources.size(); first = end) {
        while (end < sources.size() && sources[end].pattern == sources[first].pattern) ++end;
        for (const std::size_t weights = weights_.size(); end - first >= kRows - 1; first += std::min(kRows, end - first)) {
            add_group(std::span(sources).subspan(first, std::min(kRows, end - first)), true, weights);
        }
        for (; first < end; ++first) others.push_back(sources[first]);
    }
    for (std::size_t first = 0, end = 0; first < others.size(); first = end) {
        while (end < others.size() && end - first < kRows && others[end].terms == others[first].terms) ++end;
        add_group(std::span(others).subspan(first, end - first), false, weights_.size());
    }
    weights_.shrink_to_fit();
    columns_.shrink_to_fit();
    groups_.shrink_to_fit();
}

/// weights: where they begin, or will begin
void StepTable::add_group(std::span<const Source> rows, bool same, std::size_t weights) {
    const std::size_t terms = rows[0].terms;
    Group& group = groups_.emplace_back(Group{static_cast<std::uint32_t>(weights),
                                              static_cast<std::uint32_t>(columns_.size()),
                                              static_cast<std::uint16_t>(terms),
                                              same,
                                              {}});
    const std::size_t row_weights = same ? 1 : kRows;
    if (weights_.size() == weights) weights_.resize(weights + terms * row_weights, 0.0);
    columns_.resize(columns_.size() + terms * kRows);
    for (std::size_t r = 0; r < kRows; ++r) {
        const Source& row = rows[r < rows.size() ? r : 0];
        group.to[r] = row.to;
        for (std::size_t t = 0; t < terms; ++t) {
            const Index point = row.points[std::min(t, row.points.size() - 1)];
            columns_[group.columns + kRows * t + r] = static_cast<std::uint16_t>(4 * point);
        }
        if (r >= row_weights) continue;
        double* to = &weights_[weights + r];
        for (const auto& [weight, count] : row.runs) {
            for (std::uint32_t i = 0; i < count; ++i, to += row_weights) *to = weight;
        }
    }
}

void StepTable::apply(std::size_t stride, const double* from, double* to) const {
    HWY_DYNAMIC_DISPATCH(apply)(groups_, weights_.data(), columns_.data(), stride, from, to);
}

std::size_t StepTable::bytes() const {
    return groups_.size() * sizeof(groups_[0]) + weights_.size() * sizeof(weights_[0]) + columns_.size() * sizeof(columns_[0]);
}

}  // namespace subvol::detail
#endif
