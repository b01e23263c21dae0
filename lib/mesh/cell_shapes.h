// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "subvol/cell.h"

namespace subvol::detail {

/// A kind of cell with three edges at each corner, as tables of corner numbers.
///
/// faces:        corners in cyclic order; a triangle repeats its last one
/// corner_edges: the other ends of the three edges at each corner, right-handed in a right-handed cell
template <std::size_t Corners, std::size_t Edges, std::size_t Faces>
struct Shape {
    static constexpr std::size_t kCorners = Corners;
    std::array<std::array<std::size_t, 2>, Edges> edges;
    std::array<std::array<std::size_t, 4>, Faces> faces;
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

template <std::size_t Rows, std::size_t Columns>
constexpr std::array<std::array<std::size_t, Columns>, Rows> as_sizes(const std::array<std::array<int, Columns>, Rows>& table) {
    std::array<std::array<std::size_t, Columns>, Rows> sizes{};
    for (std::size_t r = 0; r < Rows; ++r) {
        for (std::size_t c = 0; c < Columns; ++c) sizes[r][c] = static_cast<std::size_t>(table[r][c]);
    }
    return sizes;
}

inline constexpr Shape<8, 12, 6> kHexShape{as_sizes(kCellEdges), as_sizes(kCellFaces), kCornerNeighbors};

inline constexpr Shape<4, 6, 4> kTetShape{{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}},
                                          {{{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 3, 2, 2}}},
                                          {{{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}}}};

/// Right-handed if the corners of the first triangle are counter-clockwise seen from the second.
inline constexpr Shape<6, 9, 5> kPrismShape{{{{0, 1}, {1, 2}, {0, 2}, {3, 4}, {4, 5}, {3, 5}, {0, 3}, {1, 4}, {2, 5}}},
                                            {{{0, 2, 1, 1}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
                                            {{{1, 2, 3}, {2, 0, 4}, {0, 1, 5}, {5, 4, 0}, {3, 5, 1}, {4, 3, 2}}}};

}  // namespace subvol::detail
