// SPDX-License-Identifier: Apache-2.0
#include "subvol/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "subvol/optics.h"

namespace subvol {
namespace transfer_function_test {

using test::expect_error;

constexpr auto kInvalid = ErrorCode::InvalidInput;

double opacity(const Optics& optics, double value) {
    return -std::expm1(-optics.extinction(value) * optics.opacity_unit());
}

TEST(TransferFunctions, AreLinearBetweenKnotsAndConstantBeyond) {
    const TransferFunction function{{{1, {1, 0, 0}}, {3, {0, 0.5, 1}}}, {{0, 0.25}, {2, 0.75}}};
    EXPECT_EQ(color_at(function, 0), Vec3(1, 0, 0));
    EXPECT_EQ(color_at(function, 1), Vec3(1, 0, 0));
    EXPECT_EQ(color_at(function, 2.5), Vec3(0.25, 0.375, 0.75));
    EXPECT_EQ(color_at(function, 9), Vec3(0, 0.5, 1));
    EXPECT_EQ(alpha_at(function, -1), 0.25);
    EXPECT_EQ(alpha_at(function, 0.5), 0.375);
    EXPECT_EQ(alpha_at(function, 2), 0.75);
    EXPECT_EQ(alpha_at(function, 5), 0.75);
}

TEST(Preset, EachIsValidOverAnyRange) {
    for (const char* name : {"viridis", "coolwarm", "grey", "bone", "xray", "isosurface", "surface", "constant", "jet",
                             "rainbow", "desaturated", "blackbody", "Cool to Warm", "Blue to Red Rainbow"}) {
        for (const auto& [min, max] : {std::pair{-1.0, 1.0},
                                       {0.0, 1.0},
                                       {5.0, 5.0},
                                       {0.0, 0.0},
                                       {-3.0, -1.0},
                                       {1e9, 1e9 + 1e-3},
                                       {1e20, 1e20},
                                       {-1e-300, 1e-300}}) {
            EXPECT_NO_THROW(validate(transfer_function_preset(name, min, max))) << name << " " << min << " " << max;
        }
    }
}

TEST(Preset, CategoriesHaveOneColourForEachInteger) {
    const TransferFunction f = transfer_function_preset("categories", 1, 12);
    for (int a = 1; a <= 12; ++a) {
        for (const double off : {-0.4, 0.4}) EXPECT_LT(glm::length(color_at(f, a + off) - color_at(f, a)), 1e-12) << a;
        for (int b = 1; b < a; ++b) EXPECT_GT(glm::length(color_at(f, a) - color_at(f, b)), 0.05) << a << " " << b;
    }
    EXPECT_LT(glm::length(color_at(transfer_function_preset("categories", 3, 3), 3) - color_at(f, 3)), 1e-12);
    expect_error(kInvalid, "too many", [] { (void)transfer_function_preset("categories", 0, 1e7); });
}

TEST(Preset, NamesOfParaviewAreKnown) {
    const auto same = [](const char* a, const char* b) {
        const TransferFunction f = transfer_function_preset(a, 0, 1), g = transfer_function_preset(b, 0, 1);
        for (int i = 0; i <= 10; ++i) EXPECT_EQ(color_at(f, 0.1 * i), color_at(g, 0.1 * i)) << a;
    };
    same("Cool to Warm", "coolwarm");
    same("Blue to Red Rainbow", "rainbow");
    same("Viridis (matplotlib)", "viridis");
    const TransferFunction rainbow = transfer_function_preset("rainbow", 0, 1);
    EXPECT_EQ(color_at(rainbow, 0), Vec3(0, 0, 1));
    EXPECT_NEAR(glm::length(color_at(rainbow, 0.5) - Vec3(0, 1, 0)), 0, 1e-2) << "green between blue and red";
    EXPECT_EQ(color_at(rainbow, 1), Vec3(1, 0, 0));
}

TEST(Preset, ViridisSpansTheRangeInLinearLight) {
    const Optics optics(transfer_function_preset("viridis", 2, 4), 0.1);
    const Vec3 low = optics.color(2), high = optics.color(4);
    // sRGB (.267004, .004874, .329415) and (.993248, .906157, .143936) through IEC 61966-2-1, six digits
    EXPECT_NEAR(low.x, 0.057951, 1e-6);
    EXPECT_NEAR(low.y, 0.000377, 1e-6);
    EXPECT_NEAR(low.z, 0.088657, 1e-6);
    EXPECT_NEAR(high.x, 0.984709, 1e-6);
    EXPECT_NEAR(high.y, 0.799651, 1e-6);
    EXPECT_NEAR(high.z, 0.018243, 1e-6);
    EXPECT_NEAR(opacity(optics, 2), 0, 1e-12);
    EXPECT_NEAR(opacity(optics, 3), 0.25, 1e-12);
    EXPECT_NEAR(opacity(optics, 4), 0.5, 1e-12);
}

TEST(Preset, CoolwarmIsNeutralInTheMiddle) {
    const Optics optics(transfer_function_preset("coolwarm", -1, 1), 1);
    const Vec3 cool = optics.color(-1), middle = optics.color(0), warm = optics.color(1);
    EXPECT_GT(cool.z, 4 * cool.x);
    EXPECT_GT(warm.x, 4 * warm.z);
    EXPECT_EQ(middle.x, middle.z);
}

double encoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

void expect_color(const Optics& optics, double value, const Vec3& srgb, double tolerance) {
    const Vec3 c = optics.color(value);
    EXPECT_NEAR(encoded(c.x), srgb.x, tolerance) << value;
    EXPECT_NEAR(encoded(c.y), srgb.y, tolerance) << value;
    EXPECT_NEAR(encoded(c.z), srgb.z, tolerance) << value;
}

TEST(Preset, ColoursAreThePublishedOnes) {
    constexpr double kPromised = 1.0 / 512, kByte = 0.5 / 255;
    const Optics viridis(transfer_function_preset("viridis", 0, 255), 1);
    expect_color(viridis, 37, {0.274128, 0.199721, 0.498911}, kPromised);  // entries of matplotlib's table
    expect_color(viridis, 90, {0.182256, 0.426184, 0.557120}, kPromised);
    expect_color(viridis, 128, {0.127568, 0.566949, 0.550556}, kPromised);
    expect_color(viridis, 192, {0.369214, 0.788888, 0.382914}, kPromised);
    // Ends and middles of the published maps; polynomials are right to 1/50 there.
    constexpr double kPolynomial = 0.02;
    const auto near = [&](const char* name, double value, const Vec3& srgb) {
        expect_color(Optics(transfer_function_preset(name, 0, 255), 1), value, srgb, kPolynomial);
    };
    near("plasma", 0, {0.050383, 0.029803, 0.527975});
    near("plasma", 255, {0.940015, 0.975158, 0.131326});
    near("inferno", 0, {0.001462, 0.000466, 0.013866});
    near("inferno", 128, {0.735683, 0.215906, 0.330245});
    near("cividis", 128, {0.488697, 0.485318, 0.471008});
    // The polynomials of turbo are right to 1/11 where it is steep, and to 1/7 at its dark ends, where the table has kinks.
    expect_color(Optics(transfer_function_preset("turbo", 0, 255), 1), 128, {0.644, 0.99, 0.2336}, 0.09);
    expect_color(Optics(transfer_function_preset("turbo", 0, 255), 1), 0, {0.18995, 0.07176, 0.23217}, 0.15);
    const Optics bone(transfer_function_preset("bone", 0, 63), 1);
    expect_color(bone, 0, {0, 0, 0}, 1e-9);
    expect_color(bone, 1, {1 / 72.0, 1 / 72.0, 1.391304 / 72}, kPromised);  // (7 grey + reversed hot) / 8 of 64 entries
    expect_color(bone, 23, {23 / 72.0, 23 / 72.0, 32 / 72.0}, 1e-9);
    expect_color(bone, 47, {47 / 72.0, 56 / 72.0, 56 / 72.0}, 1e-9);
    expect_color(bone, 63, {1, 1, 1}, 1e-9);
    const Optics coolwarm(transfer_function_preset("coolwarm", 0, 32), 1);  // the bytes of Moreland's table of 33
    for (const auto& [index, bytes] : {std::pair{0, Vec3(59, 76, 192)},
                                       {8, Vec3(141, 176, 254)},
                                       {16, Vec3(221, 221, 221)},
                                       {22, Vec3(247, 177, 148)},
                                       {32, Vec3(180, 4, 38)}}) {
        expect_color(coolwarm, index, bytes / 255.0, kPromised + kByte);
    }
    const Optics grey(transfer_function_preset("grey", 0, 1), 1), xray(transfer_function_preset("xray", 0, 1), 1);
    for (const double s : {0.0, 0.1, 0.3, 0.77, 1.0}) {
        expect_color(grey, s, Vec3(s), kPromised);
        expect_color(xray, s, Vec3(1 - s), kPromised);
    }
}

TEST(Preset, IsosurfacesAreNarrowPeaks) {
    const Optics optics(transfer_function_preset("isosurface", 0, 10), 1);
    for (const double peak : {1.0, 3.0, 5.0, 7.0, 9.0}) {
        EXPECT_NEAR(opacity(optics, peak), 0.9, 1e-9);
        EXPECT_EQ(opacity(optics, peak - 0.11), 0);
        EXPECT_EQ(opacity(optics, peak + 0.11), 0);
    }
}

TEST(Preset, SurfaceShowsThePositiveSideOnly) {
    const Optics optics(transfer_function_preset("surface", -1, 1), 0.02);
    EXPECT_EQ(optics.extinction(-1), 0);
    EXPECT_EQ(optics.extinction(-1e-9), 0);
    EXPECT_EQ(optics.extinction(0), 0);
    EXPECT_NEAR(opacity(optics, 0.1), 0.9, 1e-9);  // 5 % of the range
    EXPECT_NEAR(opacity(optics, 1), 0.9, 1e-9);
    for (const double value : {0.0, 0.5, 1.0}) {
        const Vec3 c = optics.color(value);
        EXPECT_TRUE(c.x > c.y && c.y > c.z) << "ivory is warm, value " << value;
    }
}

TEST(Preset, ConstantFieldLiesInTheMiddle) {
    EXPECT_NEAR(opacity(Optics(transfer_function_preset("viridis", 5, 5), 1), 5), 0.25, 1e-12);
    EXPECT_NEAR(opacity(Optics(transfer_function_preset("constant", 5, 5), 1), 5), 0.5, 1e-12);
}

TEST(Preset, NamesThoseThatExist) {
    expect_error(kInvalid, "viridis, plasma", [] { (void)transfer_function_preset("jot", 0, 1); });
    expect_error(kInvalid, "did you mean turbo?", [] { (void)transfer_function_preset("Turbp", 0, 1); });
    expect_error(kInvalid, "range", [] { (void)transfer_function_preset("grey", 1, 0); });
    expect_error(kInvalid, "range", [] { (void)transfer_function_preset("grey", NAN, 0); });
}

class TransferFunctionFile : public test::TempFolder {
protected:
    [[nodiscard]] TransferFunction read(const std::string& content) const {
        return read_transfer_function(write("colors.json", content));
    }
};

TEST_F(TransferFunctionFile, TurnsParaViewsColorsToLinearLight) {
    const TransferFunction f = read(R"([{"ColorSpace": "Lab", "Creator": "x", "Name": "n", "NanColor": [1, 1, 0],
        "Points": [-2, 0, 0.5, 0, 0.25, 0.75, 0.5, 0, 3, 1, 0.5, 0],
        "RGBPoints": [-2, 0, 0.5, 1, 3, 0.04, 1, 0]}])");
    ASSERT_EQ(f.opacity.size(), 3u);
    EXPECT_EQ(f.color.front().value, -2);
    EXPECT_EQ(f.color.front().rgb.x, 0);
    EXPECT_NEAR(f.color.front().rgb.y, 0.21404114, 1e-8);  // the standard's value of sRGB .5, eight digits
    EXPECT_NEAR(f.color.front().rgb.z, 1, 1e-15);
    EXPECT_EQ(f.color.back().value, 3);
    EXPECT_NEAR(f.color.back().rgb.x, 0.04 / 12.92, 1e-15);
    EXPECT_EQ(f.opacity[1].value, 0.25);
    EXPECT_EQ(f.opacity[1].alpha, 0.75);
}

