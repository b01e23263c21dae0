// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// The corners of each side of a shape.
using CornersOfSides = std::vector<std::vector<std::size_t>>;

/// The nodes of the sides of a type of elements, such as HEX8, as Exodus numbers them from 1; none for other shapes.
[[nodiscard]] const CornersOfSides& exodus_sides(std::string_view type);

}  // namespace subvol::detail
