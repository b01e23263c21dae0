// SPDX-License-Identifier: Apache-2.0
// Lines, areas and letters on a picture or a vector graphic, and what is made of them: axes and the scale bar. Letters of a
// picture are the outlines of the built-in font, filled by the part of each pixel that is inside; those of a graphic stay text
// of its fonts, which has about the same widths.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "overlay_texts.h"
#include "subvol/detail/coverage.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/overlay.h"
#include "subvol/srgb.h"
#include "subvol/vec.h"

namespace subvol {

using namespace detail;

namespace {

/// A letter's outline as closed polygons, in ems: y is down, 0 at the base line.
struct Glyph {
    double advance = 0;
    std::vector<std::vector<Vec2>> polygons;
};

/// The glyphs of a text in UTF-8, each with the place where it starts on the base line, in ems.
struct PlacedGlyph {
    Glyph glyph;
    double start;
};

struct PlacedText {
    std::vector<PlacedGlyph> glyphs;
    double width = 0;
};

constexpr double kUnitsPerEm = 512;
constexpr int kSteps = 6;  // of a curve: at 100 pixels an em, the chords are off by less than a tenth of a pixel

Vec2 read_point(std::istream& in) {
    double x = 0, y = 0;
    in >> x >> y;
    return Vec2(x, -y) / kUnitsPerEm;
}

Glyph read_glyph(std::istream& in) {
    Glyph glyph;
    in >> glyph.advance;
    glyph.advance /= kUnitsPerEm;
    for (char command = 0; in >> command;) {
        if (command == 'M') {
            glyph.polygons.push_back({read_point(in)});
        } else if (command == 'L') {
            glyph.polygons.back().push_back(read_point(in));
        } else {
            auto& polygon = glyph.polygons.back();
            const Vec2 a = polygon.back(), b = read_point(in), c = read_point(in);
            for (int i = 1; i <= kSteps; ++i) {
                const double t = static_cast<double>(i) / kSteps;
                polygon.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c);
            }
        }
    }
    return glyph;
}

/// The lines of the font, whose outlines are read where they are drawn: a picture needs a few of its hundreds of letters.
using Font = std::map<char32_t, std::string_view>;

const Font& built_in_font() {
    static const Font font = [] {
        Font lines;
        for (std::string_view text = kTexts[0].text; !text.empty();) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            std::uint32_t code = 0;
            const auto [rest, error] = std::from_chars(text.data(), text.data() + end, code);
            if (error == std::errc()) {  // not a comment
                const auto head = static_cast<std::size_t>(rest - text.data());
                lines.emplace(code, text.substr(head, end - head));
            }
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        return lines;
    }();
    return font;
}

/// What is drawn for letters that the font lacks.
Glyph make_box() {
    const auto box = [](double left, double top, double right, double bottom) {
        return std::vector<Vec2>{{left, top}, {right, top}, {right, bottom}, {left, bottom}};
    };
    Glyph unknown{0.6, {box(0.08, -0.72, 0.52, 0)}};
    unknown.polygons.push_back({{0.13, -0.67}, {0.13, -0.05}, {0.47, -0.05}, {0.47, -0.67}});
    return unknown;
}

Glyph glyph_of(char32_t code) {
    const auto found = built_in_font().find(code);
    if (found == built_in_font().end()) return make_box();
    std::istringstream line{std::string(found->second)};
    line.imbue(std::locale::classic());
    return read_glyph(line);
}

/// Takes the next code point off a text; 0 for a byte that is not UTF-8.
char32_t next_code(std::string_view& text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const unsigned lead = byte(0);
    const std::size_t more = lead < 0x80 ? 0 : lead >= 0xf0 && lead < 0xf8 ? 3 : lead >= 0xe0 && lead < 0xf0 ? 2 : 1;
    char32_t code = lead < 0x80 ? lead : lead & (0x3fU >> more);
    bool valid = lead < 0x80 || (lead >= 0xc0 && lead < 0xf8);
    for (std::size_t i = 1; valid && i <= more; ++i) {
        valid = (byte(i) & 0xc0U) == 0x80;
        code = code << 6U | (byte(i) & 0x3fU);
    }
    text.remove_prefix(valid ? more + 1 : 1);
    return valid ? code : 0;
}

PlacedText place_glyphs(std::string_view utf8) {
    PlacedText placed;
    while (!utf8.empty()) {
        placed.glyphs.push_back({glyph_of(next_code(utf8)), placed.width});
        placed.width += placed.glyphs.back().glyph.advance;
    }
    return placed;
}

}  // namespace

