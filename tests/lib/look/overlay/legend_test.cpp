// SPDX-License-Identifier: Apache-2.0
#include "subvol/legend.h"
#include "subvol/detail/round_ticks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <pugixml.hpp>
#include <sstream>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"

namespace subvol {

using namespace detail;
namespace legend_test {

using test::expect_error;

std::vector<std::string> labels(double min, double max, int most = 7) {
    std::vector<std::string> all;
    for (const Tick& tick : round_ticks(min, max, most)) all.push_back(tick.label);
    return all;
}

using Labels = std::vector<std::string>;

TEST(RoundTicks, HaveTheDigitsOfTheirStep) {
    EXPECT_EQ(labels(0, 1), (Labels{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
    EXPECT_EQ(labels(-1, 1), (Labels{"−1.0", "−0.5", "0", "0.5", "1.0"}));
    EXPECT_EQ(labels(273.15, 391.2), (Labels{"280", "300", "320", "340", "360", "380"}));
    EXPECT_EQ(labels(0, 3e-4), (Labels{"0", "0.00005", "0.00010", "0.00015", "0.00020", "0.00025", "0.00030"}));
    EXPECT_EQ(labels(0, 3e7), (Labels{"0", "5e+06", "1.0e+07", "1.5e+07", "2.0e+07", "2.5e+07", "3.0e+07"}));
    EXPECT_EQ(labels(100000.5, 100000.9), (Labels{"100000.5", "100000.6", "100000.7", "100000.8", "100000.9"}));
}

TEST(RoundTicks, LieInTheRangeAndAreRound) {
    for (const auto& [min, max] :
         {std::pair{-3.7, 12.9}, {0.0, 1.0}, {1e-12, 7e-12}, {-9e20, 4e20}, {0.999, 1.001}, {5, 5.5}}) {
        const auto ticks = round_ticks(min, max);
        ASSERT_GE(ticks.size(), 2u) << min;
        EXPECT_LE(ticks.size(), 7u) << min;
        const double step = ticks[1].value - ticks[0].value, rounding = 1e-9 * (max - min);
        const double digit = step / std::pow(10, std::floor(std::log10(step) + 1e-6));
        EXPECT_NEAR(std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}), 0, 1e-6) << min;
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            EXPECT_TRUE(ticks[i].value >= min - rounding && ticks[i].value <= max + rounding) << min;
            EXPECT_NEAR(ticks[i].value - ticks[0].value, static_cast<double>(i) * step, rounding) << min;
        }
        EXPECT_LT(ticks[0].value - step, min) << "one more would fit";
        EXPECT_GT(ticks.back().value + step, max) << "one more would fit";
    }
}

TEST(RoundTicks, EndForEveryRange) {
    constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::denorm_min();
    const auto next = [](double x, int steps) {
        for (int i = 0; i < steps; ++i) x = std::nextafter(x, kMost);
        return x;
    };
    std::vector<std::pair<double, double>> ranges{{-kMost, kMost}, {0, kMost}, {0, kLeast}, {-kLeast, 1e-310}, {1e-300, 1e300}};
    for (const double x : {1.0, -1.0, 0.3, 123456.789, 0x1p53, -0x1p53, 1e17, 1e300, 1e-300, 3e-310}) {
        for (const int steps : {1, 2, 3, 10, 50, 1000}) ranges.emplace_back(x, next(x, steps));
    }
    for (const auto& [min, max] : ranges) {
        SCOPED_TRACE(testing::Message() << std::hexfloat << min << " to " << max);
        const auto ticks = round_ticks(min, max);
        ASSERT_GE(ticks.size(), 2u);
        ASSERT_LE(ticks.size(), 7u);
        // The quotient of an end and a step is rounded at 50 bits: to a hundredth of a step.
        const double rounding = 0.01 * (ticks[1].value - ticks[0].value);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            EXPECT_TRUE(ticks[i].value >= min - rounding && ticks[i].value <= max + rounding) << ticks[i].value;
            if (i == 0) continue;
            EXPECT_LT(ticks[i - 1].value, ticks[i].value);
            EXPECT_NE(ticks[i - 1].label, ticks[i].label);
        }
    }
    EXPECT_EQ(labels(1, next(1, 1)), (Labels{"1", "1.0000000000000002"}));
}

class Legend : public test::TempFolder {
protected:
    [[nodiscard]] static pugi::xml_document parsed(const std::string& svg) {
        pugi::xml_document document;
        EXPECT_TRUE(document.load_string(svg.c_str()));
        return document;
    }
};

TEST_F(Legend, HoldsTheColoursInSrgb) {
    const TransferFunction grey{{{0, Vec3(0)}, {10, Vec3(1)}}, {{0, 0}, {10, 1}}};
    const auto document = parsed(legend_svg(grey, {.title = "T", .min = 0, .max = 10}));
    std::string middle, first, last;
    for (const pugi::xml_node stop : document.child("svg").child("linearGradient").children("stop")) {
        const std::string offset = stop.attribute("offset").value();
        (offset == "50.00%" ? middle : offset == "0.00%" ? first : last) = stop.attribute("stop-color").value();
    }
    EXPECT_EQ(first, "#000000");
    EXPECT_EQ(middle, "#bcbcbc");  // half of the linear light is byte 188 in sRGB
    EXPECT_EQ(last, "#ffffff");
}

TEST_F(Legend, DrawsTheOpacityCurveAndTicksAtTheirPlaces) {
    const TransferFunction f{{{0, Vec3(1)}}, {{0, 0}, {5, 1}, {10, 0.5}}};
    const std::string svg = legend_svg(f, {.min = 0, .max = 10, .width_px = 100});
    const auto document = parsed(svg);
    double curve_x = 0, curve_y = 0, zero_y = 0;
    for (const pugi::xml_node path : document.child("svg").children("path")) {
        if (std::string(path.attribute("stroke-width").value()) != "1.5") continue;
        std::string text = path.attribute("d").value();
        char letter = 0;
        double x0 = 0, x2 = 0, y2 = 0;
        std::istringstream(text) >> letter >> x0 >> zero_y >> letter >> curve_x >> curve_y >> letter >> x2 >> y2;
        EXPECT_NEAR(curve_x - x0, 50, 0.01);
        EXPECT_NEAR(x2 - x0, 100, 0.01);
        EXPECT_NEAR((zero_y - y2) / (zero_y - curve_y), 0.5, 0.001);  // the file has two decimals of a pixel
    }
    EXPECT_GT(zero_y, curve_y + 20);
    for (const pugi::xml_node text : document.child("svg").children("text")) {
        if (std::string(text.text().get()) != "5") continue;
        EXPECT_NEAR(std::atof(text.attribute("x").value()), curve_x, 0.01);
    }
}

TEST_F(Legend, TakesAnyTitleAndAConstantField) {
    const TransferFunction f = transfer_function_preset("viridis", 3, 3);
    const auto document = parsed(legend_svg(f, {.title = "a < b & \"c\"", .min = 3, .max = 3}));
    EXPECT_STREQ(document.child("svg").child("text").text().get(), "a < b & \"c\"");
    expect_error(ErrorCode::InvalidInput, "range", [&] { (void)legend_svg(f, {.min = 1, .max = 0}); });
    expect_error(ErrorCode::InvalidInput, "width", [&] { (void)legend_svg(f, {.width_px = 0}); });
    expect_error(ErrorCode::InvalidInput, "no colour knot", [] { (void)legend_svg({}); });
}

TEST_F(Legend, NamesCategories) {
    const TransferFunction f = transfer_function_preset("categories", 1, 3);
    const auto document = parsed(legend_svg(f, {.title = "patch", .min = 1, .max = 3, .names = {"inlet", "wall", "a < b"}}));
    std::vector<std::string> texts, fills;
    for (const pugi::xml_node text : document.child("svg").children("text")) texts.emplace_back(text.text().get());
    for (const pugi::xml_node rect : document.child("svg").children("rect")) fills.emplace_back(rect.attribute("fill").value());
    EXPECT_EQ(texts, (std::vector<std::string>{"patch", "inlet", "wall", "a < b"}));
    EXPECT_EQ(fills, (std::vector<std::string>{"#fff", "#1f77b4", "#ff7f0e", "#2ca02c"}));
    EXPECT_FALSE(document.child("svg").child("linearGradient")) << "there is no bar";
}

TEST_F(Legend, IntegersAreNamedByTheirValues) {
    EXPECT_EQ(categories_of(std::vector<double>{7, 2, 2, 7, -1}), (std::vector<double>{-1, 2, 7}));
    EXPECT_TRUE(categories_of(std::vector<double>{1, 2.5}).empty());
    EXPECT_TRUE(categories_of(std::vector<double>{1, std::nan("")}).empty());
    LegendOptions options{.title = "block", .min = 2, .max = 7};
    name_categories(options, std::vector<double>{-1, 2, 7});
    EXPECT_EQ(options.names, (std::vector<std::string>{"2", "7"})) << "in the range";
    const auto document = parsed(legend_svg(transfer_function_preset("categories", 2, 7), options));
    std::vector<std::string> fills;
    for (const pugi::xml_node rect : document.child("svg").children("rect")) fills.emplace_back(rect.attribute("fill").value());
    EXPECT_EQ(fills, (std::vector<std::string>{"#fff", "#ff7f0e", "#e377c2"})) << "Tableau's second and seventh colour";
}

TEST(BarTicks, AreTheEndsOfBands) {
    const auto ends = [](int bands, int most) {
        std::vector<double> parts;
        for (const Tick& tick : bar_ticks({.bands = bands}, 293.15, 913.15, most))
            parts.push_back((tick.value - 293.15) / 620 * bands);
        return parts;
    };
    const auto every = [](int step, int last) {
        std::vector<double> all;
        for (int end = 0; end <= last; end += step) all.push_back(end);
        return all;
    };
    // Values are rounded to 1e-13 of themselves, which is 1e-12 of a band.
    for (const auto& [found, expected] : {std::pair{ends(10, 8), every(1, 10)},
                                          {ends(12, 8), every(2, 12)},
                                          {ends(20, 8), every(2, 20)},
                                          {ends(13, 8), every(2, 12)},
                                          {ends(21, 7), every(3, 21)}}) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-10);
    }
}

