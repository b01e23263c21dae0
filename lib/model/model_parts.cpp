// SPDX-License-Identifier: Apache-2.0
#include "model_parts.h"

#include <cmath>

namespace subvol::model {

bool in_block(const Vec3& p) {
    return std::abs(p.x) <= 1 && std::abs(p.y) <= 1 && std::abs(p.z) <= 1;
}

HexMesh parameter_block(const std::array<Index, 3>& cells) {
    const auto [nx, ny, nz] = cells;
    const auto coordinate = [](Index i, Index n) { return -1 + 2.0 * static_cast<double>(i) / static_cast<double>(n); };
    HexMesh mesh;
    mesh.points.reserve(std::size_t{nx + 1} * (ny + 1) * (nz + 1));
    for (Index k = 0; k <= nz; ++k) {
        for (Index j = 0; j <= ny; ++j) {
            for (Index i = 0; i <= nx; ++i) {
                mesh.points.emplace_back(coordinate(i, nx), coordinate(j, ny), coordinate(k, nz));
            }
        }
    }
    const Index row = nx + 1, layer = row * (ny + 1);
    mesh.cells.reserve(std::size_t{nx} * ny * nz);
    for (Index k = 0; k < nz; ++k) {
        for (Index j = 0; j < ny; ++j) {
            for (Index i = 0; i < nx; ++i) {
                const Index p = i + row * j + layer * k, q = p + layer;
                mesh.cells.push_back({p, p + 1, p + 1 + row, p + row, q, q + 1, q + 1 + row, q + row});
            }
        }
    }
    return mesh;
}

}  // namespace subvol::model
