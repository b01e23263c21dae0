// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <pugixml.hpp>
#include <string>
#include <utility>

#include "subvol/vec.h"

namespace subvol::detail {

/// A length with two decimals.
[[nodiscard]] std::string svg_number(double x);

/// A colour of linear light in sRGB: #0080ff
[[nodiscard]] std::string svg_color(const Vec3& linear);

/// Begins a document with a sheet of its size, in pixels. attributes: more of its element
pugi::xml_node append_svg(pugi::xml_document& document, int width, int height, const std::string& sheet_color,
                          std::initializer_list<std::pair<const char*, std::string>> attributes);

/// The text of a document.
[[nodiscard]] std::string svg_text(const pugi::xml_document& document);

/// Appends an element with attributes.
pugi::xml_node append_element(pugi::xml_node parent, const char* name,
                              std::initializer_list<std::pair<const char*, std::string>> attributes);

}  // namespace subvol::detail
