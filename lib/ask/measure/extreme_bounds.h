// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "subvol/vec.h"

namespace subvol::detail {

// How large the limit may be between the nodes of a grid: estimates. A grid has side³ values, u fastest.

/// From the nodes of level 1, 3³; -HUGE_VAL if it does not reach what is known.
[[nodiscard]] double first_bound(std::span<const double> grid, double known);

/// The same from level 2 on.
struct FinerBound {
    double bound = -HUGE_VAL;
    std::uint64_t alike = 0;  ///< the same number for grids whose pieces have the same values and bounds, in any order
};
/// side:    5, or one more than a larger multiple of 4
/// quantum: values that differ by less are the same
[[nodiscard]] FinerBound finer_bound(std::span<const double> grid, std::size_t side, double known, double quantum);

/// The bounds of the octants of a grid of 5³ nodes, in the order u + 2v + 4w.
struct OctantBounds {
    std::array<double, 8> bounds;
    /// Along each axis, how far the limit may be from the parabolas of the nodes: what is gained where that axis is halved
    std::array<double, 3> bends;
};
[[nodiscard]] OctantBounds octant_bounds(std::span<const double, 125> grid);

/// Where the quadratic through the 27 nodes around a node, or beside it at the sides, has its largest value, in [0,1]³.
[[nodiscard]] Vec3 peak_near(std::span<const double> grid, std::size_t side, std::size_t node);

}  // namespace subvol::detail
