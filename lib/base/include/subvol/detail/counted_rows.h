// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/detail/flat_array.h"

namespace subvol::detail {

/// Sorts items into rows by counting; those of a row keep their order.
///
/// each: each(put) calls put(row, item) for every item. It is called twice and must do the same both times.
/// cost: one thread; where many items are sorted by many threads, bucket_sort
template <class Item, class Each>
[[nodiscard]] Rows<Item> counted_rows(std::size_t rows, const Each& each) {
    Rows<Item> made;
    made.offsets.assign(rows + 1, 0);
    each([&](std::size_t row, const Item&) { ++made.offsets[row + 1]; });
    for (std::size_t row = 0; row < rows; ++row) made.offsets[row + 1] += made.offsets[row];
    made.values.resize(made.offsets.back());
    auto next = made.offsets;
    each([&](std::size_t row, const Item& item) { made.values[next[row]++] = item; });
    return made;
}

/// For each point the cells, or other lists of points, that it is in: by their numbers, ascending.
template <class Lists>
[[nodiscard]] IndexRows lists_at_points(const Lists& lists, std::size_t points) {
    return counted_rows<Index>(points, [&](const auto& put) {
        for (std::size_t i = 0; i < lists.size(); ++i) {
            for (const Index p : lists[i]) put(p, static_cast<Index>(i));
        }
    });
}

}  // namespace subvol::detail
