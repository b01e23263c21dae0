// SPDX-License-Identifier: Apache-2.0
#include "hanging_nodes.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

/// Nodes first + i·along + j·across of a grid, i and j from 0 to last.
struct Rows {
    std::size_t first, along, across, last;
};

/// Puts the odd nodes of each row on to the parabola through three even ones.
///
/// step:   between nodes
/// across: between rows
void predict_along(std::vector<Vec3>& points, const Rows& rows, std::size_t step, std::size_t across) {
    for (std::size_t j = 0; j <= rows.last; j += across) {
        for (std::size_t i = 0; i < rows.last; i += 4 * step) {
            const auto at = [&](std::size_t k) -> Vec3& {
                return points[rows.first + (i + k * step) * rows.along + j * rows.across];
            };
            at(1) = 0.375 * at(0) + 0.75 * at(2) - 0.125 * at(4);
            at(3) = 0.375 * at(4) + 0.75 * at(2) - 0.125 * at(0);
        }
    }
}

/// The pieces of a level have nodes 2^(finest − level) steps apart, and their prediction those of every finer level.
template <class Predict>
void each_finer_level(int level, int finest, const Predict& predict) {
    for (int l = level + 1; l <= finest; ++l) predict(std::size_t{1} << (finest - l));
}

std::size_t node_of(std::size_t corner, std::size_t last, std::size_t side) {
    const auto& at = kCornerParameters[corner];
    return last * (static_cast<std::size_t>(at[0]) +
                   side * (static_cast<std::size_t>(at[1]) + side * static_cast<std::size_t>(at[2])));
}

}  // namespace

void close_gaps(const DenseCell& grid, int level, const LevelsBeside& beside, std::vector<Vec3>& points) {
    points.assign(grid.points.begin(), grid.points.end());
    const std::size_t side = grid.side, last = side - 1;
    for (std::size_t e = 0; e < 12; ++e) {
        const std::size_t from = node_of(static_cast<std::size_t>(kCellEdges[e][0]), last, side),
                          to = node_of(static_cast<std::size_t>(kCellEdges[e][1]), last, side);
        const std::size_t first = std::min(from, to), stride = (std::max(from, to) - first) / last;
        each_finer_level(beside.edges[e], level, [&](std::size_t step) {
            predict_along(points, {first, stride, 0, last}, step, last + 1);
        });
    }
    const std::array<std::size_t, 3> strides{1, side, side * side};
    for (std::size_t s = 0; s < 6; ++s) {
        const std::size_t axis = s / 2, first = s % 2 != 0 ? last * strides[axis] : 0;
        const std::size_t u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
        // Edges have their nodes already, and keep them: rows between the edges, then what lies between these rows.
        each_finer_level(beside.sides[s], level, [&](std::size_t step) {
            for (std::size_t j = 2 * step; j < last; j += 2 * step) {
                predict_along(points, {first + j * v, u, 0, last}, step, last + 1);
            }
            for (std::size_t i = step; i < last; i += step) {
                predict_along(points, {first + i * u, v, 0, last}, step, last + 1);
            }
        });
    }
}

}  // namespace subvol::detail
