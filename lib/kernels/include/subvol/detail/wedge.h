// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdlib>
#include <utility>

namespace subvol::detail {

// A function that is even and symmetric in the axes is given by its wedge i ≥ j ≥ k ≥ 0.

/// The place of a wedge's entry: i ≥ j ≥ k ≥ 0.
[[nodiscard]] constexpr std::size_t wedge_index(std::size_t i, std::size_t j, std::size_t k) {
    return i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k;
}

/// The number of entries of a wedge up to i = last.
[[nodiscard]] constexpr std::size_t wedge_size(std::size_t last) {
    return wedge_index(last + 1, 0, 0);
}

/// The place of the wedge's entry that is equal to that of any i, j, k.
[[nodiscard]] inline std::size_t wedge_index_of(int i, int j, int k) {
    auto a = static_cast<std::size_t>(std::abs(i)), b = static_cast<std::size_t>(std::abs(j)),
         c = static_cast<std::size_t>(std::abs(k));
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    return wedge_index(a, b, c);
}

/// How many places i, j, k are equal to the wedge's entry: 1 to 48.
[[nodiscard]] constexpr int wedge_multiplicity(std::size_t i, std::size_t j, std::size_t k) {
    const int orders = i == j && j == k ? 1 : i == j || j == k ? 3 : 6;
    return orders * (i > 0 ? 2 : 1) * (j > 0 ? 2 : 1) * (k > 0 ? 2 : 1);
}

/// Calls visit(i, j, k) for every entry in the wedge's order.
template <class Visit>
void each_in_wedge(std::size_t last, const Visit& visit) {
    for (std::size_t i = 0; i <= last; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            for (std::size_t k = 0; k <= j; ++k) visit(i, j, k);
        }
    }
}

}  // namespace subvol::detail
