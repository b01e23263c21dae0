// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "subvol/optics.h"

namespace subvol::detail {

/// Prefix integrals of extinction τ and emission τ·c over the value, for pre-integrated classification: renderers that sample
/// planes use them for the interval between two planes, on which the value is linear. Values are measured in cells,
///
///     x = (value − min) · kCells / (max − min).
///
/// Cell i has row i + 1. Rows 0 and kCells + 1 are for all values below min and above max, where τ and c are constant.
///
/// Each row has four channels: τ, τr, τg, τb. With s = x − i, the integral from the lower end of cell i to x is
///
///     s · (mean − (1−s) · bend),
///
/// which is exact for the whole cell, and everywhere in it if the channel is linear there. So the mean extinction between two
/// places x₀ and x₁ is
///
///     (unit·(prefix₁ − prefix₀) + s₁·(mean₁ − (1−s₁)·bend₁) − s₀·(mean₀ − (1−s₀)·bend₀)) / (x₁ − x₀).
///
/// Prefixes are integers, so that small differences of large integrals keep all their digits.
struct PreintegratedTable {
    static constexpr int kCells = 4096;
    struct Row {
        std::array<std::int32_t, 4> prefix;
        std::array<float, 4> mean;
        std::array<float, 4> bend;
    };
    double min = 0;
    double max = 1;
    std::array<float, 4> unit{};        // the integral, τ · cells, of a count of 1 in `prefix`
    std::vector<Row> rows;              // kCells + 2
    std::vector<std::int32_t> visible;  // visible[i]: how many rows before i are not transparent; kCells + 3

    /// Whether all values between x0 and x1 (cells) are wholly transparent.
    [[nodiscard]] bool transparent(double x0, double x1) const;
};

/// min and max span all knots of the function.
[[nodiscard]] PreintegratedTable make_preintegrated_table(const Optics& optics);

}  // namespace subvol::detail
