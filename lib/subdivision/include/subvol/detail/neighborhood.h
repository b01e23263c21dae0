// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "subvol/detail/cell_links.h"
#include "subvol/detail/patch.h"

namespace subvol::detail {

/// The surroundings of a cell that a scheme's rules can reach: the cell, the cells that share a point with it, and if it is
/// refined more than once those that share a point with these. Cells and points are numbered in the order of a walk from cell
/// to cell that starts at the cell, along axes that depend on the surroundings, so that cells whose surroundings meet in the
/// same way have the same `code`.
struct Neighborhood {
    std::uint8_t turn = kIdentityTurn;  ///< from the axes of the walk to those of the cell
    /// Points of the mesh, the cell's own eight first, at the places of the walk's octants u + 2v + 4w
    std::vector<Index> points;
    /// The number of cells of the first layer, then the points of each cell by octants (places in `points`), then the tags: all
    /// that the weights of a refinement depend on
    std::vector<std::uint16_t> code;
};

/// Walks through the surroundings of one cell after the other. Each thread has its own.
class NeighborhoodWalk {
public:
    /// Mesh and links are kept by reference.
    NeighborhoodWalk(const HexMesh& mesh, const CellLinks& links);

    /// Fills `found`. False if the surroundings are too large, or if some of their cells meet others at an edge or a point
    /// only, so that the walk does not come to all of them.
    ///
    /// layers: 1 or 2
    [[nodiscard]] bool find(Index cell, int layers, Neighborhood& found);

    /// The points of a regular neighbourhood, u fastest, the cell's own in the middle; false if it is not regular, whatever the
    /// number of points.
    ///
    /// points: 6×6×6, or 4×4×4 without the second layer
    [[nodiscard]] bool find_regular(Index cell, std::span<Index> points) const;

    struct Visited {
        Index cell;
        std::uint8_t turn;  // from the axes of the walk to those of the cell
    };
    /// The cells of the neighbourhood that was found last, in the order of the walk.
    [[nodiscard]] std::span<const Visited> visited() const { return visited_; }

private:
    [[nodiscard]] std::optional<bool> find_aligned(Index cell, std::span<Index> points) const;
    [[nodiscard]] bool eight_cells_meet(std::span<const Index> points) const;
    void start(Neighborhood& found);
    [[nodiscard]] std::uint16_t number(Index point, Neighborhood& found);
    void add_first(Index cell, Neighborhood& found);
    [[nodiscard]] std::uint8_t first_turn(Index cell) const;
    [[nodiscard]] bool add(std::size_t from, std::size_t side, Neighborhood& found);
    [[nodiscard]] bool walk_layer(std::size_t points, Neighborhood& found);
    [[nodiscard]] bool is_complete(std::size_t points, const Neighborhood& found) const;
    void add_tags(Neighborhood& found) const;

    const HexMesh& mesh_;
    const CellLinks& links_;
    std::vector<Visited> visited_;
    std::vector<std::uint32_t> cell_marks_, point_marks_;
    std::vector<std::uint16_t> numbers_;      // of marked points
    std::vector<std::uint16_t> cells_found_;  // around each point found
    std::uint32_t mark_ = 0;
};

/// The neighbourhood as a mesh of its own, whose first cell is the one in the middle; points have no places yet.
[[nodiscard]] Patch patch_of(const Neighborhood& neighborhood);

}  // namespace subvol::detail
