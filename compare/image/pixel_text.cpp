// SPDX-License-Identifier: Apache-2.0
#include "pixel_text.h"

#include <array>

namespace subvol::detail {

namespace {

constexpr int kScale = 2;
constexpr int kColumns = 3, kRows = 5;

// Our own 3 × 5 pixel digits: no font file has to be found where the program runs.
struct Glyph {
    char character;
    std::array<std::string_view, kRows> rows;
};
constexpr std::array<Glyph, 14> kGlyphs{{{'0', {"###", "# #", "# #", "# #", "###"}},
                                         {'1', {" # ", "## ", " # ", " # ", "###"}},
                                         {'2', {"###", "  #", "###", "#  ", "###"}},
                                         {'3', {"###", "  #", " ##", "  #", "###"}},
                                         {'4', {"# #", "# #", "###", "  #", "  #"}},
                                         {'5', {"###", "#  ", "###", "  #", "###"}},
                                         {'6', {"###", "#  ", "###", "# #", "###"}},
                                         {'7', {"###", "  #", "  #", " # ", " # "}},
                                         {'8', {"###", "# #", "###", "# #", "###"}},
                                         {'9', {"###", "# #", "###", "  #", "###"}},
                                         {'.', {"   ", "   ", "   ", "   ", " # "}},
                                         {'-', {"   ", "   ", "###", "   ", "   "}},
                                         {'+', {"   ", " # ", "###", " # ", "   "}},
                                         {'e', {"   ", "###", "###", "#  ", "###"}}}};
static_assert(kRows * kScale == kTextHeight);

void draw_dot(Image& image, int left, int top) {
    for (int y = top; y < top + kScale; ++y) {
        for (int x = left; x < left + kScale; ++x) {
            if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
            for (float& component : image.pixel(x, y)) component = 1.0f;
        }
    }
}

void draw_glyph(Image& image, const Glyph& glyph, int left, int top) {
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            const bool set = glyph.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#';
            if (set) draw_dot(image, left + column * kScale, top + row * kScale);
        }
    }
}

}  // namespace

int text_width(std::string_view text) {
    return (static_cast<int>(text.size()) * (kColumns + 1) - 1) * kScale;
}

void draw_text(Image& image, std::string_view text, int x, int y) {
    for (const char character : text) {
        for (const Glyph& glyph : kGlyphs) {
            if (glyph.character == character) draw_glyph(image, glyph, x, y);
        }
        x += (kColumns + 1) * kScale;
    }
}

}  // namespace subvol::detail
