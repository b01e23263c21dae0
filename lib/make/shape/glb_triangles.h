// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Reads the triangles of a binary glTF 2.0 file: those of the nodes of its scene (without a scene, of all nodes), moved by
/// their transforms. Strips and fans become triangles; points and lines are left out, and so are materials, skins' motions,
/// animations and morphs.
///
/// name:    of the file, for errors
/// returns: the corners, three for each triangle, counter-clockwise where the file has them so
/// throws:  Error(InvalidInput) if the file is malformed, has data in other files, or compressed or sparse ones: names the part
[[nodiscard]] std::vector<Vec3> read_glb_triangles(std::string_view bytes, const std::string& name);

}  // namespace subvol::detail
