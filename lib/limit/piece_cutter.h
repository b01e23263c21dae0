// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "node_steps.h"
#include "subvol/detail/flat_array.h"
#include "subvol/limit_level.h"

namespace subvol::detail {

/// Pieces, as in LimitPieces, with what is left between each and the limit.
struct PieceList {
    std::vector<Index> cells;
    std::vector<std::uint8_t> levels;
    std::vector<std::array<std::uint8_t, 3>> lowest;
    std::vector<Step> left;
    std::vector<float> trilinear;  // the level whose trilinear cells are as near
    std::vector<Vec3> origins;
    FlatArray<float> nodes;
    bool has_nodes = true;  // otherwise origins and nodes are empty

    [[nodiscard]] std::size_t size() const { return cells.size(); }
    void drop_nodes();
    /// Takes back all pieces but the first ones.
    void truncate(std::size_t pieces);
};

/// Cuts a part of a control cell into pieces that are fine enough, from a grid of its nodes.
///
///     N  the 27 nodes of a part: its corners, and the middles between them
///     ●     ○     ●     ○     ●     new nodes ○ of its children are compared with the parabola through ●: if all are near
///     |     part        |           it, the part is a piece. Otherwise each child is a piece if a quarter of its own distance
///     |  child  | child |           is small enough; if it is not, its children are looked at in the same way
class PieceCutter {
public:
    /// scales: as `value_scales`
    PieceCutter(std::vector<double> scales, const LimitCellsOptions& options);

    /// Whether a whole cell is fine enough, from its nodes of level 1, or there will be no other; if so, it is added to the
    /// list.
    bool cut_cell(const DenseCell& grid, bool last, PieceList& list);

    /// Cuts the part of level `level` at `lowest` that `grid` covers, into the list. Returns the children, bit k: child k, that
    /// need more nodes than the grid has, all eight for the part as a whole.
    ///
    /// last: there will be no finer grid: a part that needs more nodes is added with what it has
    std::uint8_t cut(const DenseCell& grid, int level, const std::array<std::uint8_t, 3>& lowest, bool last, PieceList& list);

private:
    struct Part {
        int level;
        std::array<std::uint8_t, 3> lowest;
        std::array<std::size_t, 3> first;  // node of the grid
        std::size_t width;                 // steps of the grid
    };
    [[nodiscard]] bool is_near(const Step& left) const;
    void gather(const DenseCell& grid, const Part& part, std::size_t side);
    void add(const DenseCell& grid, const Part& part, const Step& left, PieceList& list);
    /// The same with the part's 27 nodes gathered. step: of their positions, from trilinear predictions
    void add_gathered(const DenseCell& grid, const Part& part, const Step& left, double step, PieceList& list);
    std::uint8_t cut_part(const DenseCell& grid, const Part& part, Step left, bool last, PieceList& list);

    std::vector<double> scales_;
    double position_, value_;
    NodeBlock nodes_;  // scratch memory
};

}  // namespace subvol::detail
