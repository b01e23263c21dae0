// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Where the meshes and fields of an OpenFOAM case are.
///
/// parts:   the folder of the case, or those of its processors
/// numbers: of the times in increasing order; folders: their names
struct FoamCase {
    std::filesystem::path root;
    std::vector<std::filesystem::path> parts;
    std::vector<double> times;
    std::vector<std::string> folders;
    bool decomposed = false;

    /// A file of the mesh of a part at a step: that of the last time, up to the step's, that has one; else in `constant`.
    [[nodiscard]] std::filesystem::path mesh_file(std::size_t part, std::size_t step, const std::string& name) const;
};

/// path: the folder, or a file in it. The case is decomposed if its processors have later times, or it has no mesh itself.
///
/// throws: Error(InvalidInput) if there is no mesh
[[nodiscard]] FoamCase find_foam_case(const std::filesystem::path& path);

[[nodiscard]] std::vector<double> foam_times(const std::filesystem::path& path);

/// Reads a step of a case.
[[nodiscard]] ReadResult read_foam(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
