// SPDX-License-Identifier: Apache-2.0
#include "subvol/overlay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace overlay_test {

/// The sum of all covers, in pixels.
double ink_of(const Image& image) {
    double sum = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) sum += static_cast<double>(image.rgba[i]);
    return sum;
}

struct Extent {
    int left = 1 << 20, top = 1 << 20, right = -1, bottom = -1;
};

Extent extent_of(const Image& image) {
    Extent extent;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (image.pixel(x, y)[3] == 0) continue;
            extent = {std::min(extent.left, x), std::min(extent.top, y), std::max(extent.right, x), std::max(extent.bottom, y)};
        }
    }
    return extent;
}

TEST(Overlay, TextHasTheSameInkAtEveryPlace) {
    Image a(100, 40), b(100, 40);
    draw_text(a, {10, 30}, "Temp 3.5", {.size_px = 16});
    draw_text(b, {10.37, 29.81}, "Temp 3.5", {.size_px = 16});
    EXPECT_GT(ink_of(a), 100);
    EXPECT_NEAR(ink_of(a), ink_of(b), 1e-3 * ink_of(a)) << "the area of its letters";
    const Extent extent = extent_of(a);
    EXPECT_LE(extent.right, 10 + text_width_px("Temp 3.5", 16));
    EXPECT_NEAR(extent.top, 30 - 0.73 * 16, 2) << "capitals stand on the base line";
    EXPECT_NEAR(extent.bottom, 30 + 0.21 * 16, 2) << "the p goes below it";
}

TEST(Overlay, TextIsAnchoredAndCutOff) {
    Image start(80, 20), end(80, 20), beyond(10, 10);
    const double width = text_width_px("0123", 12);
    draw_text(start, {20, 15}, "0123", {.size_px = 12});
    draw_text(end, {20 + width, 15}, "0123", {.size_px = 12, .anchor = TextAnchor::End});
    EXPECT_EQ(extent_of(start).left, extent_of(end).left);
    EXPECT_NO_THROW(draw_text(beyond, {-5, 4}, "Überlänge ∇·v 日本 \xff", {.size_px = 30}));
    EXPECT_GT(text_width_px("日", 10), 0) << "a box for letters that the font lacks";
}

TEST(Overlay, UnitsGreekAndCyrillicHaveOutlines) {
    const std::vector<std::string> texts{"kg m⁻³ s⁻²",         "T = 20 ℃, ∂p/∂x, Ω·m, Å",
                                         "Температура",        "αβγδεζηθικλμνξοπρστυφχψω",
                                         "Größe, naïve, Łódź", "±∞ ≤ ≥ ≈ √ ∫ ∑ → ½ ‰ “quotes” – —"};
    EXPECT_EQ(missing_letters(texts), std::vector<std::string>());
    EXPECT_EQ(missing_letters(std::vector<std::string>{"温度 T 温", "\xff!"}), (std::vector<std::string>{"温", "度", "\xff"}));
    Image minus(40, 40), box(40, 40);
    draw_text(minus, {5, 30}, "⁻", {.size_px = 30});
    draw_text(box, {5, 30}, "温", {.size_px = 30});
    EXPECT_LT(extent_of(minus).bottom, 20) << "it is raised";
    EXPECT_LT(extent_of(minus).bottom - extent_of(minus).top, 5) << "and a line";
    EXPECT_GT(extent_of(box).bottom - extent_of(box).top, 15);
}

TEST(Overlay, TextsAreCutWithDotsAtWholeLetters) {
    EXPECT_EQ(cut_text("Größe", 10, 1000), "Größe");
    const std::string cut = cut_text("ÄÄÄÄÄÄÄÄ", 10, 0.6 * text_width_px("ÄÄÄÄÄÄÄÄ", 10));
    EXPECT_LE(text_width_px(cut, 10), 0.6 * text_width_px("ÄÄÄÄÄÄÄÄ", 10));
    EXPECT_TRUE(cut.ends_with("…"));
    EXPECT_EQ(missing_letters(std::vector<std::string>{cut}).size(), 0U) << "no half of a letter is left";
    EXPECT_EQ((cut.size() - std::string("…").size()) % 2, 0U);
    EXPECT_EQ(cut_text("abc", 10, 0), "…");
}

