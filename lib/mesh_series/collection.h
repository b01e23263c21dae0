// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// A file that a collection names.
///
/// block: its name; empty if the collection does not divide its mesh into blocks
/// place: where the collection names it, for messages
struct ListedFile {
    std::filesystem::path path;
    std::string block;
    std::string place;
};

/// The steps of a collection, in the order of their times, with their files.
struct Collection {
    std::vector<double> times;
    std::vector<std::vector<ListedFile>> files;
};

/// Reads a file that lists others: .pvd, .series (ParaView's JSON), or one step of .pvtu, .pvts, .pvtr, .pvti, .vtm.
[[nodiscard]] Collection read_pvd(const std::filesystem::path& path);
[[nodiscard]] Collection read_series_list(const std::filesystem::path& path);
[[nodiscard]] Collection read_pieces_list(const std::filesystem::path& path);
[[nodiscard]] Collection read_blocks_list(const std::filesystem::path& path);

[[nodiscard]] std::vector<double> pvd_times(const std::filesystem::path& path);
[[nodiscard]] std::vector<double> series_list_times(const std::filesystem::path& path);

/// Reads a step of a collection and makes one mesh of its files.
[[nodiscard]] ReadResult read_pvd_step(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_series_step(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_pieces(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_blocks(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