TEST_F(TransferFunctionFile, HoldsSeveralMapsByName) {
    const std::string two = R"([{"Name": "a", "RGBPoints": [0, 0, 0, 0]}, {"Name": "b c", "RGBPoints": [7, 1, 1, 1]}])";
    EXPECT_EQ(read(two).color.front().value, 0);
    EXPECT_EQ(read_transfer_function(write("two.json", two), "b c").color.front().value, 7);
    expect_error(kInvalid, "'d' (a, b c)", [&] { (void)read_transfer_function(write("two.json", two), "d"); });
}

TEST_F(TransferFunctionFile, WithoutPointsTheOpacityRamps) {
    const TransferFunction f = read(R"({"RGBPoints": [-1, 0, 0, 0, 1, 1, 1, 1]})");
    EXPECT_NEAR(opacity(Optics(f, 1), 0), 0.25, 1e-12);
    EXPECT_NEAR(opacity(Optics(read(R"([{"RGBPoints": [2, 1, 1, 1]}])"), 1), 0), 0.5, 1e-12);
}

TEST_F(TransferFunctionFile, NamesFileAndKey) {
    const auto refused = [this](const std::string& part, const std::string& content) {
        expect_error(kInvalid, part, [&] { (void)read(content); });
        expect_error(kInvalid, "colors.json", [&] { (void)read(content); });
    };
    refused("is not JSON: line 1, column 3: unexpected end of input", "[{");
    refused("has no colour map", "[]");
    refused("has no colour map", "[3]");
    refused("'RGBPoints' is missing", R"([{"IndexedColors": [1, 0, 0]}])");
    refused("'RGBPoints' is not an array of four", R"([{"RGBPoints": [0, 1, 1]}])");
    refused("'RGBPoints' is not an array of four", R"([{"RGBPoints": []}])");
    refused("'RGBPoints', entry 2 is not a number", R"([{"RGBPoints": [0, 1, "1", 0]}])");
    refused("colour knot 1: the values do not ascend", R"([{"RGBPoints": [1, 0, 0, 0, 0, 1, 1, 1]}])");
    refused("colour knot 0: the colour is out of range", R"([{"RGBPoints": [0, 0, 255, 0, 1, 1, 1, 1]}])");
    const std::string colors = R"("RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]}])";
    refused("'Points', knot 1: the midpoint or", R"([{"Points": [0, 0, 0.5, 0, 1, 1, 1.3, 0], )" + colors);
    refused("'Points', knot 0: the midpoint or", R"([{"Points": [0, 0, 0.5, -1, 1, 1, 0.3, 0], )" + colors);
    refused("opacity knot 1: the values do not ascend", R"([{"Points": [0, 0, 0.5, 0, -1, 1, 0.5, 0], )" + colors);
    refused("'ColorSpace' is \"XYZ\" (RGB, HSV", R"([{"ColorSpace": "XYZ", )" + colors);
    refused("opacity knot 1: the opacity is out of range", R"([{"Points": [0, 0, 0.5, 0, 1, 2, 0.5, 0], )" + colors);
    expect_error(ErrorCode::Io, "nowhere.json", [] { (void)read_transfer_function("nowhere.json"); });
}

