// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "terminal_progress.h"

namespace subvol::cli {
namespace {

TEST(Pace, WhatIsDoneBeforeTheFirstReportIsNotTakenForIt) {
    Pace pace;
    pace.add(0, 0);
    pace.add(0.9, 0.002);  // of .9 s but for some ms it was made ready
    EXPECT_LT(pace.left(), 0);
    pace.add(1, 0.05);
    EXPECT_LT(pace.left(), 0);
    pace.add(1.4, 0.252);
    EXPECT_NEAR(pace.left(), 0.748 * 0.5 / 0.25, 1e-9);
}

TEST(Pace, AFewReportsOfLongWorkAreEnough) {
    Pace pace;
    pace.add(10, 0);
    pace.add(12, 0.1);
    EXPECT_LT(pace.left(), 0);
    pace.add(13, 0.1);
    EXPECT_NEAR(pace.left(), 27, 1e-9);  // a tenth took 3 s so far
    pace.add(14, 0.2);
    EXPECT_NEAR(pace.left(), 16, 1e-9);  // the second tenth took 2 s
}

}  // namespace
}  // namespace subvol::cli
