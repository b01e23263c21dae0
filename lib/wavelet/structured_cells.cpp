// SPDX-License-Identifier: Apache-2.0
#include "structured_cells.h"

#include <algorithm>

#include "corner_bits.h"
#include "incident.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

using GridPlace = std::array<std::int64_t, 3>;

/// Walks from the first cell across faces, with the axes in hand, and gives each cell a place in a grid and its corners in the
/// grid's order. The walk fails if it comes to a cell a second time at another place or in another orientation.
class GridWalk {
public:
    explicit GridWalk(const Topology& topology)
        : t_(topology), corners_(t_.cells.size()), places_(t_.cells.size()), seen_(t_.cells.size(), 0), order_{0} {
        seen_[0] = 1;
        for (CornerNumber k = 0; k < 8; ++k) corners_[0][k] = k;
    }

    /// Whether all cells have been found, each at one place.
    [[nodiscard]] bool run() {
        for (std::size_t next = 0; next < order_.size(); ++next) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (std::size_t side = 0; side < 2; ++side) {
                    if (!step(order_[next], axis, side)) return false;
                }
            }
        }
        return order_.size() == t_.cells.size();
    }

    /// The cells in the order of the grid; nothing if the grid has gaps.
    [[nodiscard]] std::optional<StructuredCells> grid() const {
        const std::size_t n = t_.cells.size();
        GridPlace low = places_[0], high = places_[0];
        for (const GridPlace& p : places_) {
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
        }
        StructuredCells grid;
        std::size_t total = 1;
        for (std::size_t a = 0; a < 3; ++a) {
            grid.counts[a] = static_cast<std::size_t>(high[a] - low[a]) + 1;
            if (grid.counts[a] > n / total) return std::nullopt;  // so that the product does not overflow
            total *= grid.counts[a];
        }
        if (total != n) return std::nullopt;
        grid.cells.assign(n, kNone);
        grid.corners.resize(n);
        for (std::size_t c = 0; c < n; ++c) {
            const auto at = [&](std::size_t a) { return static_cast<std::size_t>(places_[c][a] - low[a]); };
            const std::size_t i = at(0) + grid.counts[0] * (at(1) + grid.counts[1] * at(2));
            if (grid.cells[i] != kNone) return std::nullopt;
            grid.cells[i] = static_cast<Index>(c);
            grid.corners[i] = corners_[c];
        }
        return grid;
    }

private:
    /// The corners of a cell on one of its sides, in the grid's orientation, and the points there.
    struct Side {
        std::array<Index, 4> points;
        std::array<std::size_t, 4> corners;

        [[nodiscard]] bool has(Index p) const { return std::find(points.begin(), points.end(), p) != points.end(); }
    };
    [[nodiscard]] Side side_at(Index cell, std::size_t axis, std::size_t side) const {
        Side found{};
        std::size_t count = 0;
        for (std::size_t k = 0; k < 8; ++k) {
            if (side_of(k, axis) != side) continue;
            found.corners[count] = k;
            found.points[count++] = t_.cells[cell][corners_[cell][k]];
        }
        return found;
    }

    /// The cell on the other side of the face with these points; kNone on the boundary.
    [[nodiscard]] Index across(Index cell, const Side& side) const {
        Index other = kNone;
        for (const Index f : t_.cell_faces[cell]) {
            const auto& face = t_.faces[f];
            const bool same = std::all_of(side.points.begin(), side.points.end(),
                                          [&](Index p) { return std::find(face.begin(), face.end(), p) != face.end(); });
            if (same) other = t_.face_cells[f][0] == cell ? t_.face_cells[f][1] : t_.face_cells[f][0];
        }
        return other;
    }

    /// The corners of the next cell in the grid's orientation: those on the shared side are at the opposite side of the next
    /// cell, and each of the others is the neighbour of one of them that is not on the face.
    [[nodiscard]] std::array<CornerNumber, 8> turned(Index other, const Side& side, std::size_t axis) const {
        std::array<CornerNumber, 8> corners{};
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t near = slot_of(t_.cells[other], side.points[i]);
            corners[flip(side.corners[i], axis)] = static_cast<CornerNumber>(near);
            for (std::size_t b = 0; b < 3; ++b) {
                if (!side.has(t_.cells[other][flip(near, b)])) {
                    corners[side.corners[i]] = static_cast<CornerNumber>(flip(near, b));
                }
            }
        }
        return corners;
    }

    /// Finds the cell across a side, if there is one; false if it contradicts what is known of it.
    [[nodiscard]] bool step(Index cell, std::size_t axis, std::size_t side) {
        const Side shared = side_at(cell, axis, side);
        const Index other = across(cell, shared);
        if (other == kNone) return true;
        const auto corners = turned(other, shared, axis);
        GridPlace place = places_[cell];
        place[axis] += side == 1 ? 1 : -1;
        if (seen_[other] != 0) return places_[other] == place && corners_[other] == corners;
        seen_[other] = 1;
        places_[other] = place;
        corners_[other] = corners;
        order_.push_back(other);
        return true;
    }

    const Topology& t_;
    std::vector<std::array<CornerNumber, 8>> corners_;
    std::vector<GridPlace> places_;
    std::vector<std::uint8_t> seen_;
    std::vector<Index> order_;
};

}  // namespace

std::optional<StructuredCells> structured_cells(const Topology& t) {
    GridWalk walk(t);
    return walk.run() ? walk.grid() : std::nullopt;
}

}  // namespace subvol::detail
