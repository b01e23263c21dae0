// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/Grid.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "subvol/detail/atomic_file.h"
#include "subvol/vdb_grid.h"

namespace subvol::detail {

/// The grids of one type in a file, which is checked before OpenVDB reads it (docs/adr/0017).
///
/// type:   OpenVDB's name of the type; what: its name in messages, such as "float grid"
/// throws: Error(Io); Error(InvalidInput) if it is not a whole OpenVDB file or holds no such grid
[[nodiscard]] openvdb::GridPtrVec read_grids(const std::filesystem::path& path, const std::string& type,
                                             const std::string& what);

/// The grids of several types, in the file's order; `other` gets the names and types of all others. throws: as above
[[nodiscard]] openvdb::GridPtrVec read_grids(const std::filesystem::path& path, std::span<const std::string> types,
                                             const std::function<void(const std::string&, const std::string&)>& other);

/// The types of a file's grids; the grids themselves are not read.
///
/// throws: Error(Io), Error(InvalidInput) if it is not an OpenVDB file
[[nodiscard]] std::vector<std::string> grid_types(const std::filesystem::path& path);

/// Writes grids to the temporary file of `file`.
///
/// path:   its final name, for error messages
/// throws: Error(Io); Error(MissingCapability) if OpenVDB was built without that compression
void write_grids(const AtomicFile& file, const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                 VdbCompression compression = VdbCompression::Blosc);

}  // namespace subvol::detail
