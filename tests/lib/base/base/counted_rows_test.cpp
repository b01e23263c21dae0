// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/counted_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

namespace subvol::detail {
namespace counted_rows_test {

// Against a stable sort, on items that come in no order and name their row.
TEST(CountedRows, AreThoseOfAStableSort) {
    constexpr std::size_t kRows = 17, kItems = 1000;
    std::vector<std::pair<std::size_t, std::string>> items;
    for (std::size_t i = 0; i < kItems; ++i) {
        const std::size_t row = i * i * 7 % kRows;
        items.emplace_back(row, std::to_string(row) + " " + std::to_string(i));
    }
    const auto rows = counted_rows<std::string>(kRows, [&](const auto& put) {
        for (const auto& [row, item] : items) put(row, item);
    });
    std::stable_sort(items.begin(), items.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ASSERT_EQ(rows.size(), kRows);
    std::size_t next = 0;
    for (std::size_t row = 0; row < kRows; ++row) {
        for (const std::string& item : rows[row]) {
            EXPECT_EQ(items[next].first, row);
            EXPECT_EQ(items[next++].second, item);
        }
    }
    EXPECT_EQ(next, kItems);
}

TEST(CountedRows, NameTheListsOfEachPoint) {
    const std::vector<std::array<Index, 3>> lists{{4, 1, 2}, {1, 4, 0}, {1, 1, 4}};
    const IndexRows rows = lists_at_points(lists, 6);
    for (Index p = 0; p < 6; ++p) {
        std::vector<Index> expected;
        for (Index i = 0; i < lists.size(); ++i) {
            for (const Index q : lists[i]) {
                if (q == p) expected.push_back(i);
            }
        }
        EXPECT_EQ(std::vector<Index>(rows[p].begin(), rows[p].end()), expected) << p;
    }
    EXPECT_EQ(counted_rows<int>(0, [](const auto&) {}).size(), 0u);
}

}  // namespace counted_rows_test
}  // namespace subvol::detail
