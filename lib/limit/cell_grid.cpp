// SPDX-License-Identifier: Apache-2.0
#include "cell_grid.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

void CellGrid::resize(const HexMesh& mesh, std::size_t nodes) {
    points.resize(nodes);
    values.resize(mesh.attributes.size());
    for (std::size_t a = 0; a < values.size(); ++a) {
        values[a].resize(nodes * static_cast<std::size_t>(mesh.attributes[a].channels));
    }
}

void CellGrid::take(const HexMesh& mesh, std::size_t node, Index point) {
    points[node] = mesh.points[point];
    for (std::size_t a = 0; a < values.size(); ++a) {
        const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
        std::copy_n(mesh.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels,
                    values[a].begin() + static_cast<std::ptrdiff_t>(node * channels));
    }
}

void CellGrid::take_child(const CellGrid& part, std::size_t child, std::size_t half) {
    const std::size_t side = 2 * half + 1;
    const auto& at = kCornerParameters[child];
    std::array<std::size_t, 3> ends, start;
    for (std::size_t d = 0; d < 3; ++d) {
        ends[d] = half + (at[d] == 1 ? 1 : 0);
        start[d] = at[d] == 1 ? half : 0;
    }
    for (std::size_t w = 0; w < ends[2]; ++w) {
        for (std::size_t v = 0; v < ends[1]; ++v) {
            const std::size_t from = (half + 1) * (v + (half + 1) * w);
            const std::size_t to = start[0] + side * (v + start[1] + side * (w + start[2]));
            std::copy_n(part.points.begin() + static_cast<std::ptrdiff_t>(from), ends[0],
                        points.begin() + static_cast<std::ptrdiff_t>(to));
            for (std::size_t a = 0; a < part.values.size(); ++a) {
                const std::size_t channels = part.values[a].size() / part.points.size();
                std::copy_n(part.values[a].begin() + static_cast<std::ptrdiff_t>(from * channels), ends[0] * channels,
                            values[a].begin() + static_cast<std::ptrdiff_t>(to * channels));
            }
        }
    }
}

DenseCell CellGrid::dense_cell(Index cell, int levels) const {
    DenseCell dense{.cell = cell, .side = (std::size_t{1} << levels) + 1, .points = points, .values = {}};
    dense.values.assign(values.begin(), values.end());
    return dense;
}

}  // namespace subvol::detail
