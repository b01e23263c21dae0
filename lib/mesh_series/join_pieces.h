// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "mesh_file.h"

namespace subvol::detail {

/// Puts the parts of a mesh together, one after the other, and joins their points: those with the same number in an array
/// `GlobalNodeId`, where all parts have it and it numbers places; else those of different parts at exactly the same place.
/// The first of them is kept, with its values. Arrays that a part lacks are left out. Adds warnings with the counts.
///
/// word: "piece" or "block"
[[nodiscard]] MeshFile join_pieces(std::vector<MeshFile>&& pieces, std::string_view word, std::string_view file);

}  // namespace subvol::detail
