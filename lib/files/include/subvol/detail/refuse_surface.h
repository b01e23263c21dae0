// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace subvol::detail {

/// A word as a shell reads it, in quotes where it needs them.
[[nodiscard]] std::string shell_word(const std::string& word);

/// The command that makes a control mesh of a surface or a grid: `subvol mesh FILE OPTIONS -o NAME.vtu`.
[[nodiscard]] std::string command_for_surface(const std::filesystem::path& path, const std::string& options = {});

/// Whether a file of this name has a surface that is read: .stl, .obj, .ply or .glb, in any case.
[[nodiscard]] bool names_surface(const std::filesystem::path& path);

/// Whether it has a surface or a body of another program, which has to be exported: .gltf, .off, .step and the like.
[[nodiscard]] bool names_foreign_surface(const std::filesystem::path& path);

/// How a file of a surface becomes a control mesh: by the command, or by another program's export first.
[[nodiscard]] std::string way_to_cells(const std::filesystem::path& path);

/// Refuses a surface where a mesh or points are needed.
///
/// throws: Error(InvalidInput), with the command that makes a control mesh of the file
[[noreturn]] void refuse_surface(const std::filesystem::path& path);

/// For messages about what kind of file one is: a file that is not there is none.
///
/// throws: Error(Io) if there is no such file
void refuse_missing(const std::filesystem::path& path);

}  // namespace subvol::detail
