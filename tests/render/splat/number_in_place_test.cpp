// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/number_in_place.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

namespace subvol {
namespace {

/// Some of them are there twice.
std::vector<float> many_numbers() {
    std::mt19937 random(7);
    std::vector<float> numbers{0, 0, 1, 1e-30f, 3e38f};
    for (int i = 0; i < 500; ++i) {
        numbers.push_back(std::ldexp(static_cast<float>(random() % 1000), static_cast<int>(random() % 4)));
    }
    return numbers;
}

TEST(NumberInPlace, IsThatOfTheSortedNumbers) {
    const std::vector<float> numbers = many_numbers();
    std::vector<float> sorted = numbers;
    std::ranges::sort(sorted);
    detail::FloatCounts counts;
    for (const float number : numbers) counts.add(number);
    EXPECT_EQ(counts.size(), numbers.size());
    for (std::size_t place = 0; place < sorted.size(); ++place) {
        EXPECT_EQ(detail::number_in_place(place, numbers), sorted[place]);
        if (place % 100 == 0) {
            EXPECT_EQ(counts.in_place(place), sorted[place]);
        }
    }
}

TEST(NumberInPlace, IsFoundByCountsOfAllProcesses) {
    const std::vector<float> numbers = many_numbers();
    const std::span own(numbers.data(), 100), others = std::span(numbers).subspan(100);
    // What the others count for the digits found so far, in the order of the calls.
    std::vector<std::vector<std::int64_t>> counted;
    const std::size_t place = 217;
    const float whole = detail::number_in_place(place, numbers, [&](auto& counts) { counted.push_back(counts); });
    std::size_t call = 0;
    EXPECT_EQ(detail::number_in_place(place, own, [&](auto& counts) { counts = counted[call++]; }), whole);
    call = 0;
    EXPECT_EQ(detail::number_in_place(place, others, [&](auto& counts) { counts = counted[call++]; }), whole);
    EXPECT_EQ(call, counted.size());
}

}  // namespace
}  // namespace subvol
