// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// A letter's outline as closed polygons, in ems: y is down, 0 at the base line.
struct Glyph {
    double advance = 0;
    std::vector<std::vector<Vec2>> polygons;
};

/// The glyphs of a text in UTF-8, each with the place where it starts on the base line, in ems.
struct PlacedGlyph {
    const Glyph* glyph;
    double start;
};
struct PlacedText {
    std::vector<PlacedGlyph> glyphs;
    double width = 0;
};
[[nodiscard]] PlacedText place_glyphs(std::string_view utf8);

}  // namespace subvol::detail
