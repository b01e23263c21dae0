// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collection.h"
#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// A format of mesh files.
///
/// extensions: in lower case, unused ones empty
/// write:      null if the library only reads the format
/// groups:     whether its groups of faces and edges are read
/// blocks:     whether it has named parts, which ReadOptions::blocks chooses
/// times:      the times of the steps of a file; null if a file of this format is one step
/// finite_volumes: its values at cells are means over them
/// files:      reads a list of other files; null if the format is no such list
/// piece:      reads a file as a part of a mesh, before it is assembled; null if such files are no parts
struct MeshFormat {
    std::array<std::string_view, 4> extensions;
    std::string_view name;
    ReadResult (*read)(const std::filesystem::path& path, const ReadOptions& options);
    std::vector<std::string> (*write)(const std::filesystem::path& path, const HexMesh& mesh);
    bool groups = false;
    bool blocks = false;
    std::vector<double> (*times)(const std::filesystem::path& path) = nullptr;
    bool finite_volumes = false;
    MeshFile (*piece)(std::string_view text, std::string_view file, const ReadOptions& options) = nullptr;
    Collection (*files)(const std::filesystem::path& path) = nullptr;
};

[[nodiscard]] std::span<const MeshFormat> mesh_formats();

/// The format that a file name's extension names, in upper or lower case; that of a folder is OpenFOAM. Null if there is none.
[[nodiscard]] const MeshFormat* format_of(const std::filesystem::path& path);

/// The same; throws: Error(InvalidInput) that lists all formats if there is none.
[[nodiscard]] const MeshFormat& readable_format(const std::filesystem::path& path);

/// Refuses options that a format has no use for.
void check_options(const MeshFormat& format, const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
