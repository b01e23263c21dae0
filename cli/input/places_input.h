// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::cli {

/// Reads places from a table: one a line, three numbers between commas, semicolons, blanks or tabs. The first line may have
/// names; where x, y and z are among them, these columns are taken, else the first three. Lines that are empty or begin with #
/// are left out.
///
/// throws: Error(Io) if the file cannot be read; Error(InvalidInput) with the file and the line
[[nodiscard]] std::vector<Vec3> read_places(const std::string& path);

/// Reads places and what was measured there, as points and attributes: `read_places`, and each other column that has a name, or
/// without names the fourth and all after it as v1, v2, …
///
/// throws: as `read_places`; Error(InvalidInput) for a value that is not a finite number, or if there is no such column
[[nodiscard]] HexMesh read_samples(const std::string& path);

}  // namespace subvol::cli
