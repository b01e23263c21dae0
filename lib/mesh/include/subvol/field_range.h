// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// The least and the largest value of each channel of a field.
struct FieldRange {
    std::vector<double> min, max;
};

/// throws: Error(InvalidInput) if there are no values
[[nodiscard]] FieldRange range_of(const Attribute& field);

/// Moves values beyond the range to its nearer end, channel by channel: interpolating schemes overshoot between control points.
///
/// returns: how many values were moved
/// throws:  Error(InvalidInput) if the range has another number of channels
std::size_t clamp_to(Attribute& field, const FieldRange& range);

/// Turns a mesh from z up to y up, as most programs for pictures have it: (x, y, z) becomes (x, z, -y), points and fields of
/// three components alike.
void turn_y_up(HexMesh& mesh);

/// Multiplies the coordinates. throws: Error(InvalidInput) if the factor is not positive
void scale_points(HexMesh& mesh, double factor);

}  // namespace subvol
