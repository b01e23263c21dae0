// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "subvol/topology.h"

namespace subvol::detail {

/// The number of a vertex of the refined mesh: the same in all cells that share the vertex.
using VertexNumber = std::uint64_t;

/// Numbers of the vertices of a mesh after `level` refinements, without refining it: those of the control points, then those on
/// edges, on faces, and inside cells.
class GridNumbers {
public:
    /// topology: kept by reference
    GridNumbers(const Topology& topology, int level);

    /// Sets the cell whose vertices are asked for.
    class Cell {
    public:
        Cell(const GridNumbers& numbers, Index cell);
        /// ijk: 0 to 2^level
        [[nodiscard]] VertexNumber operator()(std::size_t i, std::size_t j, std::size_t k) const;

    private:
        const GridNumbers& numbers_;
        Index cell_;
        std::array<bool, 12> reversed_{};
        // For the first and the second axis of each face: which of the cell's axes it is, and whether it is reversed.
        struct FaceAxes {
            std::array<std::size_t, 2> axis;
            std::array<bool, 2> reversed;
        };
        std::array<FaceAxes, 6> faces_{};
    };

private:
    const Topology& topology_;
    std::uint64_t side_;  // intervals along an edge
    VertexNumber first_edge_, first_face_, first_cell_;
};

}  // namespace subvol::detail