TEST(BarTicks, FollowTheScale) {
    const auto texts = [](const ColorShape& shape, double min, double max) {
        std::vector<std::string> all;
        for (const Tick& tick : bar_ticks(shape, min, max)) all.push_back(tick.label);
        return all;
    };
    const ColorShape log{.scale = {.logarithmic = true}}, both{.scale = {.linear_within = 1}};
    EXPECT_EQ(texts(log, 0.01, 1000), (Labels{"0.01", "0.1", "1", "10", "100", "1000"}));
    EXPECT_EQ(texts(log, 2, 60), (Labels{"2", "5", "10", "20", "50"}));
    EXPECT_EQ(texts(both, -100, 100), (Labels{"−100", "−10", "−1", "0", "1", "10", "100"}));
    EXPECT_EQ(texts({.bands = 4}, 0, 2), (Labels{"0", "0.5", "1", "1.5", "2"}));
    EXPECT_EQ(texts({.bands = 100}, 0, 1), labels(0, 1)) << "of many bands round values";
    for (const auto& [min, max] : {std::pair{1e-30, 1e30}, {3.0, 3.1}, {1.0, 1e300}}) {
        const auto ticks = bar_ticks(log, min, max);
        EXPECT_GE(ticks.size(), 2u);
        EXPECT_LE(ticks.size(), 7u);
    }
}

