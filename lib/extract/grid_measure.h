// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/dense_cells.h"

namespace subvol::detail {

/// Integrals and extremes of one refined cell, from the grid of its nodes.
///
/// Nodes of two levels make pieces of 27 nodes, which are integrated by 27 Gauss points: exact for volumes of triquadratic
/// pieces. The passes go along one axis after the other, so that a piece takes some thousand operations.
///
/// Sums: the volume, then for each channel the integral of the value without the channel's origin.
class GridMeasure {
public:
    /// origins: of the channels of all attributes
    explicit GridMeasure(std::vector<double> origins);

    [[nodiscard]] std::size_t channels() const { return origins_.size(); }

    /// Adds the sums of a grid, made of pieces whose nodes are `step` apart, to `sums`: one number for the volume and one for
    /// each channel.
    void add_sums(const DenseCell& grid, std::size_t step, std::span<double> sums);
    /// The same of the cell that is trilinear between the grid's corners.
    void add_trilinear_sums(const DenseCell& grid, std::span<double> sums);

    /// The volume that a side of the cell sweeps from pieces whose nodes are 2·step apart to those of `step`, outwards, from
    /// the bilinear side if the grid has no such pieces.
    ///
    /// side: as kCellFaces
    [[nodiscard]] static double swept(const DenseCell& grid, std::size_t side);
    /// The mean of each channel on a side, without its origin.
    void mean_on_side(const DenseCell& grid, std::size_t side, std::span<double> means) const;

    /// Calls visit(weight, values) for all Gauss points of the grid's pieces. Weights sum to the volume.
    ///
    /// values: of all channels, without their origins
    template <class Visit>
    void each_gauss_point(const DenseCell& grid, const Visit& visit) {
        std::vector<double> values(channels());
        each_piece(grid, 1, [&] {
            for (std::size_t g = 0; g < kNodes; ++g) {
                for (std::size_t c = 0; c < values.size(); ++c) values[c] = at_gauss_[c][g];
                visit(weights_[g], std::span<const double>(values));
            }
        });
    }

    /// A value of a channel, and where in the cell.
    struct Place {
        double value = 0;
        Vec3 uvw{0.0};
    };
    /// The least and the largest value of a channel.
    ///
    /// low, high: at nodes
    /// low_peak, high_peak: from level 2 on, where the quadratics through the nodes around these have their extremes
    /// low_bound, high_bound: how far the limit may go between the nodes, an estimate
    struct Extremes {
        Place low, high;
        Vec3 low_peak{0.0}, high_peak{0.0};
        double low_bound = 0, high_bound = 0;
    };
    [[nodiscard]] Extremes extremes(const DenseCell& grid, std::size_t channel);

private:
    static constexpr std::size_t kNodes = 27;
    using Piece = std::array<double, kNodes>;

    template <class Visit>
    void each_piece(const DenseCell& grid, std::size_t step, const Visit& visit) {
        const std::size_t width = 2 * step;
        for (std::size_t w = 0; w + 1 < grid.side; w += width) {
            for (std::size_t v = 0; v + 1 < grid.side; v += width) {
                for (std::size_t u = 0; u + 1 < grid.side; u += width) {
                    load(grid, u + grid.side * (v + grid.side * w), step);
                    evaluate();
                    visit();
                }
            }
        }
    }
    void load(const DenseCell& grid, std::size_t first, std::size_t step);
    void evaluate();
    void add(std::span<double> sums) const;
    void read_channel(const DenseCell& grid, std::size_t channel);
    void find_bounds(std::size_t side, Extremes& result) const;
    [[nodiscard]] Vec3 peak(std::size_t node, std::size_t side, double sign) const;

    std::vector<double> origins_;
    std::array<Piece, 3> positions_{};      // of the piece's nodes
    std::vector<Piece> values_, at_gauss_;  // of each channel at the nodes, at the Gauss points
    Piece weights_{};
    std::vector<double> channel_;  // at all nodes of a grid
};

}  // namespace subvol::detail
