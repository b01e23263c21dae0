// SPDX-License-Identifier: Apache-2.0
#include "lane_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

void add(std::vector<Lanes>& to, const Lanes& factor, const std::vector<Lanes>& values) {
    parallel_each(to.size(), [&](std::size_t i) {
        for (std::size_t l = 0; l < kLanes; ++l) to[i][l] += factor[l] * values[i][l];
    });
}

void keep(std::vector<Lanes>& gradient, const std::vector<Lanes>& free) {
    parallel_each(gradient.size(), [&](std::size_t i) {
        for (std::size_t l = 0; l < kLanes; ++l) gradient[i][l] *= free[i][l];
    });
}

}  // namespace

void LaneMatrix::apply(const std::vector<Lanes>& in, std::vector<Lanes>& out) const {
    parallel_each(rows(), [&](std::size_t r) {
        Lanes sum{};
        for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k) {
            const Lanes& value = in[columns[k]];
            for (std::size_t l = 0; l < kLanes; ++l) sum[l] += static_cast<double>(weights[k]) * value[l];
        }
        out[r] = sum;
    });
}

LaneMatrix LaneMatrix::transposed(std::size_t count) const {
    LaneMatrix result;
    result.offsets.assign(count + 1, 0);
    for (const Index column : columns) ++result.offsets[column + 1];
    std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
    result.columns.resize(columns.size());
    result.weights.resize(columns.size());
    std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
    for (std::size_t r = 0; r < rows(); ++r) {
        for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k) {
            const std::size_t at = next[columns[k]]++;
            result.columns[at] = static_cast<Index>(r);
            result.weights[at] = weights[k];
        }
    }
    return result;
}

// In blocks of a fixed size, so that it does not depend on the number of threads.
Lanes dot(const std::vector<Lanes>& a, const std::vector<Lanes>& b) {
    constexpr std::size_t kBlock = 4096;
    std::vector<Lanes> sums((a.size() + kBlock - 1) / kBlock);
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t k) {
        Lanes sum{};
        for (std::size_t i = k * kBlock; i < std::min(a.size(), (k + 1) * kBlock); ++i) {
            for (std::size_t l = 0; l < kLanes; ++l) sum[l] += a[i][l] * b[i][l];
        }
        sums[k] = sum;
    });
    Lanes total{};
    for (const Lanes& sum : sums) {
        for (std::size_t l = 0; l < kLanes; ++l) total[l] += sum[l];
    }
    return total;
}

Lanes largest(const std::vector<Lanes>& values) {
    Lanes most{};
    for (const Lanes& value : values) {
        for (std::size_t l = 0; l < kLanes; ++l) most[l] = std::max(most[l], std::abs(value[l]));
    }
    return most;
}

int search(const LaneMatrix& rows, const LaneMatrix& columns, const std::vector<Lanes>& free, std::vector<Lanes>& values,
           std::vector<Lanes>& off, const LaneSearch& options) {
    std::vector<Lanes> change(values.size()), gradient(values.size()), step(values.size()), of_step(off.size());
    columns.apply(off, gradient);
    keep(gradient, free);
    step = gradient;
    Lanes size = dot(gradient, gradient);
    int iteration = 0;
    for (; iteration < options.max_iterations; ++iteration) {
        const Lanes most = largest(off);
        rows.apply(step, of_step);
        const Lanes of_steps = dot(of_step, of_step), steps = dot(step, step);
        Lanes length{}, back{}, tie{};
        bool any = false;
        for (std::size_t l = 0; l < kLanes; ++l) {
            const double curvature = of_steps[l] + options.tie * steps[l];
            if (!(most[l] > options.enough[l] && size[l] > 0 && curvature > 0)) continue;  // length 0: this lane has ended
            any = true;
            length[l] = size[l] / curvature;
            back[l] = -length[l];
            tie[l] = -options.tie;
        }
        if (!any) break;
        add(change, length, step);
        add(off, back, of_step);
        columns.apply(off, gradient);
        add(gradient, tie, change);
        keep(gradient, free);
        const Lanes next = dot(gradient, gradient);
        Lanes factor{};
        for (std::size_t l = 0; l < kLanes; ++l) {
            if (length[l] == 0) continue;
            factor[l] = next[l] / size[l];
            size[l] = next[l];
        }
        parallel_each(step.size(), [&](std::size_t i) {
            for (std::size_t l = 0; l < kLanes; ++l) step[i][l] = gradient[i][l] + factor[l] * step[i][l];
        });
    }
    add(values, {1, 1, 1, 1}, change);
    return iteration;
}

}  // namespace subvol::detail
