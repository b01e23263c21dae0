// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "lib/comma_locale.h"
#include "lib/expect_error.h"
#include "subvol/camera.h"
#include "subvol/expression.h"
#include "subvol/optics.h"

namespace subvol::detail {
namespace number_text_test {

TEST(NumberText, IsThatOfPrintf) {
    EXPECT_EQ(number_text(1234567.0), "1.23457e+06");
    EXPECT_EQ(number_text(0.1 + 0.2), "0.3");
    EXPECT_EQ(number_text(-2), "-2");
    EXPECT_EQ(number_text(1. / 3, 3), "0.333");
    EXPECT_EQ(fixed_text(2.5, 2), "2.50");
    EXPECT_EQ(fixed_text(-0.004, 2), "-0.00");
    EXPECT_EQ(fixed_text(std::numeric_limits<double>::max(), 2).size(), 309U + 3);
    EXPECT_EQ(number_text(NAN), "nan");
    EXPECT_EQ(number_text(-INFINITY), "-inf");
    EXPECT_EQ(exact_text(0.1 + 0.2), "0.30000000000000004");
}

TEST(NumberText, IsReadBack) {
    for (const double x : {0.0, 0.1, -1e300, 5e-324, 1. / 3, std::numeric_limits<double>::max()})
        EXPECT_EQ(number_from(exact_text(x)), x);
    EXPECT_EQ(number_from("+3"), 3);
    EXPECT_EQ(number_from(" 1.5 "), 1.5);
    EXPECT_EQ(number_from("1e-400"), 0);
    EXPECT_EQ(number_from("-1e400"), -INFINITY);
    for (const char* wrong : {"", " ", "+", "+-1", "1,5", "1.5x", "1 2", "0x1p3"}) EXPECT_FALSE(number_from(wrong)) << wrong;
}

TEST(NumberText, HasAPointInEveryLocale) {
    const test::CommaLocale comma;
    std::ostringstream stream;
    stream << 1234.5;
    ASSERT_EQ(stream.str(), "1.234,5") << "the locale of this test has no comma";
    EXPECT_EQ(number_text(1234.5), "1234.5");
    EXPECT_EQ(fixed_text(1234.5, 2), "1234.50");
    EXPECT_EQ(exact_text(1234.5), "1234.5");
    EXPECT_EQ(number_from("1234.5"), 1234.5);
}

TEST(NumberText, TheLibraryReadsAndWritesPointsInEveryLocale) {
    const test::CommaLocale comma;
    const Camera camera = parse_camera("0.5,1.5,2.5,0,0,0,0,0,1,35.5", {});
    EXPECT_EQ(camera.eye, Vec3(0.5, 1.5, 2.5));
    EXPECT_EQ(camera.fovy_deg, 35.5);
    EXPECT_EQ(evaluate_expression("1.5*x", std::vector{Vec3(0.5, 0, 0)}).front(), 0.75);
    // Messages: by streams, and by std::to_string.
    std::vector<Vec3> points(1235, Vec3(1.0));
    points.back() = Vec3(0.0, 0.5, 0.0);
    test::expect_error(ErrorCode::InvalidInput, "at point 1234 (0, 0.5, 0)", [&] { (void)evaluate_expression("1/x", points); });
    const TransferFunction grey = transfer_function_preset("grey", 0, 1);
    test::expect_error(ErrorCode::InvalidInput, "the opacity unit is -0.5", [&] { const Optics optics(grey, -0.5); });
}

}  // namespace number_text_test
}  // namespace subvol::detail