TEST_F(Legend, OfAConstantFieldHasOneValue) {
    const TransferFunction f = transfer_function_preset("viridis", 3.5, 3.5);
    const auto document = parsed(legend_svg(f, {.title = "T", .min = 3.5, .max = 3.5}));
    std::vector<std::string> texts;
    for (const pugi::xml_node text : document.child("svg").children("text")) texts.emplace_back(text.text().get());
    EXPECT_EQ(texts, (std::vector<std::string>{"T", "3.5"})) << "no range is made up";
}

TEST_F(Legend, WritesNumbersInTheFormatThatIsAskedFor) {
    for (const char* right : {"%g", "%.2f", "%.3e", "%.0f m", "T = %f"}) EXPECT_TRUE(is_tick_format(right)) << right;
    for (const char* wrong : {"", "2f", "%", "%d", "%s", "%.f2", "%.99f", "%f%f", "%5.2f", "%.2"})
        EXPECT_FALSE(is_tick_format(wrong)) << wrong;
    const TransferFunction f = transfer_function_preset("viridis", -2, 2);
    const std::string svg = legend_svg(f, {.min = -2, .max = 2, .format = "%.2f K"});
    EXPECT_NE(svg.find(">1.00 K<"), std::string::npos);
    EXPECT_NE(svg.find(">−2.00 K<"), std::string::npos);
}

TEST_F(Legend, HasTipsInTheColoursBeyondTheRange) {
    const TransferFunction function = transfer_function_preset("viridis", 0, 1);
    const std::string plain = legend_svg(function, {.title = "T", .min = 0, .max = 1});
    const std::string tips =
        legend_svg(function, {.title = "T", .min = 0, .max = 1, .shape = {.below = Vec3(1, 0, 1), .above = Vec3(0, 1, 0)}});
    for (const char* color : {"fill=\"#ff00ff\"", "fill=\"#00ff00\""}) {
        EXPECT_EQ(plain.find(color), std::string::npos);
        EXPECT_NE(tips.find(color), std::string::npos);
    }
}

TEST_F(Legend, IsWrittenWhole) {
    const TransferFunction f = transfer_function_preset("bone", 0, 1);
    const auto path = write("a.svg", "before");
    write_legend(path, f);
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    EXPECT_EQ(text.str(), legend_svg(f));
    expect_error(ErrorCode::Io, "nowhere", [&] { write_legend("nowhere/a.svg", f); });
}

}  // namespace legend_test
}  // namespace subvol
