// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// The length of a vector, or the norm of a tensor, under the same name.
[[nodiscard]] Attribute length_of(const Attribute& attribute);

/// A name as expressions have it: in backquotes unless it is a word.
[[nodiscard]] std::string quoted_name(const std::string& name);

/// The names of all fields, with commas between.
[[nodiscard]] std::string list_of(const HexMesh& mesh);

}  // namespace subvol::detail
