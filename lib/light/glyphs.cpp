// SPDX-License-Identifier: Apache-2.0
#include "glyphs.h"

#include <map>
#include <sstream>
#include <string>

#include "overlay_texts.h"

namespace subvol::detail {
namespace {

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

using Font = std::map<char32_t, Glyph>;

Font read_font() {
    Font font;
    std::istringstream lines{std::string(kTexts[0].text)};
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream in(line);
        in.imbue(std::locale::classic());
        std::uint32_t code = 0;
        in >> code;
        font.emplace(code, read_glyph(in));
    }
    const auto box = [](double left, double top, double right, double bottom) {
        return std::vector<Vec2>{{left, top}, {right, top}, {right, bottom}, {left, bottom}};
    };
    Glyph unknown{0.6, {box(0.08, -0.72, 0.52, 0)}};  // 0: what the font lacks
    unknown.polygons.push_back({{0.13, -0.67}, {0.13, -0.05}, {0.47, -0.05}, {0.47, -0.67}});
    font.emplace(0, std::move(unknown));
    return font;
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

}  // namespace

PlacedText place_glyphs(std::string_view utf8) {
    static const Font font = read_font();
    PlacedText placed;
    while (!utf8.empty()) {
        const auto found = font.find(next_code(utf8));
        const Glyph& glyph = found != font.end() ? found->second : font.at(0);
        placed.glyphs.push_back({&glyph, placed.width});
        placed.width += glyph.advance;
    }
    return placed;
}

}  // namespace subvol::detail
