// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "picture_arguments.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"

namespace subvol::cli {

/// The names of the fields of a mesh.
[[nodiscard]] std::vector<std::string> names_of(const HexMesh& mesh);

/// A grid's name, and the field or the expression that it gets its values from: often its name.
struct GridField {
    std::string name, source;
};

/// Reads "A,B=C,D=max(E,F)": commas in parentheses are those of functions.
///
/// throws: Error(InvalidInput) for an empty name or source, or two grids of one name
[[nodiscard]] std::vector<GridField> parse_grid_fields(const std::vector<std::string>& texts);

/// Values from `low` to `high` become those from to_low to to_high.
struct Remap {
    std::string grid;  // empty: the first
    double low = 0, high = 1, to_low = 0, to_high = 1;
};

/// "[GRID=]LO,HI[:A,B]". throws: Error(InvalidInput)
[[nodiscard]] Remap parse_remap(const std::string& text);

/// Changes the values at the points of the mesh; those beyond the range go beyond the new range, too.
///
/// throws: Error(InvalidInput) if there is no such field, or if it has more than one component
void apply(const Remap& remap, HexMesh& mesh);

/// A remark on values beyond those of the field's points, as an interpolating scheme makes them; empty if there are none.
[[nodiscard]] std::string beyond(const std::string& field, const Range& given, const Range& found);

}  // namespace subvol::cli
