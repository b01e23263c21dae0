// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace subvol::detail {

enum class InpShape { Other, Hex, Prism, Pyramid, Tet, Quad, Line };

/// A type of elements of Abaqus or CalculiX.
struct InpType {
    std::string name;  ///< in capitals, such as C3D8R
    InpShape shape = InpShape::Other;
    std::size_t nodes = 0;  ///< number of nodes of an element, its corners first; 0 for Other
};

/// What the name of a type says of its shape, whatever its elements compute.
[[nodiscard]] InpType inp_type(std::string_view name);

/// The corners of each side of a shape, as Abaqus and CalculiX number them; none for shells.
using CornersOfSides = std::vector<std::vector<std::size_t>>;
[[nodiscard]] const CornersOfSides& inp_sides(InpShape shape);

[[nodiscard]] constexpr bool is_shell(InpShape shape) {
    return shape == InpShape::Quad || shape == InpShape::Line;
}

}  // namespace subvol::detail
