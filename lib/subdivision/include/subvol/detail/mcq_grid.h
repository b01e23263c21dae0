// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace subvol::detail {

/// MCQ in a grid, without topology: from the 6×6×6 points about a cell, two beyond it on every side, to those about one of its
/// eight children. Entry i + 6j + 36k lies at (i−2, j−2, k−2) in the cell's parameters.
class McqGrid {
public:
    static constexpr std::size_t kSide = 6, kPoints = kSide * kSide * kSide;

    explicit McqGrid(double tension);

    /// octant: u + 2v + 4w of the child
    /// from, to: kPoints × channels values, point-major
    void refine(std::size_t octant, std::size_t channels, std::span<const double> from, std::span<double> to) const;

    /// Terms of one weight; offsets in points, from the lowest of the old points about the new one.
    struct Run {
        double weight;
        std::vector<std::int16_t> offsets;
    };

    /// The mask of each kind of new point: bits u + 2v + 4w are set for the axes along which it lies half way.
    [[nodiscard]] const std::array<std::vector<Run>, 8>& masks() const { return masks_; }

private:
    std::array<std::vector<Run>, 8> masks_;
};

}  // namespace subvol::detail
