// SPDX-License-Identifier: Apache-2.0
#include "subvol/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/comma_locale.h"

namespace subvol {
namespace plot_test {

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

TEST(Plot, OrdersAreSlopes) {
    PlotLine line{.name = "cubic", .x = {1, .5, .25, .125}, .y = {}};
    for (const double x : line.x) line.y.push_back(7 * x * x * x);
    EXPECT_NEAR(*fitted_order(line), 3, 1e-12);
    line.y[1] = 0;  // left out
    EXPECT_NEAR(*fitted_order(line), 3, 1e-12);
    EXPECT_FALSE(fitted_order({.name = "", .x = {1, 1}, .y = {2, 3}}));
    EXPECT_FALSE(fitted_order({.name = "", .x = {1}, .y = {2}}));
}

TEST(Plot, TicksAreRoundAndWithinTheAxis) {
    for (const auto& [min, max] : {std::pair{.9, 1.1}, {1e-6, 1e3}, {3e-5, 4.1e-5}, {2., 2.0001}, {1e-30, 1e30}}) {
        const auto all = ticks(min, max, true);
        ASSERT_GE(all.size(), 2U) << min;
        EXPECT_LE(all.size(), 9U) << min;
        EXPECT_TRUE(std::ranges::is_sorted(all));
        EXPECT_GE(all.front(), min);
        EXPECT_LE(all.back(), max);
    }
    EXPECT_EQ(ticks(.3, 40, true), (std::vector<double>{.5, 1, 2, 5, 10, 20}));
    EXPECT_EQ(ticks(-1, 1, false), (std::vector<double>{-1, -.5, 0, .5, 1}));
    EXPECT_EQ(ticks(-3, 22, false), (std::vector<double>{0, 5, 10, 15, 20}));
}

/// The texts of the labels below the axis of x.
std::vector<std::string> x_labels(const std::string& svg) {
    std::vector<std::string> labels;
    const std::string begin = "text-anchor=\"middle\"";
    for (std::size_t at = svg.find(begin); at < svg.find("class=\"frame\""); at = svg.find(begin, at + 1)) {
        const std::size_t text = svg.find('>', at) + 1;
        labels.push_back(svg.substr(text, svg.find('<', text) - text));
    }
    return labels;
}

TEST(Plot, ValuesAnUlpApartHaveAnAxis) {
    const double one = 1, next = std::nextafter(one, 2), large = 0x1p53, most = std::numeric_limits<double>::max();
    for (const bool log : {false, true}) {
        for (const auto& x : {std::vector{one, next}, {large, large + 2}, {most / 2, most}, {5e-324, 1e-323}, {5e-324, most}}) {
            const std::string svg = plot_svg({.title = "t",
                                              .x_label = "",
                                              .y_label = "",
                                              .log_x = log,
                                              .log_y = log,
                                              .lines = {{.name = "l", .x = x, .y = x}}});
            EXPECT_EQ(svg.find("nan"), std::string::npos) << x[0];
            EXPECT_EQ(svg.find("inf"), std::string::npos) << x[0];
            EXPECT_EQ(count(svg, "<circle"), 3U) << x[0];  // two points and the legend
            auto labels = x_labels(svg);
            EXPECT_GE(labels.size(), 2U) << svg;
            std::ranges::sort(labels);
            EXPECT_EQ(std::ranges::adjacent_find(labels), labels.end()) << "two ticks with the same label: " << svg;
        }
    }
    const std::string svg = plot_svg({.title = "t",
                                      .x_label = "",
                                      .y_label = "",
                                      .log_x = false,
                                      .log_y = false,
                                      .lines = {{.name = "l", .x = {-most, most}, .y = {0, 1}}}});
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_GE(x_labels(svg).size(), 2U);
}

TEST(Plot, LabelsHaveTheDigitsOfTheirSteps) {
    const auto labels = [](double min, double max, bool log) {
        return x_labels(plot_svg({.title = "t",
                                  .x_label = "",
                                  .y_label = "",
                                  .log_x = log,
                                  .lines = {{.name = "l", .x = {min, max}, .y = {1, 2}}}}));
    };
    using Labels = std::vector<std::string>;
    EXPECT_EQ(labels(2, 2.0001, false), (Labels{"2.00000", "2.00002", "2.00004", "2.00006", "2.00008", "2.00010"}));
    EXPECT_EQ(labels(0, 3e7, false), (Labels{"0", "5·10⁶", "1.0·10⁷", "1.5·10⁷", "2.0·10⁷", "2.5·10⁷", "3.0·10⁷"}));
    EXPECT_EQ(labels(1e-6, 10, true), (Labels{"10⁻⁵", "0.001", "0.1", "10"}));
}

TEST(Plot, HasPointsInEveryLocale) {
    const Plot plot{.title = "t",
                    .x_label = "x",
                    .y_label = "y",
                    .log_x = false,
                    .fit = true,
                    .lines = {{.name = "l", .x = {1000.5, 2000.25, 3000}, .y = {1, .1, .01}}}};
    const std::string svg = plot_svg(plot);
    const test::CommaLocale comma;
    EXPECT_EQ(plot_svg(plot), svg);
    EXPECT_EQ(svg.find(','), std::string::npos);
}

TEST(Plot, IsOneElementWithAllThatIsShown) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::string svg = plot_svg({.title = "a < b & \"c\"",
                                      .x_label = "x",
                                      .y_label = "y",
                                      .fit = true,
                                      .lines = {{.name = "<script>", .x = {1, 10, 100}, .y = {1, .1, .01}},
                                                {.name = "holes", .x = {1, 0, 10, 20}, .y = {1, 1, inf, std::nan("")}}}});
    EXPECT_TRUE(svg.starts_with("<svg "));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_EQ(svg.find("<script"), std::string::npos);
    EXPECT_NE(svg.find("&lt;script&gt; (-1.00)"), std::string::npos) << svg;
    EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_EQ(count(svg, "<circle"), 4U);  // three points and the legend
    EXPECT_EQ(svg.find("http"), std::string::npos);
}

TEST(Plot, PlacesFollowTheAxes) {
    // Equal ratios are equal distances: the middle one of three points a decade apart lies midway.
    const std::string svg = plot_svg(
        {.title = "t", .x_label = "x", .y_label = "y", .lines = {{.name = "l", .x = {1, 10, 100}, .y = {1, 10, 100}}}});
    const std::size_t path = svg.rfind("<path", svg.find("d=\"M", svg.find("frame")));
    double x[3], y[3];
    ASSERT_EQ(
        std::sscanf(svg.c_str() + svg.find("d=\"M", path), "d=\"M%lf %lfL%lf %lfL%lf %lf", x, y, x + 1, y + 1, x + 2, y + 2),
        6);
    EXPECT_NEAR(x[1], (x[0] + x[2]) / 2, .02);  // positions have two decimals
    EXPECT_NEAR(y[1], (y[0] + y[2]) / 2, .02);
    EXPECT_GT(y[0], y[2]);  // up is more
}

TEST(Plot, WithoutFiguresSaysSo) {
    EXPECT_NE(plot_svg({.title = "t", .x_label = "", .y_label = "", .lines = {}}).find("no data"), std::string::npos);
    EXPECT_EQ(
        plot_svg({.title = "t", .x_label = "", .y_label = "", .lines = {{.name = "one", .x = {2}, .y = {3}}}}).find("nan"),
        std::string::npos);
}

TEST(Plot, AFileStandsAlone) {
    const Plot plot{.title = "t", .x_label = "x", .y_label = "y", .lines = {{.name = "l", .x = {1, 10}, .y = {1, 10}}}};
    const std::string svg = plot_svg_file(plot);
    EXPECT_TRUE(svg.starts_with("<?xml"));
    for (const char* part : {"xmlns=\"http://www.w3.org/2000/svg\"", " width=\"480.00\"", "<style>", "class=\"frame\""})
        EXPECT_NE(svg.find(part), std::string::npos) << part;
    EXPECT_EQ(count(svg, "http"), 1U);  // nothing but the name of the format
}

TEST(Plot, PensLiftAtBreaks) {
    Plot plot{.title = "t", .x_label = "x", .y_label = "y", .lines = {{.name = "l", .x = {1, 2, 3, 4}, .y = {1, 2, 3, 4}}}};
    const auto strokes = [&] {
        const std::string svg = plot_svg(plot);
        const std::size_t begin = svg.find("d=\"M", svg.find("class=\"line\""));
        return count(svg.substr(begin, svg.find('"', begin + 3) - begin), "M");
    };
    EXPECT_EQ(strokes(), 1U);
    plot.lines[0].breaks = {2};
    EXPECT_EQ(strokes(), 2U);
}

/// The numbers of an attribute of all elements of a kind.
std::vector<double> numbers(const std::string& svg, const std::string& element, const std::string& attribute) {
    std::vector<double> all;
    for (std::size_t at = svg.find(element); at != std::string::npos; at = svg.find(element, at + 1)) {
        all.push_back(std::stod(svg.substr(svg.find(attribute + "=\"", at) + attribute.size() + 2)));
    }
    return all;
}

TEST(Plot, LabelsDoNotTouch) {
    for (const auto& [low, high] : {std::pair{1e-9, 1e9}, {123456.0, 123999.0}, {1e-3, 2e-3}, {0.001, 9000.}}) {
        Plot plot{.title = "t", .x_label = "x", .y_label = "y", .lines = {{.name = "l", .x = {low, high}, .y = {low, high}}}};
        const std::string svg = plot_svg(plot);
        const auto labels = x_labels(svg);
        auto x = numbers(svg, "<text", "x");
        ASSERT_GE(labels.size(), 2U);
        constexpr double kLetter = 7;  // about .58 of the font's 12
        const auto letters = [](const std::string& words) {
            return static_cast<double>(std::ranges::count_if(words, [](char c) { return (c & 0xC0) != 0x80; }));
        };
        for (std::size_t i = 1; i < labels.size(); ++i) {
            EXPECT_GT(x[i] - x[i - 1], kLetter * (letters(labels[i - 1]) + letters(labels[i])) / 2 * .8) << labels[i] << low;
        }
    }
    // Entries of the legend: long ones have a line each.
    Plot plot{.title = "t", .x_label = "x", .y_label = "y", .fit = true, .lines = {}};
    for (const char* name : {"a name of about thirty letters", "another of about thirty letters"})
        plot.lines.push_back({.name = name, .x = {1, 2}, .y = {1, 2}});
    const std::string svg = plot_svg(plot);
    EXPECT_NE(svg.find("y=\"330.00\" text-anchor=\"start\""), std::string::npos) << svg;  // the second line
}

TEST(Plot, PdfHasItsFontsAndTheSameBytesInEveryRun) {
    Plot plot{.title = "Fehler über Zeit",
              .x_label = "time (s)",
              .y_label = "Länge (m)",
              .lines = {{.name = "µ ≤ 3·10⁻⁵, 日", .x = {1e-6, 10}, .y = {1, 10}}}};
    const std::string pdf = plot_pdf(plot);
    EXPECT_TRUE(pdf.starts_with("%PDF-1.4"));
    EXPECT_TRUE(pdf.ends_with("%%EOF\n"));
    const std::size_t table = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
    EXPECT_EQ(pdf.substr(table, 5), "xref\n");
    EXPECT_GT(count(pdf, "/FontFile"), 0u);
    EXPECT_EQ(count(pdf, "/FontFile"), count(pdf, "/FontDescriptor\n")) << "a font that is not embedded";
    EXPECT_EQ(pdf.find("Date"), std::string::npos);
    EXPECT_EQ(pdf, plot_pdf(plot));
    const test::CommaLocale comma;
    EXPECT_EQ(pdf, plot_pdf(plot));
    plot.lines.clear();
    EXPECT_TRUE(plot_pdf(plot).starts_with("%PDF-1.4")) << "no data";
}

TEST(Plot, FloorsAreABandAndBoundsAreHollow) {
    Plot plot{.title = "t",
              .x_label = "x",
              .y_label = "y",
              .log_y = false,
              .lines = {{.name = "l", .x = {1, 2, 4}, .y = {30, 40, 50}, .spreads = {1, 0, 2}, .bounds = {2}}},
              .x_ticks = {1, 2, 4},
              .floor = 45,
              .floor_above = true,
              .floor_name = "known to here"};
    const std::string svg = plot_svg(plot);
    EXPECT_EQ(count(svg, "class=\"band\""), 2U);  // and one in the legend
    EXPECT_EQ(count(svg, "class=\"hollow\""), 1U);
    EXPECT_EQ(count(svg, "class=\"bars\""), 1U);
    EXPECT_EQ(x_labels(svg), (std::vector<std::string>{"1", "2", "4"}));  // those of the data
    EXPECT_NE(svg.find("known to here"), std::string::npos);
    // The band begins between the second point and the third, and goes up to the frame.
    const auto ys = numbers(svg, "<rect class=\"band\"", "y"), heights = numbers(svg, "<rect class=\"band\"", "height");
    const auto circles = numbers(svg, "<circle", "cy");
    ASSERT_GE(circles.size(), 3U);
    EXPECT_LT(ys[0] + heights[0], circles[1]);
    EXPECT_GT(ys[0] + heights[0], circles[2]);
    plot.lines[0].bounds.clear();
    plot.floor.reset();
    EXPECT_EQ(count(plot_svg(plot), "band"), 0U);
}

TEST(Plot, HasTheSizesOfPrint) {
    const Plot plot{.title = "t", .x_label = "x", .y_label = "y", .lines = {{.name = "l", .x = {1, 10}, .y = {1, 10}}}};
    constexpr double kPoints = 72 / 25.4;  // a millimetre
    EXPECT_NEAR(kColumnPlot.width, 84 * kPoints, .01);
    EXPECT_NEAR(kPagePlot.width, 174 * kPoints, .01);
    EXPECT_NE(plot_svg_file(plot, kColumnPlot).find("width=\"238.11pt\""), std::string::npos);
    EXPECT_NE(plot_pdf(plot, kPagePlot).find("/MediaBox [ 0 0 493.2"), std::string::npos);
}

TEST(Plot, NumbersAreThereForLatexAndPrograms) {
    const Plot plot{
        .title = "t",
        .x_label = "50 %",
        .y_label = "RMSE",
        .lines = {{.name = "a_b", .x = {1, 2, 4}, .y = {.5, .25, 0}, .breaks = {1}, .spreads = {.1, 0, 0}, .bounds = {1}}}};
    const std::string tex = plot_tex(plot);
    for (const char* part : {"xmode=log, ymode=log", "xlabel={50 \\%}", "(1,0.5) +- (0,0.1)\n\n", "(2,0.25) +- (0,0) % a bound",
                             "\\addlegendentry{a\\_b}", "\\end{tikzpicture}"})
        EXPECT_NE(tex.find(part), std::string::npos) << part << tex;
    EXPECT_EQ(tex.find("(4,0)"), std::string::npos);  // a logarithmic axis does not show 0
    EXPECT_EQ(plot_csv(plot), "name,x,y,spread,bound\n\"a_b\",1,0.5,0.1,\n\"a_b\",2,0.25,0,yes\n\"a_b\",4,0,0,\n");
}

TEST(Plot, MarksTheStudiedPlacesButNotThoseOfACurve) {
    const auto circles = [](std::size_t count) {
        Plot plot;
        plot.lines.resize(1);
        PlotLine& line = plot.lines[0];
        for (std::size_t i = 1; i <= count; ++i) {
            line.x.push_back(static_cast<double>(i));
            line.y.push_back(static_cast<double>(i * i));
        }
        const std::string svg = plot_svg(plot);
        std::size_t found = 0;
        for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(circles(10), 11u);  // and one in the legend
    EXPECT_EQ(circles(200), 0u);
}

}  // namespace plot_test
}  // namespace subvol
