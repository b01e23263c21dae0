// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "edge_classes.h"
#include "subvol/index.h"

namespace subvol::detail {

/// The numbers of the points of cells that are split into grids, so that neighbours share the points where they meet: first
/// the corners, then the points on edges, then those on the faces and inside of one cell after the other.
class SplitGrids {
public:
    /// cells:       with 8 different corners each
    /// pieces:      of each class of edges
    /// point_count: of the cells that are split
    SplitGrids(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges, std::span<const std::size_t> pieces,
               std::size_t point_count);

    /// kNone or more: then there are too many, and no grids.
    [[nodiscard]] std::size_t point_count() const { return point_count_; }

    /// The pieces of a cell along its three directions.
    [[nodiscard]] std::array<std::size_t, 3> pieces_of(std::size_t cell) const;

    /// The points of a cell, the first direction fastest.
    [[nodiscard]] std::vector<Index> grid_of(std::size_t cell) const;

private:
    std::span<const std::array<Index, 8>> cells_;
    const EdgeClasses& edges_;
    std::span<const std::size_t> pieces_;
    std::vector<Index> corners_;
    std::vector<std::size_t> edge_starts_, cell_starts_;
    std::map<std::array<Index, 4>, std::size_t> face_starts_;
    std::size_t point_count_ = 0;
};

}  // namespace subvol::detail
