// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <span>
#include <vector>

#include "cell_classes.h"
#include "cell_grid.h"

namespace subvol::detail {

/// Values of kTableLanes cells of one class: channel by channel, point by point, cell by cell.
class LaneValues {
public:
    /// The points that the table uses.
    void load(const HexMesh& mesh, std::span<const Member> cells, const WeightTable& table);
    void apply(const WeightTable& table);

    /// The rows of one cell as its grid. turn: from the axes of the rows to those of the cell
    void store(std::size_t lane, std::size_t side, std::uint8_t turn, CellGrid& grid) const;

private:
    template <class T>
    using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;
    std::size_t channels_ = 0, stride_ = 0, rows_ = 0;
    Aligned<double> in_, out_;
};

}  // namespace subvol::detail
