// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/points_range.h"

#include <gtest/gtest.h>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"

namespace subvol {
namespace points_range_test {

RbfVolume ball() {
    return sample_rbf_points(make_model("ball", 2), {.correction = Correction::Full}).volume;
}

TEST(PointsRange, RangesPutTogetherAreTheWhole) {
    const RbfVolume whole = ball();
    const std::string bytes = detail::bytes_of_kernels(whole, true);
    ASSERT_FALSE(whole.channels.front().hessians.empty());
    for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, whole.size() / 2, whole.size()}) {
        RbfVolume joined = detail::kernels_between(whole, 0, cut);
        detail::append_kernels(joined, detail::kernels_between(whole, cut, whole.size()));
        EXPECT_EQ(detail::bytes_of_kernels(joined, true), bytes) << cut;
    }
}

TEST(PointsRange, OnlyTheFirstHasTheBoundary) {
    const RbfVolume whole = ball();
    EXPECT_FALSE(detail::kernels_between(whole, 0, 1).boundary.triangles.empty());
    EXPECT_TRUE(detail::kernels_between(whole, 1, whole.size()).boundary.triangles.empty());
}

TEST(PointsRange, ChosenKernelsKeepTheirNumbers) {
    const RbfVolume whole = ball();
    const std::vector<std::size_t> numbers{1, 4, 5};
    const RbfVolume some = detail::chosen_kernels(whole, numbers);
    ASSERT_EQ(some.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(some.centers[i], whole.centers[numbers[i]]);
        EXPECT_EQ(some.channels.front().hessians[i], whole.channels.front().hessians[numbers[i]]);
    }
}

TEST(PointsRange, KeptKernelsAreTheChosenOnes) {
    RbfVolume kept = ball();
    // A channel has what was computed for it: one without gradients stays without.
    kept.channels.push_back({.name = "values alone", .values = kept.channels.front().values});
    const RbfVolume whole = kept;
    const std::vector<std::size_t> places{0, 2, 3, whole.size() - 1};
    detail::keep_kernels(kept, places);
    RbfVolume chosen = detail::chosen_kernels(whole, places);
    EXPECT_EQ(kept.centers, chosen.centers);
    EXPECT_EQ(kept.frames, chosen.frames);
    EXPECT_EQ(kept.boundary.points, whole.boundary.points);
    for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_EQ(kept.channels[c].values, chosen.channels[c].values);
        EXPECT_EQ(kept.channels[c].gradients, chosen.channels[c].gradients);
        EXPECT_EQ(kept.channels[c].moments, chosen.channels[c].moments);
        EXPECT_EQ(kept.channels[c].hessians, chosen.channels[c].hessians);
    }
    EXPECT_TRUE(kept.channels[1].gradients.empty());
}

TEST(PointsRange, NothingKeptIsNothing) {
    RbfVolume kept = ball();
    detail::keep_kernels(kept, {});
    EXPECT_EQ(kept.size(), 0U);
    EXPECT_TRUE(kept.channels.front().hessians.empty());
}

TEST(PointsRange, OtherChannelsAreNotAppended) {
    RbfVolume a = ball(), b = a;
    b.channels.front().name = "other";
    EXPECT_THROW(detail::append_kernels(a, b), Error);
}

TEST(KernelBytes, AreRefusedIfTheyEndEarly) {
    const std::string bytes = detail::bytes_of_kernels(ball(), true);
    EXPECT_EQ(detail::bytes_of_kernels(detail::kernels_from_bytes(bytes), true), bytes);
    for (const std::size_t size : {std::size_t{0}, std::size_t{7}, bytes.size() / 2, bytes.size() - 1}) {
        EXPECT_THROW((void)detail::kernels_from_bytes(bytes.substr(0, size)), Error) << size;
    }
}

}  // namespace points_range_test
}  // namespace subvol
