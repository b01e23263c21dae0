// SPDX-License-Identifier: Apache-2.0
#include "pieces_within.h"

#include <algorithm>

namespace subvol::detail {

LimitCells pieces_within(const HexMesh& mesh, const RefineOptions& refinement, LimitCellsOptions cells) {
    constexpr int kMostRounds = 8;  // at one level; a tolerance of 0 cannot be enlarged
    cells.max_levels = std::max(cells.max_levels, 1);
    for (int round = 1;; ++round) {
        LimitCells limit = find_limit_cells(mesh, refinement, cells);
        if (limit.pieces) return limit;
        if (cells.max_levels == 1) {  // no coarser pieces exist
            cells.max_bytes *= 2;
            continue;
        }
        // About as many times fewer pieces as the tolerance is larger.
        constexpr double kPieceBytes = LimitPieces::kNodes * 4 * sizeof(float);
        const double too_many = static_cast<double>(limit.piece_count) * kPieceBytes / static_cast<double>(cells.max_bytes);
        const double factor = std::max(2.0, too_many);
        cells.position_world *= factor;
        cells.value_of_range *= factor;
        if (cells.value_of_range > 1 || round % kMostRounds == 0) --cells.max_levels;
    }
}

}  // namespace subvol::detail
