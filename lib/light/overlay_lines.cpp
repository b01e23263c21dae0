// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "coverage.h"
#include "glyphs.h"
#include "subvol/overlay.h"
#include "subvol/srgb.h"

namespace subvol {

using namespace detail;

void draw_text(Image& image, const Vec2& place, const std::string& text, const TextOptions& options) {
    const PlacedText placed = place_glyphs(text);
    const double part = options.anchor == TextAnchor::Start ? 0 : options.anchor == TextAnchor::Middle ? 0.5 : 1;
    const double start = place.x - part * placed.width * options.size_px;
    for (const auto& [glyph, offset] : placed.glyphs) {
        std::vector<std::vector<Vec2>> polygons = glyph->polygons;
        for (auto& polygon : polygons) {
            for (Vec2& p : polygon) p = Vec2(start + offset * options.size_px, place.y) + options.size_px * p;
        }
        fill(image, polygons, options.color);
    }
}

double text_width_px(const std::string& text, double size_px) {
    return place_glyphs(text).width * size_px;
}

void draw_line(Image& image, const Vec2& from, const Vec2& to, const LineOptions& options) {
    for_each_pixel_of_line(image, from, to, options.width_px, [&](int x, int y, double cover, double) {
        put_over(image, x, y, options.color, options.alpha * cover);
    });
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
    const double scale = std::max(1.0, std::min(image.width, image.height) / 512.0);
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

}  // namespace subvol
