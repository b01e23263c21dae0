// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "subvol/vdb_grid.h"

namespace subvol {

/// Whether this build writes NanoVDB files; it does if NanoVDB's headers were found when it was configured.
[[nodiscard]] bool has_nanovdb();

/// Writes grids into one `.nvdb` file, without compression so that it can be mapped into memory; floats keep their 32 bits. The
/// file appears whole under its name or not at all.
///
/// throws: Error(MissingCapability) unless `has_nanovdb`; Error(Io); Error(InvalidInput) if a grid has voxels of a type that
///         `rasterize` does not make
/// cost:   memory: one copy of the grids
void write_nanovdb(const std::filesystem::path& path, std::span<const VdbGrid> grids);

}  // namespace subvol
