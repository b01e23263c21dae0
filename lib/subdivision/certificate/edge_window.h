// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "spline_rows.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The points of a plane across an edge with `cells` cells. Sector s lies between the spokes s and s + 1; point (s, i, j) is i
/// steps along spoke s and j steps along spoke s + 1 from the edge.
struct Star {
    std::size_t cells = 0, reach = 0;  ///< reach: largest i and j

    [[nodiscard]] std::size_t points() const { return 1 + cells * reach * (reach + 1); }
    /// The number of a point. A negative i or j leads to the sector beside s.
    [[nodiscard]] std::size_t number(std::size_t s, int i, int j) const;
};

/// The window of a segment of an irregular edge: the points of a star with reach 2 in four layers, from −1 to 2 along the edge;
/// the segment joins the layers 0 and 1. The limit of a spline scheme in the cells at the segment depends on these points
/// alone.
///
/// Point p of the star in layer l has the number (l + 1) star.points() + p.
struct EdgeWindow {
    static constexpr std::size_t kReach = 2, kLayers = 4;

    std::size_t cells = 0;      ///< at the edge
    std::vector<Index> points;  ///< kNone in a layer beyond the boundary, where the edge ends

    /// Whether a layer (0 first, 3 last) is beyond the boundary.
    [[nodiscard]] bool is_beyond(std::size_t layer) const { return points[layer * points.size() / kLayers] == kNone; }
};

/// The edge inside the mesh with other than four cells that a cell has; nothing if it has none or several.
[[nodiscard]] std::optional<Index> irregular_edge(const Topology& topology, Index cell);

/// The window of the irregular edge of a cell. Returns nothing unless the cell has one irregular edge, which goes straight
/// through its window or ends at a smooth boundary: the cells at the segment have no other irregular edge or point, no other
/// boundary, sharp face or crease.
[[nodiscard]] std::optional<EdgeWindow> edge_window(const Topology& topology, Index cell);

/// A cell with its axes in any order and direction: from a corner to three of its neighbours there (corner numbers).
[[nodiscard]] TurnedCell turned_at(const Topology& topology, Index cell, std::size_t corner,
                                   const std::array<std::size_t, 3>& axes);

/// Whether an irregular edge with `cells` cells goes straight through a point, or ends at it on a smooth boundary: all other
/// edges at the point are regular.
[[nodiscard]] bool is_on_straight_edge(const Topology& topology, Index point, std::size_t cells, bool is_end);

/// Whether a point is as in a grid, inside or on a side of it.
[[nodiscard]] bool is_regular_point(const Topology& topology, Index point, bool on_side);

/// The rules of a spline scheme on such a window, as `refine` has them, cut out. Weights are quotients of integers, whose
/// denominator is known: what they were rounded to in a sum of terms becomes the nearest double.
struct EdgeRules {
    std::size_t cells = 0;
    std::array<Eigen::MatrixXd, 2> halves;  ///< from the points of the window to those of the windows of its two halves
    /// From the points of the window to the 4×4×4 points of the spline in each of two small cells of sector 0 along the lower
    /// half, which start at (1, 0) and (1, 1) in small steps; point (i, j, k) of them is in row (4 i + j) 4 + k
    std::array<Eigen::MatrixXd, 2> ring;
};

/// scheme: Bsxw or CatmullClark; cells: at the edge, 3 or more
[[nodiscard]] EdgeRules edge_rules(Scheme scheme, std::size_t cells);

/// The numbers of a window's points after a symmetry of its edge: mirrored about spoke 0, turned by sectors, ends exchanged.
[[nodiscard]] std::vector<std::size_t> window_symmetry(std::size_t cells, std::size_t turn, bool mirror, bool exchange);

/// The rules of all 6 m small cells of the ring, by the symmetries of the edge; each is right-handed.
[[nodiscard]] std::vector<RowsXd> whole_ring(const EdgeRules& rules);

}  // namespace subvol::detail
