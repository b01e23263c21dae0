// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace subvol::detail {

/// Batcher's odd-even merge sort of N elements as a list of compare-exchange steps.
///
/// source: Knuth, The Art of Computer Programming 3, 5.3.4
template <std::size_t N, class Step>
constexpr void for_each_comparator(const Step& step) {
    for (std::size_t p = 1; p < N; p *= 2) {
        for (std::size_t k = p; k >= 1; k /= 2) {
            for (std::size_t j = k % p; j + k < N; j += 2 * k) {
                for (std::size_t i = 0; i < k && i + j + k < N; ++i) {
                    if ((i + j) / (2 * p) == (i + j + k) / (2 * p)) step(i + j, i + j + k);
                }
            }
        }
    }
}

template <std::size_t N>
constexpr auto make_comparators() {
    constexpr std::size_t kCount = [] {
        std::size_t n = 0;
        for_each_comparator<N>([&](std::size_t, std::size_t) { ++n; });
        return n;
    }();
    std::array<std::pair<std::size_t, std::size_t>, kCount> list{};
    std::size_t n = 0;
    for_each_comparator<N>([&](std::size_t a, std::size_t b) { list[n++] = {a, b}; });
    return list;
}

/// Sorts a small array without branches.
template <class T, std::size_t N>
inline void sort_network(std::array<T, N>& values) {
    static constexpr auto kComparators = make_comparators<N>();
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        [[maybe_unused]] const auto exchange = [&](std::size_t a, std::size_t b) {
            const T low = std::min(values[a], values[b]), high = std::max(values[a], values[b]);
            values[a] = low;
            values[b] = high;
        };
        (exchange(kComparators[I].first, kComparators[I].second), ...);
    }
    (std::make_index_sequence<kComparators.size()>{});
}

}  // namespace subvol::detail
