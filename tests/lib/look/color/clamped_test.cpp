// SPDX-License-Identifier: Apache-2.0
#include "subvol/clamped.h"

#include <gtest/gtest.h>

#include "lib/expect_error.h"

namespace subvol {
namespace clamped_test {

TEST(Clamped, ValuesBeyondTheRangeLookLikeItsEnds) {
    const TransferFunction all{{{0, {0, 0, 0}}, {10, {1, 1, 1}}}, {{0, 0}, {5, 1}, {10, 0.2}}};
    const TransferFunction kept = clamped(all, 2, 6);
    for (const double value : {-5.0, 1.0, 2.0, 3.5, 5.0, 6.0, 9.0, 20.0}) {
        const double near = std::min(std::max(value, 2.0), 6.0);
        EXPECT_NEAR(color_at(kept, value).x, color_at(all, near).x, 1e-15) << value;
        EXPECT_NEAR(alpha_at(kept, value), alpha_at(all, near), 1e-15) << value;
    }
    EXPECT_NO_THROW(validate(kept));
    EXPECT_EQ(alpha_at(clamped(all, 5, 5), 7), 1) << "a constant field";
    test::expect_error(ErrorCode::InvalidInput, "exchanged", [&] { (void)clamped(all, 6, 2); });
}

}  // namespace clamped_test
}  // namespace subvol
