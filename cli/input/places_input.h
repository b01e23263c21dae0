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

/// "x0,y0,z0,x1,y1,z1" and the like as so many numbers. option: named in the error
///
/// throws: Error(InvalidInput) if it is anything else
[[nodiscard]] std::vector<double> parse_numbers(const std::string& option, const std::string& value, std::size_t count,
                                                const std::string& example);

}  // namespace subvol::cli
