// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "cell_split.h"
#include "subvol/dense_cells.h"
#include "tet_walk.h"

namespace subvol::detail {

/// The level-L grid of one control cell as a mesh of tetrahedra whose neighbours follow from the grid: 8 · micro-cell + one of
/// 6 names a tetrahedron. A point's id is its rank among the grid's points by position. So grids that share a side split it
/// alike, and decide alike where a ray runs along an edge, although they do not know of each other.
class DenseGrid {
public:
    /// channel 0 of values[attribute] is the scalar
    /// cost: O(n log n) for n = side³ points; 40 bytes a point stay, and 200 a boundary quad at most
    DenseGrid(const DenseCell& cell, std::size_t attribute);

    struct Point {
        Vec3 position;
        double value;
    };
    struct Range {
        double min, max;
    };

    [[nodiscard]] Index cell() const { return cell_; }
    [[nodiscard]] const Box& box() const { return box_; }
    [[nodiscard]] Range range() const { return range_; }
    [[nodiscard]] std::size_t micro_cells() const { return splits_.size(); }
    [[nodiscard]] std::size_t bytes() const;

    // What a walk asks of any mesh.
    [[nodiscard]] std::size_t tet_count() const { return 6 * splits_.size(); }
    [[nodiscard]] const Point& point(Index id) const { return points_[id]; }
    [[nodiscard]] std::array<Index, 4> corners_of_tet(Index tet) const {
        const auto& local = cell_splits_[splits_[tet / 8]].corners[tet % 8];
        const Index* const lowest = ranks_.data() + lowest_node(tet / 8);
        return {lowest[step_[local[0]]], lowest[step_[local[1]]], lowest[step_[local[2]]], lowest[step_[local[3]]]};
    }
    [[nodiscard]] std::array<Index, 3> corners(TetFace face) const {
        const auto corner = corners_of_tet(face / 4);
        const std::size_t k = face % 4;
        return {corner[k == 0 ? 1 : 0], corner[k <= 1 ? 2 : 1], corner[k <= 2 ? 3 : 2]};
    }
    [[nodiscard]] Index neighbor(Index tet, Index k) const;

    /// Appends the boundary faces that the whole line of a ray crosses: an even number, with what edge signs decide.
    void find_crossed(const RayPlane& plane, std::vector<TetFace>& faces) const;

private:
    /// A box in single precision about the grid's first point.
    struct SmallBox {
        std::array<float, 3> center, half;
    };
    void rank_points(const DenseCell& cell, std::size_t attribute);
    void split_cells();
    void build_sides();
    [[nodiscard]] std::array<Index, 3> cell_at(std::size_t face, Index i, Index j) const;
    [[nodiscard]] std::size_t cell_number(const std::array<Index, 3>& at) const {
        return at[0] + (std::size_t{at[1]} << levels_) + (std::size_t{at[2]} << (2 * levels_));
    }
    [[nodiscard]] std::size_t lowest_node(std::size_t cell) const {
        const std::size_t mask = (std::size_t{1} << levels_) - 1;
        return (cell & mask) + side_ * ((cell >> levels_ & mask) + side_ * (cell >> (2 * levels_)));
    }
    [[nodiscard]] SmallBox small_box(const Box& box) const;
    void descend(const RayPlane& plane, double margin, std::size_t face, int level, Index i, Index j,
                 std::vector<TetFace>& faces) const;

    const CellSplit* cell_splits_;
    Index cell_;
    std::size_t side_;
    int levels_;
    std::array<std::size_t, 8> step_;   // from a micro-cell's lowest node to its corners
    std::vector<Point> points_;         // by rank
    std::vector<Index> ranks_;          // of the nodes
    std::vector<std::uint8_t> splits_;  // of the micro-cells, u fastest
    std::vector<SmallBox> sides_;       // a quadtree a face: levels from one box to one a quad
    Vec3 origin_;
    Box box_;
    Range range_;
};

}  // namespace subvol::detail
