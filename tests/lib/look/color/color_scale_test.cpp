// SPDX-License-Identifier: Apache-2.0
#include "subvol/color_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "lib/expect_error.h"
#include "subvol/color_name.h"

namespace subvol {
namespace color_scale_test {

using test::expect_error;

constexpr auto kInvalid = ErrorCode::InvalidInput;
constexpr double kOfMap = 1.0 / 512;  // straight lines between 257 knots

TEST(ColorScale, PutsEqualRatiosAtEqualDistances) {
    const ColorScale log{.logarithmic = true};
    EXPECT_NEAR(log.part(10, 1, 1000), 1.0 / 3, 1e-12);
    EXPECT_NEAR(log.at(2.0 / 3, 1, 1000), 100, 1e-9);
    const ColorScale both{.linear_within = 1};
    EXPECT_NEAR(both.part(0, -50, 50), 0.5, 1e-12);
    EXPECT_NEAR(both.part(-50, -50, 50), 0, 1e-12);
    EXPECT_NEAR(both.at(both.part(7, -50, 50), -50, 50), 7, 1e-12);
    EXPECT_NEAR(both.part(1e-3, -50, 50) - 0.5, 1e-3 / (2 * std::log(51)), 1e-6) << "linear about 0";
    EXPECT_TRUE(ColorScale{}.linear());
}

TEST(ColorScale, MovesTheColoursOfAMap) {
    const TransferFunction grey{{{1, Vec3(0)}, {1e6, Vec3(1)}}, {{1, 0}, {1e6, 1}}};
    const TransferFunction shown = shaped(grey, {.scale = {.logarithmic = true}});
    for (const double value : {1.0, 3.0, 1e2, 1e3, 5e4, 1e6}) {
        EXPECT_NEAR(color_at(shown, value).x, std::log10(value) / 6, kOfMap) << value;
        EXPECT_NEAR(alpha_at(shown, value), std::log10(value) / 6, kOfMap) << value;
    }
    expect_error(kInvalid, "above 0", [] {
        (void)shaped({{{0, Vec3(0)}, {1, Vec3(1)}}, {{0, 0}}}, {.scale = {.logarithmic = true}});
    });
}

TEST(ColorScale, CutsAMapIntoBands) {
    const TransferFunction grey{{{0, Vec3(0)}, {8, Vec3(1)}}, {{0, 0.5}}};
    const TransferFunction bands = shaped(grey, {.bands = 4});
    std::set<double> colors;
    for (double value = -1; value <= 9; value += 0.01) {
        if (std::abs(std::remainder(value, 2)) > 1e-3) colors.insert(std::round(1e6 * color_at(bands, value).x));
    }
    EXPECT_EQ(colors, (std::set<double>{0, 333333, 666667, 1000000}));
    EXPECT_EQ(color_at(bands, 1.99), Vec3(0));
    EXPECT_EQ(color_at(bands, 6.01), Vec3(1));
    const TransferFunction one{{{3, Vec3(.25)}}, {{3, 1}}};
    EXPECT_EQ(color_at(shaped(one, {.bands = 5}), 3), Vec3(.25)) << "a map without a range has one colour";
}

TEST(ColorScale, HasColoursBeyondTheRange) {
    const TransferFunction grey{{{0, Vec3(0)}, {8, Vec3(1)}}, {{0, 0.5}}};
    const TransferFunction shown = shaped(grey, {.below = Vec3(0, 0, 1), .above = Vec3(1, 0, 0)});
    EXPECT_EQ(color_at(shown, -1e-6), Vec3(0, 0, 1));
    EXPECT_EQ(color_at(shown, 8 + 1e-6), Vec3(1, 0, 0));
    for (const double value : {1e-6, 4.0, 8 - 1e-6}) EXPECT_NEAR(color_at(shown, value).y, value / 8, 1e-6) << value;
}

TEST(ColorNames, AreReadInEachForm) {
    EXPECT_EQ(parse_color("1,.5,0", "x"), Vec3(1, .5, 0));
    EXPECT_EQ(parse_color("#ff0000", "x"), Vec3(1, 0, 0));
    for (const auto& [name, same] : {std::pair{"cyan", "#00ffff"},
                                     {"magenta", "#ff00ff"},
                                     {"orange", "#ffa500"},
                                     {"lightgrey", "#d3d3d3"},
                                     {"DarkSlateGray", "#2f4f4f"},
                                     {"rebeccapurple", "#663399"},
                                     {"green", "#008000"}})
        EXPECT_EQ(parse_color(name, "x"), parse_color(same, "x")) << name;  // of CSS Color Module Level 4
    EXPECT_EQ(parse_color("white", "x"), Vec3(1, 1, 1));
    for (const char* wrong : {"", "1,2,3", "1,1", "#12", "whit", "1,a,0"})
        expect_error(kInvalid, "--below", [&] { (void)parse_color(wrong, "--below"); });
}

}  // namespace color_scale_test
}  // namespace subvol
