// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol::detail {

/// Geometry and channels of the limit by control cells: each is a block of 5×5×5 points, those of its second level, and
/// interpolated by quartics along each axis. Neighbouring blocks agree in positions and values where they meet, up to rounding.
class CellBlocks {
public:
    static constexpr std::size_t kNodes = 125;  // of a block

    /// Creases have been tagged.
    ///
    /// throws: Error(Cancelled)
    CellBlocks(const HexMesh& control, const SchemeOptions& scheme, Progress* progress);

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

    /// The rows of a cell's nodes, u fastest: position and channels of each, side by side.
    [[nodiscard]] const double* nodes(std::size_t cell) const { return &rows_[cell * kNodes * row_]; }
    /// How many numbers a node has.
    [[nodiscard]] std::size_t row() const { return row_; }

    /// nodes: of the cell; step: the sample interval along u, v, w. `evaluate` leaves the mixed derivatives as they are,
    /// `evaluate_mixed` all else.
    void evaluate(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step, Jet& jet) const;
    void evaluate_mixed(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
                        Jet& jet) const;

    [[nodiscard]] std::size_t channels() const { return channels_; }

private:
    std::size_t channels_ = 0;
    std::size_t row_ = 4;  // a multiple of 4
    std::vector<double> rows_;
};

}  // namespace subvol::detail
