// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "hdf5_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Reads a step of an unstructured grid in a VTKHDF file, of versions 1 and 2. Its partitions are joined.
[[nodiscard]] ReadResult read_vtkhdf(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_vtkhdf(const Hdf5File& file, const ReadOptions& options);

[[nodiscard]] std::vector<double> vtkhdf_times(const std::filesystem::path& path);
[[nodiscard]] std::vector<double> vtkhdf_times(const Hdf5File& file);

}  // namespace subvol::detail