TEST(Overlay, LegendsOfTallPicturesHaveTheLettersOfTheirWidth) {
    const TransferFunction f = transfer_function_preset("viridis", 0, 1);
    const LegendOptions options{.title = "T"};
    EXPECT_EQ(legend_extent_px(f, options, {.width = 800}, 800), legend_width_px(f, options, 800)) << "a square";
    EXPECT_EQ(legend_extent_px(f, options, {.width = 1200}, 400), legend_width_px(f, options, 400)) << "a wide picture";
    EXPECT_EQ(legend_extent_px(f, options, {.width = 400}, 800), legend_width_px(f, options, 400))
        << "a tall one: as of its width";
    EXPECT_EQ(legend_extent_px(f, options, {.width = 80}, 80), legend_width_px(f, options, 320))
        << "letters of 8 pixels at least";
}

TEST(Overlay, PaddedPicturesAreWhereTheyBelong) {
    Image small(2, 1);
    for (std::size_t i = 0; i < 8; ++i) small.rgba[i] = static_cast<float>(i + 1);
    const Image large = padded(small, 1, 2, 4, 5);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 4; ++x) {
            const float expected = y == 2 && (x == 1 || x == 2) ? static_cast<float>(4 * (x - 1) + 1) : 0.F;
            EXPECT_EQ(large.pixel(x, y)[0], expected) << x << ' ' << y;
        }
    }
}

TEST(Overlay, LinesHaveTheirWidth) {
    for (const Vec2& to : {Vec2(80, 20), Vec2(20, 70), Vec2(75, 61)}) {
        Image image(100, 100);
        const Vec2 from(20, 20);
        draw_line(image, from, to, {.width_px = 3, .color = {1, 0, 0}, .alpha = 0.5});
        const double length = glm::length(to - from), round_ends = 9 * M_PI / 4;
        EXPECT_NEAR(ink_of(image), 0.5 * (3 * length + round_ends), 0.05 * length);
        EXPECT_FLOAT_EQ(image.pixel(20, 20)[0], image.pixel(20, 20)[3]) << "premultiplied";
    }
}

/// Edges of a cube before a picture that is opaque at the front face, and the same where the picture is empty.
double ink_over_cube(bool opaque, float front) {
    const HexMesh mesh = test::make_box(1, 1, 1);
    const View view({.eye = {0.5, -4, 0.5}, .target = {0.5, 0, 0.5}, .up = {0, 0, 1}, .fovy_deg = 30}, 64, 64);
    Image image(64, 64);
    std::vector<float> depth(64 * 64, std::numeric_limits<float>::infinity());
    if (opaque) {
        for (std::size_t i = 0; i < depth.size(); ++i) {
            depth[i] = front;
            for (std::size_t c = 0; c < 4; ++c) image.rgba[4 * i + c] = 1;
        }
    }
    draw_edges(image, depth, view, mesh, {.width_px = 1, .color = {0, 0, 0}});
    double dark = 0;
    for (std::size_t i = 0; i < depth.size(); ++i)
        dark += opaque ? 1 - static_cast<double>(image.rgba[4 * i]) : static_cast<double>(image.rgba[4 * i + 3]);
    return dark;
}

TEST(Overlay, HiddenEdgesAreHidden) {
    const double all = ink_over_cube(false, 0), front = ink_over_cube(true, 4), none = ink_over_cube(true, 3);
    const double face = 4 * 64 * (1 / (2 * 4 * std::tan(M_PI / 12)));  // four edges of the front face, in pixels
    EXPECT_NEAR(front, face, 0.1 * face) << "only the face before the surface";
    EXPECT_GT(all, 1.5 * front) << "through nothing all twelve are seen";
    EXPECT_EQ(none, 0) << "behind an opaque surface";
}

