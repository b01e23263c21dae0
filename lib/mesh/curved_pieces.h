// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "edge_classes.h"

namespace subvol::detail {

/// How far a straight line is from the curve at most, if a direction of a cell is not split: in parts of the mesh's size, and
/// of the fields' ranges. The distance falls with the square of the number of pieces.
struct CellBend {
    std::array<float, 3> shape{}, fields{};
};

/// Into how many pieces the directions of curved cells are split.
///
/// class_of:   for each cell the classes of its three directions
/// of_class:   the pieces of each class of edges
/// limited:    whether there would have been more than most_hexes for the tolerance
struct CurvedPieces {
    std::vector<std::array<std::size_t, 3>> class_of;
    std::vector<std::size_t> of_class;
    std::size_t most_hexes = 0;
    bool limited = false;

    [[nodiscard]] std::array<std::size_t, 3> of_cell(std::size_t c) const {
        return {of_class[class_of[c][0]], of_class[class_of[c][1]], of_class[class_of[c][2]]};
    }
};

/// Splits all edges of a class alike, as the cell that needs it most. Where there would be too many pieces, the fields give way
/// first.
///
/// bends:     of the cells
/// tolerance: in parts of the mesh's size; greater than 0
[[nodiscard]] CurvedPieces choose_pieces(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges,
                                         std::span<const CellBend> bends, double tolerance);

}  // namespace subvol::detail