void draw_text(const DrawTarget& target, const Vec2& place, const std::string& text, const TextOptions& options) {
    if (VectorGraphic* const graphic = target.graphic()) {
        graphic->shapes.emplace_back(TextShape{place, printable(text), options});
        return;
    }
    const PlacedText placed = place_glyphs(text);
    const double part = options.anchor == TextAnchor::Start ? 0 : options.anchor == TextAnchor::Middle ? 0.5 : 1;
    const double start = place.x - part * placed.width * options.size_px;
    for (const auto& [glyph, offset] : placed.glyphs) {
        std::vector<std::vector<Vec2>> polygons = glyph.polygons;
        for (auto& polygon : polygons) {
            for (Vec2& p : polygon) p = Vec2(start + offset * options.size_px, place.y) + options.size_px * p;
        }
        fill(*target.image(), polygons, options.color);
    }
}

void draw_text(Image& image, const Vec2& place, const std::string& text, const TextOptions& options) {
    draw_text(DrawTarget(image), place, text, options);
}

double text_width_px(const std::string& text, double size_px) {
    return place_glyphs(text).width * size_px;
}

std::string cut_text(std::string text, double size_px, double room_px) {
    if (text_width_px(text, size_px) <= room_px) return text;
    while (!text.empty() && text_width_px(text + "…", size_px) > room_px) {
        while ((static_cast<unsigned char>(text.back()) & 0xc0U) == 0x80 && text.size() > 1) text.pop_back();
        text.pop_back();
    }
    return text + "…";
}

std::vector<std::string> missing_letters(std::span<const std::string> texts) {
    std::vector<std::string> missing;
    for (const std::string& text : texts) {
        for (std::string_view rest = text; !rest.empty();) {
            const std::string_view before = rest;
            if (built_in_font().contains(next_code(rest))) continue;
            std::string letter(before.substr(0, before.size() - rest.size()));
            if (std::ranges::find(missing, letter) == missing.end()) missing.push_back(std::move(letter));
        }
    }
    return missing;
}

void draw_polyline(const DrawTarget& target, std::span<const Vec2> places, const LineOptions& options) {
    if (VectorGraphic* const graphic = target.graphic()) {
        graphic->shapes.emplace_back(LineShape{{places.begin(), places.end()}, options});
        return;
    }
    Image& image = *target.image();
    for (std::size_t i = 1; i < places.size(); ++i) {
        for_each_pixel_of_line(
            image.width, image.height, places[i - 1], places[i], options.width_px,
            [&](int x, int y, double cover, double) { put_over(image, x, y, options.color, options.alpha * cover); });
    }
}

void draw_line(const DrawTarget& target, const Vec2& from, const Vec2& to, const LineOptions& options) {
    draw_polyline(target, std::array{from, to}, options);
}

void draw_line(Image& image, const Vec2& from, const Vec2& to, const LineOptions& options) {
    draw_line(DrawTarget(image), from, to, options);
}

void draw_area(const DrawTarget& target, std::span<const Vec2> corners, const Vec3& color) {
    std::vector<Vec2> polygon(corners.begin(), corners.end());
    if (VectorGraphic* const graphic = target.graphic()) {
        graphic->shapes.emplace_back(AreaShape{.corners = std::move(polygon), .color = color});
    } else {
        fill(*target.image(), std::array{std::move(polygon)}, color);
    }
}

void draw_box(const DrawTarget& target, const Vec2& low, const Vec2& high, const Vec3& color, double alpha) {
    if (VectorGraphic* const graphic = target.graphic()) {
        graphic->shapes.emplace_back(AreaShape{{low, {high.x, low.y}, high, {low.x, high.y}}, color, alpha});
        return;
    }
    Image& image = *target.image();
    const auto pixel = [](double place, int most) { return static_cast<int>(std::clamp(place, 0.0, double(most))); };
    const int right = pixel(high.x, image.width), bottom = pixel(high.y, image.height);
    for (int y = pixel(low.y, image.height); y < bottom; ++y) {
        for (int x = pixel(low.x, image.width); x < right; ++x) put_over(image, x, y, color, alpha);
    }
}