TEST(Overlay, EdgesAreThoseOfWhatACutLeavesAndOfItsFace) {
    const HexMesh mesh = test::make_box(4, 4, 4);
    const std::vector<float> depth(64 * 64, std::numeric_limits<float>::infinity());
    const View from_front({.eye = {2, -9, 2}, .target = {2, 0, 2}, .up = {0, 0, 1}, .ortho_height = 5}, 64, 64);
    const double cell = 64 / 5.0;  // in pixels
    const auto ink = [&](const Clip& clip) {
        Image image(64, 64);
        draw_edges(image, depth, from_front, mesh, {.width_px = 1}, clip);
        double sum = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) sum += image.pixel(x, y)[3] > 0.02F ? 1 : 0;
        }
        return sum;
    };
    const double whole = ink({});
    EXPECT_GT(whole, 10 * 4 * cell * 0.9) << "five lines each way";
    const Clip half{.planes = {{{2, 0, 0}, {1, 0, 0}}}};
    EXPECT_LT(ink(half), 0.65 * whole) << "nothing hangs where the body is cut away";
    // Across the middle of cells, away from what hides: the face of the cut has the lines of its cells.
    const Clip inside{.planes = {{{0, 1.5, 0}, {0, -1, 0}}}};
    EXPECT_NEAR(ink(inside), whole, 0.1 * whole);
    const Clip slice{.slices = {{{0, 1.5, 0}, {0, -1, 0}}}};
    EXPECT_NEAR(ink(slice), whole, 0.1 * whole) << "the lines on the slice";
    const Clip edge_on{.slices = {{{1.5, 0, 0}, {1, 0, 0}}}};
    EXPECT_LT(ink(edge_on), 3 * 4 * cell) << "and nothing beside it";
}

TEST(Overlay, ScalesStandBesideTheirPlot) {
    const PictureScale across{"x", -1, 1}, up{"z", 100, 300};
    const PlotMargins margins = plot_margins_px(200, up);
    Image image(margins.left + 300 + margins.right, margins.top + 200 + margins.bottom);
    const PlotFrame frame{margins.left, margins.top, 300, 200};
    draw_scales(image, frame, across, up, Vec3(0.0));
    bool left = false, below = false;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (image.pixel(x, y)[3] == 0) continue;
            left = left || x < frame.left - 4;
            below = below || y > frame.top + frame.height + 4;
            const bool inside =
                x > frame.left + 2 && x < frame.left + frame.width - 3 && y > frame.top + 2 && y < frame.top + frame.height - 3;
            ASSERT_FALSE(inside) << "the plot is left alone";
        }
    }
    EXPECT_TRUE(left && below);
}

TEST(Overlay, AMarkIsAtItsPlaceAndItsTextInThePicture) {
    Image image(200, 100);
    draw_mark(image, {195, 5}, "max 12.5", 12, Vec3(0.0), Vec3(1.0));
    EXPECT_GT(image.pixel(190, 5)[3], 0.5F) << "an arm of the cross";
    double ink = 0;
    for (int x = 120; x < 185; ++x) {
        for (int y = 0; y < 40; ++y) ink += image.pixel(x, y)[3];
    }
    EXPECT_GT(ink, 100) << "the label is at its left, where there is room";
    Image outside(200, 100);
    draw_mark(outside, {-3, 5}, "min", 12, Vec3(0.0), Vec3(1.0));
    EXPECT_EQ(outside.rgba, Image(200, 100).rgba);
}

TEST(Overlay, EdgesBehindTheEyeAreNotSeenInParallelViewsEither) {
    const HexMesh mesh = test::make_box(1, 1, 1);
    const auto ink = [&](double along) {
        const Vec3 eye = Vec3(0.5) + along * Vec3(0.3, 1, 0.2);
        const View view({.eye = eye, .target = eye + Vec3(0.3, 1, 0.2), .up = {0, 0, 1}, .ortho_height = 2}, 64, 64);
        Image image(64, 64);
        const std::vector<float> depth(64 * 64, std::numeric_limits<float>::infinity());
        draw_edges(image, depth, view, mesh, {.width_px = 1, .color = {0, 0, 0}});
        return ink_of(image);
    };
    const double all = ink(-4);
    EXPECT_GT(all, 8 * 32) << "two faces and what joins them";
    EXPECT_NEAR(ink(0), 0.5 * all, 0.05 * all) << "the far half of the box";
    EXPECT_EQ(ink(1.1), 0);
}

