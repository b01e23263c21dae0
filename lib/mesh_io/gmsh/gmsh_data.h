// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gmsh_values.h"
#include "mesh_file.h"

namespace subvol::detail {

/// A name without the quotes and blanks around it; "unnamed" if it is empty.
[[nodiscard]] std::string unquoted(std::string_view text);

/// The nodes or the elements that a data section has values for.
///
/// at_cells: they are the elements
/// numbers:  the numbers that the file gives them
/// needed:   a flag for each: whether it must have a value. If one of these has none, the array is left out with a warning
struct GmshEntities {
    bool at_cells;
    const GmshNumbers& numbers;
    std::span<const std::uint8_t> needed;
};

/// Reads the section $NodeData or $ElementData, whose keyword was the last word, and appends it as an array.
void read_gmsh_data(TextScanner& in, GmshValues& values, const GmshEntities& entities, MeshFile& found);

}  // namespace subvol::detail
