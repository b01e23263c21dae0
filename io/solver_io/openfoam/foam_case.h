// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace subvol::detail {

/// Where the meshes and fields of an OpenFOAM case are.
struct FoamCase {
    struct Part {
        std::filesystem::path folder;
        /// Block in the files of the folder, where they have those of several processors
        std::optional<std::size_t> block = {};
    };
    std::filesystem::path root;
    std::vector<Part> parts;           ///< the folder of the case, or those of its processors
    std::vector<double> times;         ///< numbers of the times in increasing order
    std::vector<std::string> folders;  ///< names of the times
    bool decomposed = false;

    /// A file of the mesh of a part at a step: that of the last time, up to the step's, that has one; else in `constant`.
    [[nodiscard]] std::filesystem::path mesh_file(std::size_t part, std::size_t step, const std::string& name) const;
};

/// Finds the meshes of a case. It is decomposed if its processors have later times, or it has no mesh itself.
///
/// path:   the folder, or a file in it
/// throws: Error(InvalidInput) if there is no mesh, or one of the processors is missing or there twice
[[nodiscard]] FoamCase find_foam_case(const std::filesystem::path& path);

/// Whether there is such a file, or one with .gz.
[[nodiscard]] bool is_there(const std::filesystem::path& file);

}  // namespace subvol::detail