TEST(Overlay, EdgesNeedAPictureOfTheViewsSize) {
    Image image(8, 8);
    const View view({}, 8, 9);
    const std::vector<float> depth(64);
    test::expect_error(ErrorCode::InvalidInput, "one size", [&] { draw_edges(image, depth, view, test::make_box(1, 1, 1)); });
}

TEST(Overlay, AxesPointWhereTheyAreSeen) {
    Image image(400, 400);
    draw_axes(image, View({.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}}, 400, 400), Vec3(1.0));
    double red_x = 0, red = 0, blue_y = 0, blue = 0;
    for (int y = 0; y < 400; ++y) {
        for (int x = 0; x < 400; ++x) {
            const auto p = image.pixel(x, y);
            if (p[0] > 0.5f && p[1] < 0.1f) red_x += x, red += 1;
            if (p[2] > 0.5f && p[0] < 0.1f) blue_y += y, blue += 1;
        }
    }
    const Extent extent = extent_of(image);
    EXPECT_LT(extent.right, 150) << "in the lower left corner";
    EXPECT_GT(extent.top, 250);
    ASSERT_GT(red, 20);
    ASSERT_GT(blue, 20);
    EXPECT_GT(red_x / red, extent.left + 15) << "x to the right";
    EXPECT_LT(blue_y / blue, extent.bottom - 15) << "z up";
}

TEST(Overlay, LegendShowsTheColorsFromBelowUp) {
    const TransferFunction function = transfer_function_preset("grey", 0, 10);
    const LegendOptions options{.title = "Temp [K]", .min = 0, .max = 10};
    const int width = legend_width_px(function, options, 300);
    Image image(width, 300);
    draw_legend(image, function, options, Vec3(0.02));
    float darkest = 2, brightest = -1;
    int dark_y = 0, bright_y = 0;
    for (int y = 30; y < 290; ++y) {  // the bar: opaque pixels without ink at both sides
        for (int x = 4; x + 4 < width; ++x) {
            if (image.pixel(x - 3, y)[3] != 1 || image.pixel(x + 3, y)[3] != 1 || image.pixel(x, y)[3] != 1) continue;
            const float v = image.pixel(x, y)[0];
            if (v > brightest) brightest = v, bright_y = y;
            if (v < darkest) darkest = v, dark_y = y;
        }
    }
    EXPECT_GT(brightest, 0.9f);
    EXPECT_LT(bright_y, dark_y) << "large values above";
    EXPECT_LE(extent_of(image).right, width - 1);
}

TEST(Overlay, LegendOfTwoFieldsHasBothTitles) {
    const TransferFunction function = transfer_function_preset("viridis", 0, 1);
    LegendOptions options{.title = "Temp", .min = 0, .max = 1};
    Image one(200, 300), two(200, 300);
    draw_legend(one, function, options, Vec3(0.0));
    options.opacity_title = "Pres";
    options.opacity_min = 1e5;
    options.opacity_max = 2e5;
    draw_legend(two, function, options, Vec3(0.0));
    EXPECT_NE(one.rgba, two.rgba);
    options.opacity_max = std::numeric_limits<double>::infinity();
    test::expect_error(ErrorCode::InvalidInput, "not finite", [&] { draw_legend(two, function, options, Vec3(0.0)); });
}

