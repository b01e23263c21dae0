// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Geometry and channels of a twice refined mesh by its control cells: each is a block of 5×5×5 points, interpolated by
/// quartics along each axis. Neighbouring blocks agree in positions and values where they meet.
class CellBlocks {
public:
    static constexpr int kLevels = 2;

    /// twice_refined: what `refine` makes of the control mesh in two levels; kept by reference
    explicit CellBlocks(const HexMesh& twice_refined);

    /// Values, derivatives and second differences per sample interval at a point of a cell. Channels are those of all
    /// attributes, one after the other.
    struct Jet {
        Vec3 position;
        std::array<Vec3, 3> d_position, dd_position;           // by u, v, w
        std::vector<double> value;                             // by channel
        std::vector<std::array<double, 3>> d_value, dd_value;  // by channel and u, v, w
        std::array<Vec3, 3> mixed_position;                    // by v and w, w and u, u and v
        std::vector<std::array<double, 3>> mixed_value;
    };

    /// The nodes of the cells that were looked at last: position and channels of each, side by side. Each thread has its own.
    class Nodes {
    public:
        explicit Nodes(const CellBlocks& blocks);
        /// The rows of a cell's 125 nodes, u fastest.
        [[nodiscard]] const double* of(std::size_t cell);

    private:
        static constexpr std::size_t kCells = 16;  // as many as meet at most points
        const CellBlocks& blocks_;
        std::array<std::size_t, kCells> cells_;
        std::vector<double> rows_;
    };

    /// nodes: of the cell; step: the sample interval along u, v, w. `evaluate` leaves the mixed derivatives as they are,
    /// `evaluate_mixed` all else.
    void evaluate(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step, Jet& jet) const;
    void evaluate_mixed(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
                        Jet& jet) const;

    [[nodiscard]] std::size_t channels() const { return channels_; }

private:
    /// Point `node` of a cell's 125, u fastest.
    [[nodiscard]] Index point(std::size_t cell, std::size_t node) const;
    [[nodiscard]] double channel_value(Index point, std::size_t channel) const;

    const HexMesh& mesh_;
    std::size_t channels_ = 0;
    std::size_t row_ = 4;                                      // numbers of a node: a multiple of 4
    std::vector<std::pair<std::size_t, std::size_t>> source_;  // channel → attribute, channel of it
};

}  // namespace subvol::detail
