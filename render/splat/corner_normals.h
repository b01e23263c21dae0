// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/surface.h"

namespace subvol::detail {

/// The outward unit normals at the three corners of a triangle.
using CornerNormals = std::array<std::array<float, 3>, 3>;

/// Normals that make a surface of triangles look smooth where it is, and leave its creases sharp: at a corner the mean of the
/// normals of those triangles around the point that are turned from this one by less than 40 degrees, weighted by their
/// angles.
///
/// returns: those of each triangle; a triangle without area has the normals of its neighbours or (0, 0, 0)
/// cost:    O(n · valence), in parallel
[[nodiscard]] std::vector<CornerNormals> corner_normals(const Surface& surface);

}  // namespace subvol::detail
