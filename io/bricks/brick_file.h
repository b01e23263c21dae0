// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "subvol/bricks.h"

namespace subvol::detail {

/// The arrays at points with their numbers in the whole mesh, and with 1 for those of the halo; no field has these names.
inline constexpr const char* kNodeNumbers = "GlobalNodeId";
inline constexpr const char* kGhosts = "vtkGhostType";

/// Bytes and hash of a file that was written.
struct WrittenBrick {
    std::uint64_t bytes = 0, hash = 0;
};

/// Writes a brick as .vtu with raw appended data. GlobalNodeId and GlobalCellId are its numbers in the whole mesh; vtkGhostType
/// is 1 in the halo; tags are field data. The file is on the disk once `sync_files_in` has been called for the folder.
///
/// id: of the folder
WrittenBrick write_brick_file(const std::filesystem::path& path, const MeshPiece& brick, std::uint64_t id);

/// throws: Error(InvalidInput) unless the file has this hash and was written by `write_brick_file` for this folder
[[nodiscard]] MeshPiece read_brick_file(const std::filesystem::path& path, std::uint64_t hash, std::uint64_t id);

/// Whether a file was written by `write_brick_file` for this folder, or is what a loss of power left of one; throws: Error(Io)
[[nodiscard]] bool is_brick_of(const std::filesystem::path& path, std::uint64_t id);

/// The hash of a file; throws: Error(Io)
[[nodiscard]] std::uint64_t hash_of_file(const std::filesystem::path& path);

}  // namespace subvol::detail
