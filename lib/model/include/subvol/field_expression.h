// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A field of a mesh by its name, or computed at its points: an expression of the coordinates x, y, z and of fields, such as
/// "(Temp-293)/620" or "length(V)*(z>0)". A vector V stands for its length, V.x, V.y, V.z for its components; numbers count
/// them from 0, as in V.0. Coordinates come before fields of the same name. Names of letters, digits and _ can be used.
///
/// name:    of the result, which has one channel unless the source is the name of a vector
/// throws:  Error(InvalidInput) with the position if the expression is wrong, or if a value is not finite; lists the fields
[[nodiscard]] Attribute field_of(const HexMesh& mesh, const std::string& name, const std::string& source);

}  // namespace subvol
