// SPDX-License-Identifier: Apache-2.0
#include "grid_numbers.h"

#include <algorithm>

#include "corner_of.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

// The number in kCellEdges of the edge along `axis` at the other two axes' sides (in their order).
constexpr std::array<std::array<std::size_t, 4>, 3> kEdgeAt{{{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}}};

}  // namespace

GridNumbers::GridNumbers(const Topology& topology, int level)
    : topology_(topology),
      side_(std::uint64_t{1} << level),
      first_edge_(topology.point_count),
      first_face_(first_edge_ + topology.edges.size() * (side_ - 1)),
      first_cell_(first_face_ + topology.faces.size() * (side_ - 1) * (side_ - 1)) {
}

GridNumbers::Cell::Cell(const GridNumbers& numbers, Index cell) : numbers_(numbers), cell_(cell) {
    const Topology& topology = numbers.topology_;
    const auto& corners = topology.cells[cell];
    for (std::size_t e = 0; e < 12; ++e) {
        const auto [a, b] = kCellEdges[e];
        reversed_[e] = corners[static_cast<std::size_t>(a)] > corners[static_cast<std::size_t>(b)];
    }
    for (std::size_t f = 0; f < 6; ++f) {
        const auto& points = topology.faces[topology.cell_faces[cell][f]];
        const auto& origin = kCornerParameters[corner_of(corners, points[0])];
        for (std::size_t side_axis = 0; side_axis < 2; ++side_axis) {
            const auto& end = kCornerParameters[corner_of(corners, points[side_axis == 0 ? 1 : 3])];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (origin[axis] == end[axis]) continue;
                faces_[f].axis[side_axis] = axis;
                faces_[f].reversed[side_axis] = origin[axis] == 1;
            }
        }
    }
}

VertexNumber GridNumbers::Cell::operator()(std::size_t i, std::size_t j, std::size_t k) const {
    const Topology& topology = numbers_.topology_;
    const std::uint64_t n = numbers_.side_;
    const std::array<std::uint64_t, 3> at{i, j, k};
    std::array<std::size_t, 3> inner{};
    std::size_t inner_count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at[axis] != 0 && at[axis] != n) inner[inner_count++] = axis;
    }
    const auto is_high = [&](std::size_t axis) { return at[axis] != 0 ? std::size_t{1} : std::size_t{0}; };
    if (inner_count == 0) return topology.cells[cell_][kCornerOctants[is_high(0) + 2 * is_high(1) + 4 * is_high(2)]];
    if (inner_count == 1) {
        const std::size_t axis = inner[0];
        const std::size_t first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
        const std::size_t edge = kEdgeAt[axis][is_high(first) + 2 * is_high(second)];
        const std::uint64_t along = reversed_[edge] ? n - at[axis] : at[axis];
        return numbers_.first_edge_ + topology.cell_edges[cell_][edge] * (n - 1) + along - 1;
    }
    if (inner_count == 2) {
        const std::size_t across = 3 - inner[0] - inner[1];
        const std::size_t side = 2 * across + is_high(across);
        const FaceAxes& axes = faces_[side];
        const auto along = [&](std::size_t side_axis) {
            const std::uint64_t t = at[axes.axis[side_axis]];
            return (axes.reversed[side_axis] ? n - t : t) - 1;
        };
        return numbers_.first_face_ + topology.cell_faces[cell_][side] * (n - 1) * (n - 1) + along(1) * (n - 1) + along(0);
    }
    return numbers_.first_cell_ + cell_ * (n - 1) * (n - 1) * (n - 1) + ((k - 1) * (n - 1) + j - 1) * (n - 1) + i - 1;
}

}  // namespace subvol::detail