namespace {

double axes_scale(int width, int height) {
    return std::max(1.0, std::min(width, height) / 512.0);
}

}  // namespace

Vec2 axes_extent_px(int width, int height) {
    return axes_scale(width, height) * Vec2(34 + 22 + 34 + 19, 34 + 20 + 34 + 19);  // margin, arms to both sides, a name
}

void draw_axes(Image& image, const View& view, const Vec3& ink) {
    struct Axis {
        Vec3 eye;
        const char* name;
        Vec3 color;
    };
    const auto& [right, up, forward] = view.axes();
    const auto linear = [](int red, int green, int blue) { return linear_from_srgb(Vec3(red, green, blue) / 255.0); };
    std::array<Axis, 3> axes{{{{}, "x", linear(214, 48, 49)}, {{}, "y", linear(24, 150, 72)}, {{}, "z", linear(40, 98, 224)}}};
    for (int a = 0; a < 3; ++a) axes[static_cast<std::size_t>(a)].eye = {right[a], up[a], forward[a]};
    std::ranges::sort(axes, std::greater{}, [](const Axis& axis) { return axis.eye.z; });  // those away from the eye first
    const double scale = axes_scale(image.width, image.height);
    const double arm = 34 * scale, size = 13 * scale;
    const Vec2 origin(arm + 22 * scale, image.height - arm - 20 * scale);
    for (const Axis& axis : axes) {
        const Vec2 direction(axis.eye.x, -axis.eye.y);
        const Vec2 tip = origin + arm * direction;
        draw_line(image, origin, tip, {.width_px = 2.4 * scale, .color = axis.color});
        const double length = glm::length(direction);
        if (length > 0.15) {  // an arrow's head
            const Vec2 along = direction / length, across(-along.y, along.x);
            const double head = 7 * scale;
            const std::array<std::vector<Vec2>, 1> triangle{
                {{tip + 0.6 * head * along, tip - 0.7 * head * along + 0.5 * head * across,
                  tip - 0.7 * head * along - 0.5 * head * across}}};
            fill(image, triangle, axis.color);
        }
        const Vec2 beyond = length > 0.15 ? tip + 13 * scale * direction / length : tip + Vec2(8, -8) * scale;
        draw_text(image, beyond + Vec2(0, 0.27 * size), axis.name,
                  {.size_px = size, .color = ink, .anchor = TextAnchor::Middle});
    }
}

void draw_scale_bar(Image& image, const View& view, const Vec3& at, const Vec3& ink) {
    draw_scale_bar(image, view, at, ink, 0);
}

void draw_scale_bar(Image& image, const View& view, const Vec3& at, const Vec3& ink, double above_px) {
    const double depth = view.perspective() ? view.to_eye(at).z : 1;
    const double world_per_px = view.pixel() * depth;
    if (!(world_per_px > 0) || !std::isfinite(world_per_px)) return;  // the point is behind the eye
    const double most = 0.25 * view.width() * world_per_px, power = std::pow(10, std::floor(std::log10(most)));
    const double length = (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1) * power;
    const double letter = std::clamp(std::min(image.width, image.height) / 36.0, 8.0, 120.0), line = std::max(1.0, letter / 8);
    const Vec2 end{view.width() - letter, view.height() - letter - above_px}, start = end - Vec2(length / world_per_px, 0);
    const Vec2 cap{0, 0.35 * letter};
    draw_line(image, start, end, {.width_px = line, .color = ink});
    for (const Vec2& p : {start, end}) draw_line(image, p - cap, p + cap, {.width_px = line, .color = ink});
    draw_text(image, 0.5 * (start + end) - Vec2(0, 0.7 * letter), number_text(length, 3),
              {.size_px = letter, .color = ink, .anchor = TextAnchor::Middle});
}

}  // namespace subvol
