// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace subvol::cli {

// Numbers for people: three digits or so, with a unit. JSON has them in full, in SI units.

/// "142 MB"
[[nodiscard]] std::string bytes_text(double bytes);

/// "35 ms", "1.4 s", "2 min 10 s"
[[nodiscard]] std::string seconds_text(double seconds);

/// "7,456"
[[nodiscard]] std::string count_text(std::uint64_t count);

/// "7,456 cells", "1 cell"; plural: "s" is appended unless it is given
[[nodiscard]] std::string counted(std::uint64_t count, const std::string& one, const std::string& many = {});

/// Lines "name   words", with the words one below the other.
using Lines = std::vector<std::pair<std::string, std::string>>;
[[nodiscard]] std::string aligned(const Lines& lines);

}  // namespace subvol::cli
