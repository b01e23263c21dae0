// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Reads an Abaqus or CalculiX deck: nodes, elements of volumes, parts, instances, and sets of elements as blocks.
[[nodiscard]] ReadResult read_inp(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
