// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "subvol/model.h"
#include "subvol/rbf_volume.h"
#include "subvol/sample.h"

namespace subvol::test {

/// Points with nothing round about them: random centres, turned frames, all digits in use, channels with awkward names, every
/// other one with Hessians.
inline RbfVolume random_points(std::size_t count, std::size_t channels, unsigned seed = 7) {
    std::mt19937 random(seed);
    const auto number = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
    const auto single = [&] { return static_cast<float>(number()); };
    RbfVolume volume;
    volume.kernel = CompactKernel{1.43};
    for (std::size_t i = 0; i < count; ++i) {
        volume.centers.emplace_back(number() / 3, 100 + number(), 1e-3 * number());
        Mat3 j(number(), number(), number(), number(), number(), number(), number(), number(), number());
        const Mat3 s = 0.01 * (j * glm::transpose(j) + Mat3(0.05));
        volume.frames.push_back({static_cast<float>(s[0][0]), static_cast<float>(s[1][0]), static_cast<float>(s[2][0]),
                                 static_cast<float>(s[1][1]), static_cast<float>(s[2][1]), static_cast<float>(s[2][2])});
    }
    for (std::size_t c = 0; c < channels; ++c) {
        RbfChannel channel{.name = c == 0 ? "density" : c == 1 ? "Temp. <K> & \"π\"" : "3 " + std::to_string(c)};
        for (std::size_t i = 0; i < count; ++i) {
            channel.values.push_back(1e-30f * single());
            channel.gradients.push_back({single(), 1e20f * single(), single()});
            channel.moments.push_back(single());
            if (c % 2 == 0) continue;
            channel.hessians.push_back({single(), 1e10f * single(), single(), single(), single(), 1e-10f * single()});
        }
        volume.channels.push_back(std::move(channel));
    }
    for (int p = 0; p < 4; ++p) volume.boundary.points.emplace_back(number(), number(), number());
    volume.boundary.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    volume.bounds = box_of(volume);
    return volume;
}

/// A ball of the limit with the second derivatives that its sampler finds.
inline RbfVolume ball_with_hessians() {
    RbfVolume volume = sample_rbf_points(make_model("ball", 4), {.correction = Correction::Full}).volume;
    const auto& hessians = volume.channels.at(0).hessians;
    EXPECT_EQ(hessians.size(), volume.size());
    EXPECT_TRUE(std::ranges::any_of(hessians, [](const auto& h) { return h[0] != 0 && h[1] != 0 && h[5] != 0; }));
    return volume;
}

/// All but the centres, bit for bit (no number here is -0 or NaN).
inline void expect_same_but_centers(const RbfVolume& a, const RbfVolume& b) {
    EXPECT_EQ(a.frames, b.frames);
    EXPECT_EQ(to_json(a.kernel), to_json(b.kernel));  // which has every digit
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (std::size_t c = 0; c < a.channels.size(); ++c) {
        EXPECT_EQ(a.channels[c].name, b.channels[c].name);
        EXPECT_EQ(a.channels[c].values, b.channels[c].values);
        EXPECT_EQ(a.channels[c].gradients, b.channels[c].gradients);
        EXPECT_EQ(a.channels[c].moments, b.channels[c].moments);
        EXPECT_EQ(a.channels[c].hessians, b.channels[c].hessians);
    }
    EXPECT_EQ(a.boundary.points, b.boundary.points);
    EXPECT_EQ(a.boundary.triangles, b.boundary.triangles);
    const bool of_centers = a.boundary.points.empty();
    EXPECT_EQ(a.bounds.lower, of_centers ? box_of(a).lower : b.bounds.lower);
    EXPECT_EQ(a.bounds.upper, of_centers ? box_of(a).upper : b.bounds.upper);
}

}  // namespace subvol::test
