// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "hdf5_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Reads a step of the first base of a CGNS file in HDF5: structured and unstructured zones, as blocks that are joined.
[[nodiscard]] ReadResult read_cgns(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_cgns(const Hdf5File& file, const ReadOptions& options);

[[nodiscard]] std::vector<double> cgns_times(const std::filesystem::path& path);

}  // namespace subvol::detail
