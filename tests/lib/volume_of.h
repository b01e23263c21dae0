// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/hex_mesh.h"

namespace subvol::test {

/// The sum of the volumes of the cells, as trilinear ones.
inline double volume_of(const HexMesh& mesh) {
    double sum = 0;
    for (const auto& cell : mesh.cells) {
        std::array<Vec3, 8> corners;
        for (std::size_t c = 0; c < 8; ++c) corners[c] = mesh.points[cell[c]];
        sum += cell_volume(corners);
    }
    return sum;
}

}  // namespace subvol::test
