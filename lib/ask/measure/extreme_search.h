// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "grid_measure.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/measure.h"
#include "subvol/mesh_sets.h"

namespace subvol::detail {

/// The extremes of the limit by branch and bound, for each channel and each part of a mesh: a cell is refined further while
/// the limit may go beyond the best value so far between its nodes. What is left after the first levels is halved, box by box,
/// along those of u, v and w along which it is least known; of cells that look alike, one is. In the end the best places are
/// followed in the limit itself.
class ExtremeSearch {
public:
    /// scales:    of each channel, 1/range; 0 for a constant
    /// bounds:    of each channel: no value is beyond them
    /// tolerance: as a part of the range
    ExtremeSearch(std::size_t parts, std::vector<double> scales, std::vector<std::array<double, 2>> bounds, double tolerance);

    /// Takes a value that the limit has somewhere.
    void know(std::size_t part, std::size_t channel, double value);

    /// Takes the value that a constant channel has everywhere, and a cell for its place.
    void know_constant(std::size_t part, std::size_t channel, double value, Index cell);

    /// The best values so far: the least one times −1, the largest.
    [[nodiscard]] std::array<double, 2> known(std::size_t part, std::size_t channel) const {
        return {sides_[side_of(part, channel, false)].best, sides_[side_of(part, channel, true)].best};
    }

    /// Values of a channel that differ by less count as the same; the channel is not constant.
    [[nodiscard]] double quantum(std::size_t channel) const {
        constexpr double kPartOfTolerance = 0.01;
        return kPartOfTolerance * tolerance_ / scales_[channel];
    }

    /// Looks at the nodes of a cell.
    ///
    /// number: of the cell among those of the level, or of the side among those of a patch
    /// step:   in parameters, how far an extreme may be from the node that is nearest to it; 0 along what is not searched
    /// found:  the extremes of those channels in which the cell may go beyond what is known
    void look(std::size_t part, Index cell, std::size_t number, const Vec3& step, std::span<const GridMeasure::Extreme> found);

    /// Ends a level: marks the cells that are to be refined, the most promising first.
    ///
    /// room:   at most so many
    /// marked: one flag for each cell of the level
    void end_level(std::size_t room, std::vector<std::uint8_t>& marked);

    /// Ends the last level: what is open is left to `find`.
    ///
    /// cells: of the level
    void end_cells(std::span<const Index> cells);

    /// The same of sides of cells, after `look` with steps along these: only they are searched.
    void end_sides(std::span<const CellSide> sides);

    /// Puts the extremes into the whole and, if there are any, its parts.
    ///
    /// control: its creases are tagged
    /// extent:  of the whole mesh
    void find(const HexMesh& control, const SchemeOptions& scheme, const LimitExtent& extent, Progress* progress,
              std::vector<PartMeasure>& found);

private:
    /// A place with a value near an extreme.
    struct Start {
        double value;
        double bound;  ///< sign × what the value may reach
        Index cell;
        Vec3 uvw;
        Vec3 peak;  ///< where the value may be even nearer
        Vec3 step;
    };
    struct Side {
        double sign;                  ///< 1 for the largest values, −1 for the least
        double best = -HUGE_VAL;      ///< sign × the best value that the limit is known to have
        double open = -HUGE_VAL;      ///< sign × the best value that it may have in cells that were left
        std::vector<Start> starts{};  ///< the best places, of different cells, in order

        void add(const Start& start);
    };
    /// A cell in which the limit may have an extreme.
    struct Candidate {
        std::uint32_t number, side;
        double bound;
        std::uint64_t alike;  ///< as that of the cell's extreme
    };

    [[nodiscard]] std::size_t side_of(std::size_t part, std::size_t channel, bool high) const {
        return 2 * (part * scales_.size() + channel) + (high ? 1 : 0);
    }
    /// How far beyond the best value the limit may go, in parts of the range.
    [[nodiscard]] double excess(const Candidate& candidate) const {
        return scales_[candidate.side / 2 % scales_.size()] * (candidate.bound - sides_[candidate.side].best);
    }
    [[nodiscard]] bool is_open(const Candidate& candidate) const { return excess(candidate) > 0.5 * tolerance_; }
    void leave(const Candidate& candidate) {
        sides_[candidate.side].open = std::max(sides_[candidate.side].open, candidate.bound);
    }
    void keep_open();
    void leave_out_copies();

    /// A part of a cell in which the limit may have an extreme.
    struct CellBox : Candidate {
        Index cell = 0;
        Vec3 lower{0.0}, width{1.0};  ///< in parameters of the cell; a box without width along an axis is a part of a side

        [[nodiscard]] auto place() const {
            return std::array{static_cast<double>(cell), lower.x, lower.y, lower.z, width.x, width.y, width.z};
        }
        /// The least width of those that are not 0.
        [[nodiscard]] double narrowest() const {
            double least = HUGE_VAL;
            for (int axis = 0; axis < 3; ++axis) least = width[axis] > 0 ? std::min(least, width[axis]) : least;
            return least;
        }
        /// A node of 5³.
        [[nodiscard]] Vec3 node(std::size_t n) const { return lower + width / 4.0 * Vec3(n % 5, n / 5 % 5, n / 25); }
    };
    /// The cells of a mesh around starts and boxes, and their limit.
    struct Surroundings;

    [[nodiscard]] std::size_t channel_of(std::size_t side) const { return side / 2 % scales_.size(); }
    void halve_all(const HexMesh& control, LimitOptions options, const LimitExtent& extent, Progress* progress);
    /// Halves the boxes. Returns how many were.
    ///
    /// columns: of each channel, its number among those of the surroundings, if these have it
    /// room:    so many at most
    std::size_t halve_boxes(const Surroundings& around, std::span<const std::size_t> columns, std::size_t room,
                            Progress* progress);
    void halve(const CellBox& box, std::span<const double, 125> grid);
    void climb_sides(const Surroundings& around, Progress* progress, std::vector<PartMeasure>& found) const;

    /// What a side's values may reach at most, times its sign.
    [[nodiscard]] double within(std::size_t side, double bound) const {
        const std::array<double, 2>& bounds = bounds_[channel_of(side)];
        return std::min(bound, sides_[side].sign > 0 ? bounds[1] : -bounds[0]);
    }

    std::vector<double> scales_;
    std::vector<std::array<double, 2>> bounds_;
    double tolerance_;
    std::vector<Side> sides_;
    std::vector<Candidate> candidates_;
    std::vector<CellBox> boxes_;
    std::size_t kept_ = 0;
};

/// The bounds of each channel of a mesh, infinite where there are none.
[[nodiscard]] std::vector<std::array<double, 2>> channel_bounds(const HexMesh& mesh);

/// A side of a cell as a box in its parameters, without width along one axis.
struct SideBox {
    Vec3 lower, width;
};
[[nodiscard]] SideBox box_of_side(std::uint8_t side);

}  // namespace subvol::detail
