// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/detail/flat_array.h"
#include "subvol/mixed_cells.h"

namespace subvol::detail {

/// How a mixed mesh becomes one of hexahedra, apart from any values.
///
/// sources:  the points of the mixed mesh whose mean each new point is
/// parents:  of each cell its parent's place among the hexes, tets, prisms and pyramids, counted through
/// tets_cut: into how many tetrahedra all cells were cut first; 0 if there was no need
struct HexSplit {
    IndexRows sources;
    std::vector<std::array<Index, 8>> cells;
    std::vector<Index> parents;
    std::size_t tets_cut = 0;
};

/// As `split_into_hexes`, of which it is the larger part; throws the same.
[[nodiscard]] HexSplit plan_split(std::span<const Vec3> points, std::vector<std::array<Index, 8>> hexes, MixedCells others);

/// The values of the new points.
[[nodiscard]] std::vector<Vec3> means(const IndexRows& sources, std::span<const Vec3> points);
[[nodiscard]] std::vector<double> means(const IndexRows& sources, std::span<const double> values, std::size_t channels);

}  // namespace subvol::detail
