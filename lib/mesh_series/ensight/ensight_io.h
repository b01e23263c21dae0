// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Reads a step of an EnSight Gold case, of text or of C's binary files. Its parts are joined.
[[nodiscard]] ReadResult read_ensight(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] std::vector<double> ensight_times(const std::filesystem::path& path);

}  // namespace subvol::detail
