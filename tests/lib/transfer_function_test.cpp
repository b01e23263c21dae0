#include "subvol/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_error.h"
#include "subvol/optics.h"
#include "temp_folder.h"

namespace subvol {
namespace {

using test::expect_error;

constexpr auto kInvalid = ErrorCode::InvalidInput;

double opacity(const Optics& optics, double value) {
    return -std::expm1(-optics.extinction(value) * optics.opacity_unit());
}

TEST(Preset, EachIsValidOverAnyRange) {
    for (const char* name : {"viridis", "coolwarm", "grey", "surface", "constant"}) {
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
    expect_error(kInvalid, "viridis, coolwarm", [] { (void)transfer_function_preset("jet", 0, 1); });
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
    ASSERT_EQ(f.color.size(), 2u);
    ASSERT_EQ(f.opacity.size(), 3u);
    EXPECT_EQ(f.color[0].value, -2);
    EXPECT_EQ(f.color[0].rgb.x, 0);
    EXPECT_NEAR(f.color[0].rgb.y, 0.21404114, 1e-8);  // the standard's value of sRGB .5, eight digits
    EXPECT_NEAR(f.color[0].rgb.z, 1, 1e-15);
    EXPECT_NEAR(f.color[1].rgb.x, 0.04 / 12.92, 1e-15);
    EXPECT_EQ(f.opacity[1].value, 0.25);
    EXPECT_EQ(f.opacity[1].alpha, 0.75);
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
    refused("parse error", "[{");
    refused("holds no colour map", "[]");
    refused("holds no colour map", "[3]");
    refused("'RGBPoints' is missing", R"([{"IndexedColors": [1, 0, 0]}])");
    refused("'RGBPoints' is not an array of four", R"([{"RGBPoints": [0, 1, 1]}])");
    refused("'RGBPoints' is not an array of four", R"([{"RGBPoints": []}])");
    refused("'RGBPoints', entry 2 is not a number", R"([{"RGBPoints": [0, 1, "1", 0]}])");
    refused("colour knot 1: the values do not ascend", R"([{"RGBPoints": [1, 0, 0, 0, 0, 1, 1, 1]}])");
    refused("colour knot 0: the colour is out of range", R"([{"RGBPoints": [0, 0, 255, 0, 1, 1, 1, 1]}])");
    const std::string colors = R"("RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]}])";
    refused("'Points', knot 1 is not linear", R"([{"Points": [0, 0, 0.5, 0, 1, 1, 0.3, 0], )" + colors);
    refused("opacity knot 1: the opacity is out of range", R"([{"Points": [0, 0, 0.5, 0, 1, 2, 0.5, 0], )" + colors);
    expect_error(ErrorCode::Io, "nowhere.json", [] { (void)read_transfer_function("nowhere.json"); });
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

}  // namespace
}  // namespace subvol
