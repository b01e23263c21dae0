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

/// Appends an element with attributes.
pugi::xml_node append_element(pugi::xml_node parent, const char* name,
                              std::initializer_list<std::pair<const char*, std::string>> attributes);

}  // namespace subvol::detail
