// SPDX-License-Identifier: Apache-2.0
// A format as a row of a table, and families of formats: what a room of readers hands to `mesh_io`, which knows none of them.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/detail/read_file.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/read_options.h"
#include "subvol/shells.h"

namespace subvol::detail {

struct Collection;

/// What a writer gets, valid. shells: none for other formats than `.vtu`
struct WrittenMesh {
    const HexMesh& mesh;
    const Shells& shells;
    const MeshSets& sets;
};

/// A format of mesh files.
///
/// extensions:     in lower case, unused ones empty
/// read:           reads the mesh of one step
/// write:          null if the library only reads the format
/// times:          the times of the steps of a file; null if a file of this format is one step
/// piece:          reads a file as a piece of a mesh, before it is assembled; null if a file is always a whole mesh
/// parts:          how many parts of a mesh a name stands for, such as the pieces of which it names one, or the processors of
///                 a case; null if a name is always that of one
/// part:           reads one of these parts
/// files:          reads a list of other files; null if the format is not such a list
/// groups:         whether its groups of faces and edges are read
/// blocks:         whether it has named parts, which ReadOptions::blocks chooses
/// deck:           whether the file has results of a deck, which ReadOptions::deck names
/// folder:         whether a folder may be such a mesh
/// finite_volumes: whether its values at cells are means over them
struct MeshFormat {
    std::array<std::string_view, 4> extensions;
    std::string_view name;
    ReadResult (*read)(const std::filesystem::path& path, const ReadOptions& options);
    std::vector<std::string> (*write)(const std::filesystem::path& path, const WrittenMesh& written) = nullptr;
    std::vector<double> (*times)(const std::filesystem::path& path) = nullptr;
    MeshFile (*piece)(std::string_view text, std::string_view file, const ReadOptions& options) = nullptr;
    std::size_t (*parts)(const std::filesystem::path& path) = nullptr;
    MeshFile (*part)(const std::filesystem::path& path, std::size_t part, const ReadOptions& options) = nullptr;
    Collection (*files)(const std::filesystem::path& path) = nullptr;
    bool groups = false;
    bool blocks = false;
    bool deck = false;
    bool folder = false;
    bool finite_volumes = false;
};

/// A reader of a text as the reader of a file.
template <ReadResult (&kRead)(std::string_view, std::string_view, const ReadOptions&)>
ReadResult read_file(const std::filesystem::path& path, const ReadOptions& options) {
    return kRead(read_text(path), path.string(), options);
}

/// What the first bytes of a file show.
///
/// extension: of the format whose files begin so; empty: of none
/// certain:   an ending that says something else is wrong
struct Contents {
    std::string_view extension;
    bool certain = true;
};

/// The first bytes of a file that are looked at, and those of them at which texts are recognised.
inline constexpr std::size_t kFirstBytes = 1 << 16, kFirstText = 4096;

/// Formats whose readers are built in together, or not.
struct FormatFamily {
    std::span<const MeshFormat> formats;
    Contents (*contents)(std::string_view begin);
};

}  // namespace subvol::detail
