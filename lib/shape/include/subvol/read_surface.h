// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/surface.h"

namespace subvol {

/// Whether a file of this name may have a surface: .stl, .obj or .ply.
[[nodiscard]] bool is_surface_file(const std::filesystem::path& path);

/// Reads the triangles of an .stl (binary or text), .obj or .ply file. Polygons become fans of triangles. Points at the same
/// place are one in .stl, where each triangle has its own.
///
/// throws: Error(Io); Error(InvalidInput) if the file is malformed or has no triangle: names the line, or the byte
[[nodiscard]] Surface read_surface(const std::filesystem::path& path);

}  // namespace subvol
