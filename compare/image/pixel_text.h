// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "subvol/image.h"

namespace subvol::detail {

inline constexpr int kTextHeight = 10;  // pixels

/// The width of a number in pixels.
[[nodiscard]] int text_width(std::string_view text);

/// Writes a number (digits, '.', '-', '+', 'e') in white with its top left pixel at x, y; what lies outside is left out.
void draw_text(Image& image, std::string_view text, int x, int y);

}  // namespace subvol::detail
