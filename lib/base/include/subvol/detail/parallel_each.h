// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace subvol::detail {

/// Calls body(i) for every i in [0, count), in parallel.
template <class Body>
void parallel_each(std::size_t count, const Body& body) {
    constexpr std::size_t kGrain = 256;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

/// The numbers i in [0, count) for which `chosen(i)` is true, ascending; in parallel, without growing arrays. `chosen` is
/// called twice for each number and must answer both times the same. Numbers: of an array of whole numbers
template <class Numbers, class Chosen>
Numbers numbers_where(std::size_t count, const Chosen& chosen) {
    constexpr std::size_t kBlock = std::size_t{1} << 14;
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    std::vector<std::size_t> first(blocks + 1, 0);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        std::size_t found = 0;
        for (std::size_t i = b * kBlock; i < std::min(count, (b + 1) * kBlock); ++i) found += chosen(i) ? 1 : 0;
        first[b + 1] = found;
    });
    for (std::size_t b = 0; b < blocks; ++b) first[b + 1] += first[b];
    Numbers numbers(first.back());
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        std::size_t at = first[b];
        for (std::size_t i = b * kBlock; i < std::min(count, (b + 1) * kBlock); ++i) {
            if (chosen(i)) numbers[at++] = static_cast<typename Numbers::value_type>(i);
        }
    });
    return numbers;
}

}  // namespace subvol::detail
