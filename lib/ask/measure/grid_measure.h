// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/dense_cells.h"

namespace subvol::detail {

/// The 27 nodes of the trilinear piece with the same corners.
[[nodiscard]] std::array<double, 27> trilinear(std::array<double, 27> nodes);

/// Integrals and extremes of one refined cell, from the grid of its nodes.
///
/// Nodes of two levels make pieces of 27 nodes, which are integrated by 27 Gauss points: exact for volumes of triquadratic
/// pieces. The passes go along one axis after the other, so that a piece takes some thousand operations; each channel takes 27
/// more, as the weights of the Gauss points are taken to the nodes once.
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
    /// The least determinant of the Jacobian at the Gauss points of the last `add_sums`.
    [[nodiscard]] double least_determinant() const { return least_; }
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
        each_piece(grid, 1, [&](const Nodes& nodes) {
            load(grid, nodes);
            weigh();
            find_values(grid, nodes);
            for (std::size_t g = 0; g < kNodes; ++g) {
                for (std::size_t c = 0; c < values.size(); ++c) values[c] = at_gauss_[c][g];
                visit(weights_[g], std::span<const double>(values));
            }
        });
    }

    /// The largest value of a channel times a sign, at a node.
    struct Extreme {
        std::size_t channel = 0;
        double sign = 1, value = 0;
        double bound = 0;         ///< how far the limit may go between the nodes, an estimate
        Vec3 uvw{0.0};            ///< place in the cell
        Vec3 peak{0.0};           ///< where the quadratic through the nodes around has the largest value, from level 2 on
        std::uint64_t alike = 0;  ///< the same for cells that look alike in this channel, from level 2 on; else 0
    };
    /// Adds the extremes of the channel whose bounds reach what is known: the largest values times −1 and times 1.
    ///
    /// quantum: values that differ by less are the same
    void add_extremes(const DenseCell& grid, std::size_t channel, const std::array<double, 2>& known, double quantum,
                      std::vector<Extreme>& extremes);

private:
    static constexpr std::size_t kNodes = 27;
    using Piece = std::array<double, kNodes>;

    /// The 27 nodes of a piece in its grid.
    struct Nodes : std::array<std::size_t, kNodes> {
        Nodes(std::size_t side, std::size_t first, std::size_t step) {
            for (std::size_t n = 0; n < kNodes; ++n) (*this)[n] = first + step * (n % 3 + side * (n / 3 % 3 + side * (n / 9)));
        }
    };

    template <class Visit>
    void each_piece(const DenseCell& grid, std::size_t step, const Visit& visit) {
        const std::size_t width = 2 * step;
        for (std::size_t w = 0; w + 1 < grid.side; w += width) {
            for (std::size_t v = 0; v + 1 < grid.side; v += width) {
                for (std::size_t u = 0; u + 1 < grid.side; u += width) {
                    visit(Nodes(grid.side, u + grid.side * (v + grid.side * w), step));
                }
            }
        }
    }
    void load(const DenseCell& grid, const Nodes& nodes);
    void weigh();
    void add(const DenseCell& grid, const Nodes& nodes, std::span<double> sums) const;
    void find_values(const DenseCell& grid, const Nodes& nodes);
    void read_channel(const DenseCell& grid, std::size_t channel);

    std::vector<double> origins_;
    std::array<Piece, 3> positions_{};  // of the piece's nodes
    std::vector<Piece> at_gauss_;       // of each channel at the Gauss points
    Piece weights_{};                   // of the Gauss points
    double least_ = 0;                  // determinant
    Piece node_weights_{};              // of the nodes: of the integral of a quadratic over the piece
    std::vector<double> channel_;       // at all nodes of a grid, times the sign
};

}  // namespace subvol::detail
