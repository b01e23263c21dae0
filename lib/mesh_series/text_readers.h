// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Reads a step of XDMF 2 or 3. file: in its folder are the files of values
[[nodiscard]] ReadResult read_xdmf(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> xdmf_times(const std::filesystem::path& path);

/// Reads a step of CalculiX's results, as text.
[[nodiscard]] ReadResult read_frd(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> frd_times(const std::filesystem::path& path);

}  // namespace subvol::detail
