// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "subvol/dense_cells.h"
#include "subvol/hex_mesh.h"
#include "tet_walk.h"

namespace subvol::detail {

/// One of the 64 ways to split a hexahedron into 6 tetrahedra about a corner, given by the corner and by the diagonals of the
/// three faces that do not touch it. The same splits as those of `split_cell`, with tables of the neighbours.
struct CellSplit {
    static constexpr std::uint8_t kNoOwner = 255;
    std::array<std::array<std::uint8_t, 4>, 6> corners{};  ///< the corners of each tetrahedron, as corners of the cell
    /// What lies across the face opposite to a corner: a tetrahedron of the cell, or 8 + a face of the cell.
    std::array<std::array<std::uint8_t, 4>, 6> neighbors{};
    /// For a neighbour that is a face of the cell: the face's corner that the triangle leaves out.
    std::array<std::array<std::uint8_t, 4>, 6> missing{};
    /// For a face and the corner that a triangle on it leaves out: 4 · tetrahedron + opposite corner of that triangle; kNoOwner
    /// where the split has no such triangle.
    std::array<std::array<std::uint8_t, 8>, 6> owners{};
};

[[nodiscard]] const std::array<CellSplit, 64>& cell_splits();

/// The number of the split that `split_cell` chooses for these point ids.
[[nodiscard]] std::uint8_t cell_split_of(const std::array<Index, 8>& cell);

/// The axis that a face of a cell is perpendicular to, and the end of the axis at which it lies. kCellFaces lists the faces in
/// pairs, one pair for each axis.
struct CellSide {
    int axis = 0, end = 0;
};
[[nodiscard]] constexpr CellSide cell_side(std::size_t face) {
    return {static_cast<int>(face / 2), static_cast<int>(face % 2)};
}
[[nodiscard]] constexpr std::size_t opposite_face(std::size_t face) {
    return face ^ 1;
}

/// Lattice coordinates of a cell's corners.
inline constexpr std::array<std::array<int, 3>, 8> kCellCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// The corner at the other end of an axis.
[[nodiscard]] constexpr std::size_t corner_across(std::size_t corner, int axis) {
    constexpr std::array<std::array<std::uint8_t, 8>, 3> kAcross{
        {{1, 0, 3, 2, 5, 4, 7, 6}, {3, 2, 1, 0, 7, 6, 5, 4}, {4, 5, 6, 7, 0, 1, 2, 3}}};
    return kAcross[static_cast<std::size_t>(axis)][corner];
}

/// The level-L grid of one control cell as a mesh of tetrahedra whose neighbours follow from the grid. The number of a
/// tetrahedron is 8 · micro-cell + 0..5. A point's id is its rank among the grid's points by position. So two grids that share
/// a side split it alike, and decide alike where a ray runs along an edge, although neither has the other's data.
class DenseGrid {
public:
    /// attribute: the field is channel 0 of cell.values[attribute]
    /// cost:      O(n log n) for n = side³ points; keeps 40 bytes for each point and at most 200 for each boundary quad
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
    [[nodiscard]] Index quads_along() const { return Index{1} << levels_; }

    // What `walk` needs of a mesh.
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

    /// A square part of a side: one of 2^level × 2^level, along the two axes after that of the side.
    struct SidePart {
        std::size_t side = 0;
        int level = 0;
        Index i = 0, j = 0;
    };
    /// A box around a part of a side, up to rounding to floats.
    [[nodiscard]] Box box_of(const SidePart& part) const;
    /// Appends the boundary faces of a part of a side that the whole line of a ray crosses, as edge signs decide: an even
    /// number of all six sides.
    void find_crossed(const RayPlane& plane, const SidePart& part, std::vector<TetFace>& faces) const;

    /// A triangle on a side of the grid: the quad's place along the two axes after that of the side, and the quad's corner that
    /// the triangle leaves out, along the same axes.
    struct SideTriangle {
        std::size_t side = 0;
        std::array<Index, 2> quad{}, missing{};
    };
    [[nodiscard]] SideTriangle on_side(TetFace face) const;
    /// The other way; nothing if the quad there is split along its other diagonal.
    [[nodiscard]] std::optional<TetFace> face_of(const SideTriangle& triangle) const;

private:
    /// A box in single precision, relative to the grid's first point.
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
    [[nodiscard]] const SmallBox& small_box(const SidePart& part) const;
    void descend(const RayPlane& plane, double margin, const SidePart& part, std::vector<TetFace>& faces) const;

    const CellSplit* cell_splits_;
    Index cell_;
    std::size_t side_;
    int levels_;
    std::array<std::size_t, 8> step_;   // from a micro-cell's lowest node to its corners
    std::vector<Point> points_;         // by rank
    std::vector<Index> ranks_;          // of the nodes
    std::vector<std::uint8_t> splits_;  // of the micro-cells, u fastest
    std::vector<SmallBox> sides_;       // a quadtree for each face: levels from one box down to a box for each quad
    Vec3 origin_;
    Box box_;
    Range range_;
};

}  // namespace subvol::detail
