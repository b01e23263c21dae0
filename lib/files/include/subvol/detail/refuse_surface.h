// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/error.h"

namespace subvol::detail {

/// Refuses a surface of triangles where a mesh or points are needed.
///
/// throws: Error(InvalidInput), with the command that makes a control mesh of the file
[[noreturn]] inline void refuse_surface(const std::filesystem::path& path) {
    throw Error(
        ErrorCode::InvalidInput, "is a surface, not a mesh of cells", path.string(),
        "`subvol mesh " + path.filename().string() + " -o " + path.stem().string() + ".vtu` makes a control mesh of it");
}

}  // namespace subvol::detail