double ramp_at(const std::vector<TransferFunction::OpacityKnot>& knots, double value) {
    return opacity(Optics({{{0, Vec3(1)}}, knots}, 1), value);
}

TEST(ParseOpacity, TakesValuesAndPerCents) {
    const auto knots = parse_opacity("0%:0, 50%:.2, 4:1 ,100%:0.9", -1, 5);
    ASSERT_EQ(knots.size(), 4u);
    EXPECT_EQ(knots[0].value, -1);
    EXPECT_EQ(knots[1].value, 2);
    EXPECT_EQ(knots[1].alpha, 0.2);
    EXPECT_EQ(knots[2].value, 4);
    EXPECT_EQ(knots[3].value, 5);
    EXPECT_EQ(parse_opacity("-1.5e-3:.5", 0, 1).front().value, -0.0015);
    EXPECT_EQ(parse_opacity("50%:1", 7, 7).front().value, 7);  // a constant field lies in the middle
}

TEST(ParseOpacity, ARepeatedValueIsAJump) {
    const auto knots = parse_opacity("0:.1,1:.1,1:.5,1:.8,2:.8", 0, 1);
    EXPECT_NEAR(ramp_at(knots, 1), 0.1, 1e-9);
    EXPECT_NEAR(ramp_at(knots, 1 + 1e-8), 0.8, 1e-9);
    const auto last = parse_opacity("0%:0,100%:0,100%:1", 0, 1);
    EXPECT_NEAR(ramp_at(last, 1 - 1e-8), 0, 1e-9);
    EXPECT_NEAR(ramp_at(last, 1), 1 - 1e-6, 1e-9);  // the largest opacity of Optics
    EXPECT_NO_THROW(validate({{{0, Vec3(1)}}, parse_opacity("0:0,0:1,1:1,1:0", 0, 1)}));
}