TEST(Legends, HaveASwatchForEachCategoryThatFits) {
    const TransferFunction f = transfer_function_preset("categories", 1, 200);
    const auto swatches = [&](std::size_t count) {
        const LegendOptions options{.title = "", .min = 1, .max = 200, .names = std::vector<std::string>(count, "a")};
        Image image(legend_width_px(f, options, 400), 400);
        draw_legend(image, f, options, Vec3(0));
        std::size_t found = 0;
        bool inside = false;
        for (int y = 0; y < 400; ++y) {  // down the middle of the swatches
            const auto pixel = image.pixel(14, y);
            const bool colored = pixel[3] == 1 && pixel[0] + pixel[1] + pixel[2] > 0.05f;
            found += colored && !inside;
            inside = colored;
        }
        return found;
    };
    EXPECT_EQ(swatches(3), 3u);
    EXPECT_EQ(swatches(12), 12u);
    EXPECT_GE(swatches(200), 15u);
    EXPECT_LE(swatches(200), 24u) << "the last row says how many more there are";
}

/// The middle of the pixels that are of a colour; none: -1.
Vec2 middle_of(const Image& image, const Vec3& color, int& count) {
    Vec2 sum(0.0);
    count = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto pixel = image.pixel(x, y);
            if (pixel[3] != 1 || Vec3(pixel[0], pixel[1], pixel[2]) != color) continue;
            sum += Vec2(x, y);
            ++count;
        }
    }
    return count > 0 ? sum / double(count) : Vec2(-1.0);
}

TEST(Legends, ColoursBeyondTheRangeAreTipsOfTheBar) {
    const TransferFunction grey{{{0, Vec3(0.1)}, {10, Vec3(0.9)}}, {{0, 1}}};
    const Vec3 red(1, 0, 0), blue(0, 0, 1);
    LegendOptions options{.title = "T", .min = 0, .max = 10};
    const LegendStyle below{.side = LegendSide::Bottom};
    int reds = 0, blues = 0;
    for (const bool upright : {true, false}) {
        const LegendStyle style = upright ? LegendStyle{} : below;
        const auto drawn = [&] {
            const int extent = legend_extent_px(grey, options, style, 300);
            Image image(upright ? extent : 400, upright ? 300 : extent);
            draw_legend(image, grey, options, style, 300);
            return image;
        };
        options.shape = {.below = red, .above = blue};
        const Image tips = drawn();
        const Vec2 low = middle_of(tips, red, reds), high = middle_of(tips, blue, blues);
        EXPECT_GT(reds, 20);
        EXPECT_NEAR(blues, reds, 0.5 * reds) << "a few pixels, whose rows are rounded";
        EXPECT_GT(upright ? low.y - high.y : high.x - low.x, 150) << "at the two ends";
        EXPECT_NEAR(upright ? low.x - high.x : low.y - high.y, 0, 2);
        options.shape = {.above = blue};
        (void)middle_of(drawn(), red, reds);
        EXPECT_EQ(reds, 0);
    }
}

TEST(Legends, StandBelowThePicture) {
    const TransferFunction grey{{{0, Vec3(0.1)}, {10, Vec3(1)}}, {{0, 1}}};
    const LegendOptions options{.title = "T", .min = 0, .max = 10};
    const LegendStyle style{.side = LegendSide::Bottom, .ink = Vec3(1, 0, 0)}, large{.side = LegendSide::Bottom, .size = 2};
    const int rows = legend_extent_px(grey, options, style, 300);
    EXPECT_NEAR(legend_extent_px(grey, options, large, 300), 2 * rows, 2);
    Image image(400, 300 + rows);
    draw_legend(image, grey, options, style, 300);
    for (int y = 0; y < 300; ++y) {
        for (int x = 0; x < 400; ++x) ASSERT_EQ(image.pixel(x, y)[3], 0) << "the picture is left alone";
    }
    const auto grey_at = [&](int x, int y) {
        const auto pixel = image.pixel(x, y);
        return pixel[3] == 1 && pixel[0] == pixel[1] && pixel[1] == pixel[2] ? static_cast<double>(pixel[0]) : -1;
    };
    int bar = 300;
    while (bar < image.height && grey_at(200, bar) < 0) ++bar;
    ASSERT_LT(bar, image.height);
    EXPECT_NEAR(grey_at(200, bar + 2), 0.55, 0.01) << "the middle of the range in the middle of the bar";
    EXPECT_LT(grey_at(100, bar + 2), grey_at(300, bar + 2));
}

}  // namespace overlay_test
}  // namespace subvol
