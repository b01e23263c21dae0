// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mcq_block.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/limit.h"

namespace subvol::detail {

/// The channels of a mesh, position first, as rows of doubles that vectors of four can read.
///
/// count: of the channels; stride: the same, rounded up to a multiple of 4
class Channels {
public:
    explicit Channels(const HexMesh& mesh);
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t stride() const { return stride_; }
    /// The channels of a point; the rest of the row is left as it is.
    static void read(const HexMesh& mesh, Index point, double* to);

private:
    std::size_t count_, stride_;
};

/// Copies a row of channels; returns the end of the copy.
inline double* copy_row(const double* from, std::size_t stride, double* to) {
    if (stride != 4) return std::copy_n(from, stride, to);
    const std::array<double, 4> row{from[0], from[1], from[2], from[3]};  // positions and one value: no call
    return std::copy_n(row.data(), 4, to);
}

// A *jet* is the values of all channels at one place, then their derivatives by u, by v and by w: 4 × stride numbers.

/// Evaluates places in a cell from the points around it.
class CellJets {
public:
    CellJets(Scheme scheme, std::size_t stride);

    /// By a cubic through the points of the cell's regular grid, or the spline that they control.
    ///
    /// points: rows of channels, kept by reference; grid: numbers of the rows, kNone beyond a flat boundary
    void load_grid(const double* points, const GridPoints& grid);
    /// The same for MCQ where the rows lie in a block, from (0, 0, 0) to (5, 5, 5): the cell begins at (2, 2, 2).
    void load_block(const GridRows& points);
    /// By trilinear interpolation between the cell's corners, octant by octant.
    void load_corners(const double* points, std::span<const Index, 8> corners);

    /// scale: of the derivatives, 2^level
    void evaluate(const Vec3& uvw, double scale, double* jet) const;

private:
    void fill_missing(const GridPoints& grid, std::size_t axis_stride);

    enum class Form : std::uint8_t { Grid, Block, Corners };

    bool spline_;
    Form form_ = Form::Grid;
    GridRows block_{};
    std::size_t stride_;
    const double* points_ = nullptr;
    GridPoints grid_{};
    std::vector<double> data_;  // a grid with missing points filled in, or the corners
};

/// How near the jets of two levels are to each other: within the tolerance, within some times as much, or not; Unknown if there
/// was no jet to compare with.
enum class Nearness : std::uint8_t { Unknown, Far, Some, Close };

/// A query that has not converged yet.
struct OpenPlace {
    std::size_t query;
    Vec3 uvw;                             ///< its place in the cell that is looked at
    double* last;                         ///< its jet at the level before
    Vec3 moved{0.0};                      ///< by how much it has moved in its control cell
    std::uint8_t agreed = 0;              ///< number of consecutive levels whose jets agreed within the tolerance
    Nearness before = Nearness::Unknown;  ///< how near the last two jets were to each other
    std::uint8_t octant = 8;              ///< octant of the child that it is in; at first none
    bool stays = false;     ///< whether the last two cells that it was in meet at a vertex of the cell before them
    bool has_last = false;  ///< whether there is a level before

    /// Moves it into the child that it is in.
    void step_down();
};

/// Decides when a place has converged, and writes it down.
class Settling {
public:
    /// scales: of each channel, what tolerances are relative to. All references are kept.
    Settling(const LimitOptions& options, std::span<const double> scales, std::size_t stride, LimitSamples& samples)
        : options_(options), scales_(scales), stride_(stride), samples_(samples) {}

    /// Writes the place if it has converged with this level's jet, else keeps the jet. Returns whether it has.
    ///
    /// jet: along the axes of the control cell
    [[nodiscard]] bool settle(OpenPlace& at, const double* jet, int level, bool regular, bool exact);

    /// Fetches the memory that a query's results will be written to.
    void prefetch(std::size_t query) const;

    [[nodiscard]] LimitReport& report() { return report_; }

private:
    [[nodiscard]] bool is_close(const double* a, const double* b, double factor, bool with_slopes) const;
    [[nodiscard]] Nearness nearness(const OpenPlace& at, const double* jet, bool with_slopes) const;
    void write(std::size_t query, const double* jet);

    const LimitOptions& options_;
    std::span<const double> scales_;
    std::size_t stride_;
    LimitSamples& samples_;
    LimitReport report_;
};

/// Which of the eight children a place is in, u + 2v + 4w. The place becomes that in the child.
[[nodiscard]] std::size_t step_into_octant(Vec3& uvw);

/// Adds up the queries of several.
void add_report(const LimitReport& more, LimitReport& total);

/// Weights of four grid points at −1, 0, 1, 2 for a parameter in [0,1], and their derivatives.
struct CubicWeights {
    std::array<double, 4> value{}, first{};
};

/// The sum over 4×4×4 points and its derivatives along the three axes: the jet's rows one after the other.
///
/// points: rows of `stride` channels, a multiple of 4; grid: the numbers of the rows, u fastest; scale: of the derivatives
void sum_tricubic(const double* points, const GridPoints& grid, std::size_t stride, const std::array<CubicWeights, 3>& weights,
                  double scale, double* jet);

/// Weights of six grid points at −2 … 3 for a derivative; the values take the inner four.
struct WideWeights {
    std::array<double, 4> value{};
    std::array<double, 6> first{};
};

/// The same over the points at (0, 0, 0) to (5, 5, 5) of a grid.
void sum_tricubic(const GridRows& grid, const std::array<WideWeights, 3>& weights, double scale, double* jet);

}  // namespace subvol::detail
