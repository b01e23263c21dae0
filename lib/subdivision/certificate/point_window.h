// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "spline_rows.h"
#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The cells at a point: a triangle for each cell, whose vertices are the directions of the cell's edges there, right-handed.
/// Directions are numbered from 0. Around a point inside the triangles form a sphere, on the boundary a disk.
using PointLink = std::vector<std::array<int, 3>>;

/// The points around a point, octant by octant: (t, (i, j, k)) is i, j and k steps along the directions of triangle t.
class PointStar {
public:
    PointStar(const PointLink& link, int reach);

    [[nodiscard]] const PointLink& link() const { return link_; }
    [[nodiscard]] int reach() const { return reach_; }
    [[nodiscard]] std::size_t points() const { return numbers_.size(); }
    [[nodiscard]] std::size_t number(std::size_t t, const std::array<int, 3>& steps) const;

    /// The triangle beyond the side across from a vertex of a triangle; nothing at the rim of a disk.
    [[nodiscard]] std::optional<std::size_t> beyond(std::size_t t, std::size_t vertex) const;
    /// How many triangles a direction has, and whether it is on the rim.
    [[nodiscard]] std::size_t valence(int direction) const;
    [[nodiscard]] bool on_rim(int direction) const;

    /// Calls visit(t, steps) for all places with steps up to the reach; those of sides more than once.
    template <class Visit>
    void each(const Visit& visit) const {
        for (std::size_t t = 0; t < link_.size(); ++t) {
            for (int i = 0; i <= reach_; ++i) {
                for (int j = 0; j <= reach_; ++j) {
                    for (int k = 0; k <= reach_; ++k) visit(t, std::array<int, 3>{i, j, k});
                }
            }
        }
    }

private:
    using Place = std::array<std::array<int, 2>, 3>;  // directions and steps, those of 0 steps first as {−1, 0}
    [[nodiscard]] Place place_of(std::size_t t, const std::array<int, 3>& steps) const;

    PointLink link_;
    int reach_;
    std::map<Place, std::size_t> numbers_;
};

/// The window of an irregular point: the points of a star with reach 2. The limit of a spline scheme in the cells at the point
/// depends on these points alone.
struct PointWindow {
    static constexpr int kReach = 2;

    PointLink link;  ///< in an order that depends on how cells meet alone
    std::vector<Index> points;
    std::vector<Index> cells;  ///< at the point
};

/// The window of an irregular point inside or on a smooth boundary. Returns nothing unless all that is irregular there are
/// edges inside, which go straight on through the window.
[[nodiscard]] std::optional<PointWindow> point_window(const Topology& topology, Index point, Index cell_at_point);

/// The rules of a spline scheme on such a window, as `refine` has them, cut out.
struct PointRules {
    struct Segment {
        std::size_t cells = 0;
        Eigen::MatrixXd rows;  ///< to the window of the segment (edge_window.h)
    };
    Eigen::MatrixXd step;           ///< from the points of the window to those of the next window about the point
    std::vector<RowsXd> shell;      ///< to the 4×4×4 points of regular small cells that are not at the point any more
    std::vector<Segment> segments;  ///< segments of irregular edges that are not at the point any more
};

/// scheme: Bsxw or CatmullClark
[[nodiscard]] PointRules point_rules(Scheme scheme, const PointLink& link);

}  // namespace subvol::detail
