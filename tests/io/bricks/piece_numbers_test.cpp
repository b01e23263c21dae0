// SPDX-License-Identifier: Apache-2.0
#include "piece_numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace piece_numbers_test {

/// The ranks are those in a sorted set, however the numbers come.
void expect_ranks(const std::vector<std::vector<double>>& lists) {
    RanksOfNumbers ranks;
    std::set<double> sorted;
    std::size_t count = 0;
    for (const std::vector<double>& list : lists) {
        ranks.add(list);
        sorted.insert(list.begin(), list.end());
        count += list.size();
    }
    EXPECT_EQ(ranks.finish(), sorted.size() == count);
    ASSERT_EQ(ranks.size(), sorted.size());
    Index rank = 0;
    for (const double number : sorted) ASSERT_EQ(ranks.rank(number), rank++) << number;
}

TEST(RanksOfNumbers, AreThoseInASortedSet) {
    std::mt19937 dice(3);
    std::vector<double> shuffled(1000);
    for (std::size_t i = 0; i < shuffled.size(); ++i) shuffled[i] = static_cast<double>(i) - 300;
    std::ranges::shuffle(shuffled, dice);
    expect_ranks({shuffled});
    expect_ranks({{5, 6, 7}, {}, {-70, -3}, {1000, 64, 63, -64}});
    expect_ranks({{1, 2}, {2, 3}});
    expect_ranks({{1, 1}});
    expect_ranks({{1e9, 3}, {-1e9, 3e8}});                      // far apart, but not too far for flags
    expect_ranks({{7, 8, 9}, {1e15, -1e15, 8.5e15}, {1e300}});  // no longer flags
    expect_ranks({{7, 8, 9}, {1e15}, {8, 9}});
    RanksOfNumbers none;
    none.add({});
    EXPECT_TRUE(none.finish());
    EXPECT_EQ(none.size(), 0U);
}

class RanksOfPlacesTest : public test::TempFolder {};

TEST_F(RanksOfPlacesTest, PointsOfOnePieceStayApart) {
    const Vec3 a(0, 1, 2), b(3, 4, 5), c(-0.0, 1, 2), d(9, 9, 9);
    const std::vector<std::vector<Vec3>> pieces{{a, b, b}, {c, d, b, b}, {d, a}};
    RanksOfPlaces places(path(""));
    for (const auto& piece : pieces) places.add_piece(piece);
    places.finish();
    const std::vector<std::vector<Index>> expected{{0, 1, 2}, {0, 3, 1, 1}, {3, 0}};
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        std::vector<Index> ranks;
        std::vector<std::uint8_t> is_first;
        places.take_piece(pieces[k].size(), ranks, is_first);
        EXPECT_EQ(ranks, expected[k]);
        EXPECT_EQ(is_first, (std::vector<std::vector<std::uint8_t>>{{1, 1, 1}, {0, 1, 0, 0}, {0, 0}}[k]));
    }
    EXPECT_EQ(file_count(), 0U) << "its file has no name";
}

}  // namespace piece_numbers_test
}  // namespace subvol::detail
