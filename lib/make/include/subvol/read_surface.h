// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/surface.h"

namespace subvol {

/// Whether a file of this name may have a surface: .stl, .obj, .ply or .glb.
[[nodiscard]] bool is_surface_file(const std::filesystem::path& path);

/// Reads the triangles of an .stl (binary or text), .obj, .ply or .glb (binary glTF 2.0) file. Polygons become fans of
/// triangles. Points at the same place are one in .stl, where each triangle has its own, and in .glb, where each side of a
/// sharp edge has its own. Those of .glb are in the coordinates of its scene, where y points up.
///
/// throws: Error(Io); Error(InvalidInput) if the file is malformed or has no triangle: names the line, or the byte
[[nodiscard]] Surface read_surface(const std::filesystem::path& path);

}  // namespace subvol
