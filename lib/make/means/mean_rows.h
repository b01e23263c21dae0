// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lane_search.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// The wholes that cells are parts of, numbered without gaps, with their cells.
struct Wholes {
    std::vector<std::size_t> of_cell;
    std::vector<std::size_t> offsets{0};
    std::vector<Index> cells;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const Index> cells_of(std::size_t whole) const {
        return std::span(cells).subspan(offsets[whole], offsets[whole + 1] - offsets[whole]);
    }
};

[[nodiscard]] Wholes wholes_of(std::size_t cells, std::span<const Index> parts);

/// The limit points of a cell's first level: 3 along each axis, u fastest.
inline constexpr std::size_t kMeanNodes = 27;

/// The integral of each node's parabolic function times the determinant of the Jacobian of the cell that runs through them.
[[nodiscard]] std::array<double, kMeanNodes> node_integrals(const std::array<Vec3, kMeanNodes>& x);

/// The weights of control values in the mean of each whole, and what the first guess needs of cells: volumes and centres.
struct MeanRows {
    LaneMatrix matrix;
    std::vector<double> volumes;
    std::vector<Vec3> centres;
};

[[nodiscard]] MeanRows mean_rows(const HexMesh& mesh, const Topology& topology, const Wholes& wholes,
                                 const SchemeOptions& scheme, Progress* progress);

}  // namespace subvol::detail
