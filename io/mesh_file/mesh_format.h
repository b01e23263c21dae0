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

/// What a writer gets, valid.
struct WrittenMesh {
    const HexMesh& mesh;
    const Shells& shells;  ///< none for other formats than `.vtu`
    const MeshSets& sets;
};

/// Adds a warning that a writer leaves fields out, if there are any. extension: of the file
void warn_of_lost_fields(std::string_view extension, std::span<const Attribute> fields, std::vector<std::string>& warnings);

/// Adds a warning that a writer leaves the creases and sharp faces of a mesh out, if it has any.
void warn_of_lost_creases(std::string_view extension, const HexMesh& mesh, std::vector<std::string>& warnings);

/// A format of mesh files.
struct MeshFormat {
    std::array<std::string_view, 4> extensions;  ///< in lower case, unused ones empty
    std::string_view name;
    ReadResult (*read)(const std::filesystem::path& path, const ReadOptions& options);  ///< reads the mesh of one step
    /// Null if the library only reads the format
    std::vector<std::string> (*write)(const std::filesystem::path& path, const WrittenMesh& written) = nullptr;
    /// The times of the steps of a file; null if a file of this format is one step
    std::vector<double> (*times)(const std::filesystem::path& path) = nullptr;
    /// Reads a file as a piece of a mesh, before it is assembled; null if a file is always a whole mesh
    MeshFile (*piece)(std::string_view text, std::string_view file, const ReadOptions& options) = nullptr;
    /// How many parts of a mesh a name stands for, such as the pieces of which it names one, or the processors of a case; null
    /// if a name is always that of one
    std::size_t (*parts)(const std::filesystem::path& path) = nullptr;
    /// Reads one of these parts
    MeshFile (*part)(const std::filesystem::path& path, std::size_t part, const ReadOptions& options) = nullptr;
    /// Reads a list of other files; null if the format is not such a list
    Collection (*files)(const std::filesystem::path& path) = nullptr;
    bool groups = false;          ///< whether its groups of faces and edges are read
    bool blocks = false;          ///< whether it has named parts, which ReadOptions::blocks chooses
    bool deck = false;            ///< whether the file has results of a deck, which ReadOptions::deck names
    bool folder = false;          ///< whether a folder may be such a mesh
    bool finite_volumes = false;  ///< whether its values at cells are means over them
};

/// A reader of a text as the reader of a file.
template <ReadResult (&kRead)(std::string_view, std::string_view, const ReadOptions&)>
ReadResult read_file(const std::filesystem::path& path, const ReadOptions& options) {
    return kRead(read_text(path), path.string(), options);
}

/// What the first bytes of a file show.
struct Contents {
    std::string_view extension;  ///< extension of the format whose files begin so; empty: no format has such files
    bool certain = true;         ///< an ending that says something else is wrong
    bool shared = false;         ///< files of other programs begin so, too: an ending of theirs is right
};

/// The first bytes of a file that are looked at, and those of them at which texts are recognised.
inline constexpr std::size_t kFirstBytes = 1 << 16, kFirstText = 4096;

/// Formats whose readers are built in together, or not.
struct FormatFamily {
    std::span<const MeshFormat> formats;
    Contents (*contents)(std::string_view begin);
};

}  // namespace subvol::detail
