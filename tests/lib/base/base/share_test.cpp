// SPDX-License-Identifier: Apache-2.0
#include "subvol/share.h"

#include <gtest/gtest.h>

#include <vector>

#include "subvol/error.h"

namespace subvol {
namespace {

TEST(Shares, HaveEachThingOnce) {
    for (const std::size_t things : {0u, 1u, 5u, 12u, 100u}) {
        for (const int count : {1, 2, 3, 7, 12}) {
            std::size_t next = 0;
            for (int number = 1; number <= count; ++number) {
                const auto [begin, end] = Share{number, count}.range(things);
                EXPECT_EQ(begin, next);
                EXPECT_LE(end - begin, things / static_cast<std::size_t>(count) + 1);
                next = end;
            }
            EXPECT_EQ(next, things);
        }
    }
}

TEST(Shares, OfLayersWeighAboutTheSame) {
    const std::vector<double> weights{1, 1, 1, 5, 1, 1, 2, 0, 4};  // 16
    std::size_t next = 0;
    for (int number = 1; number <= 4; ++number) {
        const auto [begin, end] = Share{number, 4}.range_by_weight(weights);
        EXPECT_EQ(begin, next);
        double weight = 0;
        for (std::size_t layer = begin; layer < end; ++layer) weight += weights[layer];
        EXPECT_NEAR(weight, 4, 2.5);  // half of the heaviest layer
        next = end;
    }
    EXPECT_EQ(next, weights.size());
}

TEST(Shares, MayHaveNoLayer) {
    const std::vector<double> one{3};
    std::size_t layers = 0;
    for (int number = 1; number <= 5; ++number) {
        const auto [begin, end] = Share{number, 5}.range_by_weight(one);
        layers += end - begin;
    }
    EXPECT_EQ(layers, 1u);
    const auto [begin, end] = Share{1, 2}.range_by_weight({});
    EXPECT_EQ(begin, end);
}

TEST(Shares, ThatDoNotExistAreRefused) {
    EXPECT_NO_THROW(validate({4, 4}));
    EXPECT_THROW(validate({5, 4}), Error);
    EXPECT_THROW(validate({0, 4}), Error);
    EXPECT_THROW(validate({1, 0}), Error);
}

}  // namespace
}  // namespace subvol
