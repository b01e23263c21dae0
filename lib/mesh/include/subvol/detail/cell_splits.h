// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/flat_array.h"
#include "subvol/index.h"
#include "subvol/mixed_cells.h"

namespace subvol::detail {

/// A kind of cell with three edges at each corner, as tables of corner numbers.
template <std::size_t Corners, std::size_t Edges, std::size_t Faces>
struct Shape {
    static constexpr std::size_t kCorners = Corners;
    std::array<std::array<std::size_t, 2>, Edges> edges;
    std::array<std::array<std::size_t, 4>, Faces> faces;  ///< corners in cyclic order; a triangle repeats its last one
    /// The other ends of the three edges at each corner, right-handed in a right-handed cell
    std::array<std::array<std::size_t, 3>, Corners> corner_edges;

    [[nodiscard]] constexpr std::size_t edge_between(std::size_t a, std::size_t b) const {
        std::size_t e = 0;
        while (!(edges[e][0] == a && edges[e][1] == b) && !(edges[e][0] == b && edges[e][1] == a)) ++e;
        return e;
    }
    [[nodiscard]] constexpr std::size_t face_through(std::size_t a, std::size_t b, std::size_t c) const {
        const auto has = [&](std::size_t f, std::size_t corner) {
            return std::find(faces[f].begin(), faces[f].end(), corner) != faces[f].end();
        };
        std::size_t f = 0;
        while (!has(f, a) || !has(f, b) || !has(f, c)) ++f;
        return f;
    }
};

inline constexpr Shape<8, 12, 6> kHexShape{kCellEdges, kCellFaces, kCornerNeighbors};

inline constexpr Shape<4, 6, 4> kTetShape{{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}},
                                          {{{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 3, 2, 2}}},
                                          {{{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}}}};

/// Right-handed if the corners of the first triangle are counter-clockwise seen from the second.
inline constexpr Shape<6, 9, 5> kPrismShape{{{{0, 1}, {1, 2}, {0, 2}, {3, 4}, {4, 5}, {3, 5}, {0, 3}, {1, 4}, {2, 5}}},
                                            {{{0, 2, 1, 1}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
                                            {{{1, 2, 3}, {2, 0, 4}, {0, 1, 5}, {5, 4, 0}, {3, 5, 1}, {4, 3, 2}}}};

/// The split of a mixed mesh into hexahedra, without any values.
struct HexSplit {
    IndexRows sources;  ///< the points of the mixed mesh whose mean each new point is
    std::vector<std::array<Index, 8>> cells;
    std::vector<Index> parents;  ///< the number of each cell's parent, counted through the hexes, tets, prisms and pyramids
    std::size_t tets_cut = 0;    ///< the number of tetrahedra into which all cells were cut first; 0 if that was not necessary
};

/// The main part of `split_into_hexes`; throws the same.
///
/// cut: cuts all cells into tetrahedra first, even without pyramids
[[nodiscard]] HexSplit plan_split(std::span<const Vec3> points, std::vector<std::array<Index, 8>> hexes, MixedCells others,
                                  bool cut = false);

/// The values of the new points: means over their sources.
[[nodiscard]] std::vector<Vec3> means(const IndexRows& sources, std::span<const Vec3> points);
[[nodiscard]] std::vector<double> means(const IndexRows& sources, std::span<const double> values, std::size_t channels);

/// The sorted corners of an edge, a face or a cell, which identify it; the rest of the array is kNone.
template <std::size_t N>
using SplitKey = std::array<Index, N>;

/// Calls edge(key), face(key) and center(key) for the edges, the faces and the middle of a cell.
template <class Shape, class Cell, class Edge, class Face, class Center>
void each_key(const Shape& shape, const Cell& cell, const Edge& edge, const Face& face, const Center& center) {
    for (const auto& [a, b] : shape.edges) edge(SplitKey<2>{std::min(cell[a], cell[b]), std::max(cell[a], cell[b])});
    for (const auto& corners : shape.faces) {
        SplitKey<4> key{cell[corners[0]], cell[corners[1]], cell[corners[2]],
                        corners[2] == corners[3] ? kNone : cell[corners[3]]};
        std::sort(key.begin(), key.end());
        face(key);
    }
    SplitKey<8> key;
    key.fill(kNone);
    std::copy(cell.begin(), cell.end(), key.begin());
    std::sort(key.begin(), key.end());
    center(key);
}

/// The new points of a cell that is split.
template <std::size_t Corners>
struct SplitPoints {
    std::array<Index, Corners> corners;
    std::span<const Index> edges, faces;  ///< in the order of the cell's shape, and of `each_key`
    Index center;
};

/// Appends the hexahedra into which a cell is split, one for each of its corners.
template <class Shape>
void add_children(const Shape& shape, const SplitPoints<Shape::kCorners>& points, std::vector<std::array<Index, 8>>& cells) {
    for (std::size_t v = 0; v < Shape::kCorners; ++v) {
        const auto [a, b, c] = shape.corner_edges[v];
        const auto edge = [&](std::size_t end) { return points.edges[shape.edge_between(v, end)]; };
        const auto face = [&](std::size_t end, std::size_t other) { return points.faces[shape.face_through(v, end, other)]; };
        cells.push_back({points.corners[v], edge(a), face(a, b), edge(b), edge(c), face(a, c), points.center, face(b, c)});
    }
}

/// Refuses two cells with the same corners. key: these
[[noreturn]] void refuse_twin(const SplitKey<8>& key);

/// What is said of a mesh with too many cells.
inline constexpr const char* kTooManyToSplit = "too many cells to be split into hexahedra";

/// Makes all cells right-handed: exchanges corners of those whose volume is negative.
void orient_mixed(std::span<const Vec3> points, std::vector<std::array<Index, 8>>& hexes, MixedCells& others);

struct CutCells {
    std::vector<std::array<Index, 4>> tets;
    std::vector<Index> parents;  ///< as in HexSplit
};

/// Cuts right-handed cells into right-handed tetrahedra. Quads are cut along the diagonal from their smallest id, so that
/// neighbours agree.
[[nodiscard]] CutCells cut_to_tets(const std::vector<std::array<Index, 8>>& hexes, const MixedCells& others);

}  // namespace subvol::detail