TEST(ParseOpacity, NamesTheEntry) {
    const auto refused = [](const std::string& part, const std::string& text) {
        expect_error(kInvalid, part, [&] { (void)parse_opacity(text, 0, 1); });
    };
    refused("entry 0, '': is not a value and an opacity", "");
    refused("entry 1, '1': is not a value and an opacity", "0:0,1");
    refused("entry 2, '': is not", "0:0,1:1,");
    refused("entry 1, 'x:1': the value is not a number", "0:0,x:1");
    refused("entry 1, '%:1': the value is not a number", "0:0,%:1");
    refused("entry 1, 'inf:1': the value is not a number", "0:0,inf:1");
    refused("entry 0, '0:1:2': the opacity is not a number", "0:1:2");
    refused("entry 0, '0:1.5': the opacity is out of range", "0:1.5");
    refused("entry 0, '0:nan': the opacity is not a number", "0:nan");
    refused("entry 1, '0%:1': the value is below", "0.5:0,0%:1");
    expect_error(kInvalid, "range", [] { (void)parse_opacity("0:0", 1, 0); });
}

TEST(Stretched, MovesColoursAndOpacitiesAlike) {
    const TransferFunction f{{{0, Vec3(0)}, {0.5, Vec3(0.2)}, {1, Vec3(1)}}, {{-1, 0}, {0.25, 0.5}}};
    const TransferFunction g = stretched(f, 300, 400);
    EXPECT_EQ(g.color[0].value, 300);
    EXPECT_EQ(g.color[1].value, 350);
    EXPECT_EQ(g.color[1].rgb, Vec3(0.2));
    EXPECT_EQ(g.color[2].value, 400);
    EXPECT_EQ(g.opacity[0].value, 200);
    EXPECT_EQ(g.opacity[1].value, 325);
    EXPECT_EQ(g.opacity[1].alpha, 0.5);
    EXPECT_EQ(stretched(f, 7, 7).color[1].value, 7);  // a constant field lies in the middle
    EXPECT_EQ(stretched({{{3, Vec3(1)}}, {{3, 1}}}, 0, 1).color[0].value, 3);
    EXPECT_NO_THROW((void)stretched({{{0, Vec3(0)}, {1e-9, Vec3(1)}, {1, Vec3(1)}}, {{0, 1}}}, 1e9, 1e9 + 1e-3));
    expect_error(kInvalid, "range", [&] { (void)stretched(f, 1, 0); });
}

TEST(Validate, RefusesWhatCannotBeInterpolated) {
    const TransferFunction good{{{0, Vec3(0)}, {1, Vec3(1)}}, {{0, 0}, {1, 1}}};
    EXPECT_NO_THROW(validate(good));
    const auto refused = [&](const std::string& part, auto change) {
        TransferFunction f = good;
        change(f);
        expect_error(kInvalid, part, [&] { validate(f); });
    };
    refused("no colour knot", [](auto& f) { f.color.clear(); });
    refused("no opacity knot", [](auto& f) { f.opacity.clear(); });
    refused("colour knot 1: the values do not ascend", [](auto& f) { f.color[1].value = 0; });
    refused("opacity knot 0: the value is not finite", [](auto& f) { f.opacity[0].value = -INFINITY; });
    refused("opacity knot 1: the opacity", [](auto& f) { f.opacity[1].alpha = NAN; });
    refused("colour knot 0: the colour", [](auto& f) { f.color[0].rgb.y = -0.1; });
}

}  // namespace transfer_function_test
}  // namespace subvol
