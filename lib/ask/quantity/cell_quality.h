// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A measure of the cells' shape by its name, as a field that is constant in each cell; its values at points are means over the
/// cells there. Nothing if no measure has that name.
///
///     quality, scaled_jacobian   the least scaled Jacobian at the corners: 1 for a cube, at most 0 for an inverted cell
///     aspect, aspect_ratio       `aspect_ratio`: the longest edge over the shortest
[[nodiscard]] std::optional<Attribute> cell_quality(const HexMesh& mesh, std::string_view name);

}  // namespace subvol::detail
