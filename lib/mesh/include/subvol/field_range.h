// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// The least and the largest value of each channel of a field.
struct FieldRange {
    std::vector<double> min, max;
};

/// The numbers that a field has: at its cells where it is constant in each, else at its points.
[[nodiscard]] inline const std::vector<double>& own_values(const Attribute& field) {
    return field.constant ? field.cells : field.values;
}

/// throws: Error(InvalidInput) if there are no values
[[nodiscard]] FieldRange range_of(const Attribute& field);

/// Moves values beyond the range to its nearer end, channel by channel: interpolating schemes overshoot between control points.
///
/// returns: how many values were moved
/// throws:  Error(InvalidInput) if the range has another number of channels
std::size_t clamp_to(Attribute& field, const FieldRange& range);

/// The bounds of a field as a range; nothing if it has none.
[[nodiscard]] std::optional<FieldRange> bounds_of(const Attribute& field);

/// The value that others are stored relative to where 32-bit floats alone would lose digits: the middle of the range if the
/// greatest value is more than 16 times the range, as of a pressure that varies by a few parts of the atmosphere's; otherwise
/// 0, and values keep their bits.
[[nodiscard]] double value_origin(double min, double max);

/// How far 32-bit floats, or 16-bit ones, round the values of a field, as a part of its range. 0 for a constant.
[[nodiscard]] double float_rounding(const Attribute& field, bool half = false);

/// A sentence for users if floats keep less than a thousandth of a field's range; else empty.
[[nodiscard]] std::string rounding_warning(const Attribute& field, bool half = false);

/// Turns a mesh from z up to y up, as most programs for pictures have it: (x, y, z) becomes (x, z, -y), points and fields of
/// three components alike.
void turn_y_up(HexMesh& mesh);

/// Multiplies the coordinates. throws: Error(InvalidInput) if the factor is not positive
void scale_points(HexMesh& mesh, double factor);

}  // namespace subvol
