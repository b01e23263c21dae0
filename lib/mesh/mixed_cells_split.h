// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/detail/flat_array.h"
#include "subvol/mixed_cells.h"

namespace subvol::detail {

/// The split of a mixed mesh into hexahedra, without any values.
///
/// sources:  the points of the mixed mesh whose mean each new point is
/// parents:  the number of each cell's parent, counted through the hexes, tets, prisms and pyramids
/// tets_cut: the number of tetrahedra into which all cells were cut first; 0 if that was not necessary
struct HexSplit {
    IndexRows sources;
    std::vector<std::array<Index, 8>> cells;
    std::vector<Index> parents;
    std::size_t tets_cut = 0;
};

/// The main part of `split_into_hexes`; throws the same.
///
/// cut: cuts all cells into tetrahedra first, even without pyramids
[[nodiscard]] HexSplit plan_split(std::span<const Vec3> points, std::vector<std::array<Index, 8>> hexes, MixedCells others,
                                  bool cut = false);

/// The values of the new points: means over their sources.
[[nodiscard]] std::vector<Vec3> means(const IndexRows& sources, std::span<const Vec3> points);
[[nodiscard]] std::vector<double> means(const IndexRows& sources, std::span<const double> values, std::size_t channels);

}  // namespace subvol::detail
