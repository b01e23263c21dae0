// SPDX-License-Identifier: Apache-2.0
// Meshes that are cut into bricks, and how.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "lib/test_meshes.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol::test {

inline constexpr std::array<std::size_t, 5> kCounts{1, 2, 3, 4, 7};
inline constexpr std::array kShapes{BrickShape::Blocks, BrickShape::Slabs, BrickShape::Random};

inline HexMesh irregular_ball() {
    HexMesh mesh = make_model("ball", 8);
    jitter(mesh, 0.1 / 8, 3);
    return mesh;
}

/// Creases on the boundary and a sharp face inside, in bricks of every kind.
inline HexMesh tagged() {
    HexMesh mesh = make_box(9, 5, 4);
    jitter(mesh, 0.1, 5);
    add_field(mesh, "heat", [](const Vec3& x) { return std::sin(x.x) + x.y * x.z; });
    for (Index x = 0; x < 9; ++x) mesh.creases.push_back({x + 2 * 10, x + 1 + 2 * 10});  // along the bottom's middle
    for (Index y = 0; y < 5; ++y) {
        for (Index z = 0; z < 4; ++z) {
            const Index p = 4 + 10 * y + 60 * z;
            mesh.sharp_faces.push_back({p, p + 10, p + 70, p + 60});
        }
    }
    return mesh;
}

}  // namespace subvol::test
