// SPDX-License-Identifier: Apache-2.0
#include "subvol/clamp_channel.h"

#include <gtest/gtest.h>

#include "lib/expect_error.h"

namespace subvol {
namespace clamp_channel_test {

TEST(ClampChannel, ValuesBeyondTheRangeBecomeItsEndsWithoutDerivatives) {
    RbfChannel channel{
        .name = "a", .values = {-1, 0.5, 3}, .gradients = {{1, 2, 3}, {1, 2, 3}, {4, 5, 6}}, .moments = {7, 8, 9}};
    EXPECT_EQ(clamp_channel(channel, 0, 1), 2u);
    EXPECT_EQ(channel.values, (std::vector<float>{0, 0.5f, 1}));
    EXPECT_EQ(channel.gradients[0], (std::array<float, 3>{0, 0, 0}));
    EXPECT_EQ(channel.gradients[1], (std::array<float, 3>{1, 2, 3})) << "what is within stays as it is";
    EXPECT_EQ(channel.moments, (std::vector<float>{0, 8, 0}));
    EXPECT_EQ(clamp_channel(channel, 0, 1), 0u);
    test::expect_error(ErrorCode::InvalidInput, "exchanged", [&] { clamp_channel(channel, 1, 0); });
}

}  // namespace clamp_channel_test
}  // namespace subvol
