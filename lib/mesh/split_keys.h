// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

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

/// The new points of a cell that is split. edges, faces: in the order of its shape, and of `each_key`
template <std::size_t Corners>
struct SplitPoints {
    std::array<Index, Corners> corners;
    std::span<const Index> edges, faces;
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

}  // namespace subvol::detail
