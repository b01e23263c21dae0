// SPDX-License-Identifier: Apache-2.0
#include "lane_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

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
    std::vector<Lanes> change(values.size());
    const int steps = conjugate_gradients(
        change, off,
        [&](std::vector<Lanes>& gradient) {
            multiply(columns, off, gradient);
            parallel_each(gradient.size(), [&](std::size_t i) {
                add_times(gradient[i], -options.tie, change[i]);
                for (std::size_t l = 0; l < kLanes; ++l) gradient[i][l] *= free[i][l];
            });
            return dot(gradient, gradient);
        },
        [&](const std::vector<Lanes>& direction, std::vector<Lanes>& image) { multiply(rows, direction, image); },
        [&](const std::vector<Lanes>& direction, const std::vector<Lanes>& image) {
            Lanes curvature = dot(image, image);
            add_times(curvature, options.tie, dot(direction, direction));
            const Lanes most = largest(off);
            for (std::size_t l = 0; l < kLanes; ++l) {
                if (!(most[l] > options.enough[l])) curvature[l] = 0;  // this lane has ended
            }
            return curvature;
        },
        [&](int step, const Lanes&) { return step < options.max_iterations; });
    parallel_each(values.size(), [&](std::size_t i) { add_times(values[i], 1.0, change[i]); });
    return steps;
}

}  // namespace subvol::detail
