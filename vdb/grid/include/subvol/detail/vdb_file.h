// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/detail/atomic_file.h"
#include "subvol/vdb_grid.h"

namespace subvol::detail {

/// Writes grids into a file that the caller commits, alone or together with others.
///
/// path:   the file's final name, for error messages
/// throws: as `subvol::write_vdb`
void write_vdb(const AtomicFile& file, const std::filesystem::path& path, std::span<const VdbGrid> grids,
               VdbCompression compression);

/// Another object for the same grid: the voxels are shared, the report is copied. For those who need grids side by side that
/// lie elsewhere, and that others use meanwhile.
[[nodiscard]] VdbGrid shared_grid(const VdbGrid& grid);

}  // namespace subvol::detail
