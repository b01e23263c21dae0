// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/vec.h"

namespace subvol::cli {

/// Reads places from a table: one a line, three numbers between commas, semicolons, blanks or tabs. The first line may have
/// names; where x, y and z are among them, these columns are taken, else the first three. Lines that are empty or begin with #
/// are left out.
///
/// throws: Error(Io) if the file cannot be read; Error(InvalidInput) with the file and the line
[[nodiscard]] std::vector<Vec3> read_places(const std::string& path);

}  // namespace subvol::cli
