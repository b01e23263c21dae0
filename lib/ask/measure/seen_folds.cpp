// SPDX-License-Identifier: Apache-2.0
#include "seen_folds.h"

#include <algorithm>

#include "subvol/cell.h"
#include "subvol/detail/fold_samples.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"

namespace subvol::detail {

SeenFolds seen_folds(const HexMesh& mesh, std::vector<Index> cells, const SchemeOptions& scheme, Progress* progress) {
    constexpr std::size_t kMost = 1000;
    // The limit of the linear scheme is the cells: what is inverted there is said of the mesh.
    if (scheme.kind == Scheme::Linear) return {};
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    std::erase_if(cells, [&](Index cell) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[cell][k]] - mesh.points[mesh.cells[cell][0]];
        return !(cell_volume(corners) > 0);
    });
    if (cells.size() > kMost) cells.resize(kMost);
    if (cells.empty()) return {};
    std::vector<std::uint8_t> kept(mesh.cells.size(), 0);
    for (const Index cell : cells) kept[cell] = 1;
    grow(mesh, kept, kHaloOfLimit);
    MeshSubset near = subset(mesh, kept);
    near.mesh.attributes.clear();
    std::vector<Index> numbers;
    for (const Index cell : cells)
        numbers.push_back(static_cast<Index>(std::ranges::lower_bound(near.cells, cell) - near.cells.begin()));
    SeenFolds folds;
    for (const CellSamples& cell : sample_folds(near.mesh, numbers, scheme, progress)) {
        if (!(cell.least.determinant < 0)) continue;
        if (folds.cells == 0) {
            folds.first = near.cells[cell.least.cell];
            folds.place = cell.least.position;
        }
        ++folds.cells;
    }
    return folds;
}

}  // namespace subvol::detail
