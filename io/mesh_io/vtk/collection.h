// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// A file that a collection names.
struct ListedFile {
    std::filesystem::path path;
    std::string block;  ///< name of its block; empty if the collection does not divide its mesh into blocks
    std::string place;  ///< where the collection names it, for messages
    /// Which part of the mesh that the path stands for (MeshFormat::part); nothing: the file is one
    std::optional<std::size_t> part = {};
};

/// The longest name of a block: each of its files has it.
inline constexpr std::size_t kLongestBlock = 1024;
inline constexpr const char* kBlockLimit = "at most 1024 bytes";

/// What a list says of the mesh besides its files.
struct ListRemarks {
    std::optional<double> time;
    std::vector<IgnoredPart> ignored;

    /// Adds to a mesh what its files did not say already; the time of the list counts.
    void add_to(std::optional<double>& time_of_mesh, std::vector<IgnoredPart>& ignored_of_mesh) const;
};

/// The steps of a collection, in the order of their times, with their files.
struct Collection {
    std::vector<double> times;
    std::vector<std::vector<ListedFile>> files;
    ListRemarks remarks = {};  ///< of lists of pieces and of blocks
};

/// Reads a file that lists others: .pvd, .series (ParaView's JSON), or one step of .pvtu, .pvts, .pvtr, .pvti, .vtm.
[[nodiscard]] Collection read_pvd(const std::filesystem::path& path);
[[nodiscard]] Collection read_series_list(const std::filesystem::path& path);
[[nodiscard]] Collection read_pieces_list(const std::filesystem::path& path);
[[nodiscard]] Collection read_blocks_list(const std::filesystem::path& path);

/// The files of one step of a collection that are read as parts of one mesh.
struct PartFiles {
    /// In the order of the lists; those of blocks that are not chosen and of surfaces are left out
    std::vector<ListedFile> files;
    std::string_view word;                  ///< "piece" or "block"
    std::vector<std::string> warnings;      ///< warnings of the step, and of the surfaces
    std::vector<IgnoredPart> ignored = {};  ///< the files of surfaces
    bool means = false;                     ///< whether values at cells are read as means over them
};

/// Returns nothing if the file is not a collection, or if its step is a single file.
///
/// throws: Error(InvalidInput) as `read_mesh`
[[nodiscard]] std::optional<PartFiles> part_files(const std::filesystem::path& path, const ReadOptions& options);

/// How messages name what is in several files: "point", "cell", from 0.
[[nodiscard]] const EntityNames& names_in_parts();

/// Reads a file as a part of a mesh, with its block's name.
[[nodiscard]] MeshFile read_part(const ListedFile& file, const ReadOptions& options);

}  // namespace subvol::detail
