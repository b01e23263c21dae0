// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/topology.h"

namespace subvol::detail {

/// An order of the points of a mesh, and how the value of each is predicted from those before it: the sum of the weights times
/// their values, divided by `parts` and rounded. All of it is whole numbers, so that every machine predicts the same.
struct ValuePrediction {
    std::vector<Index> order;  ///< each point once
    std::vector<std::size_t> offsets{0};
    std::vector<Index> points;         ///< a row for each point, in the order of `order`
    std::vector<std::int8_t> weights;  ///< a row for each point, in the order of `order`
    std::vector<std::uint8_t> parts;   ///< for each row the divisor

    /// What row `i` predicts.
    [[nodiscard]] std::int64_t predict(std::size_t i, std::span<const std::int64_t> values) const {
        std::int64_t sum = 0;
        for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k) sum += weights[k] * values[points[k]];
        const std::int64_t divisor = 2 * std::int64_t{parts[i]}, twice = 2 * sum + parts[i];
        return twice >= 0 ? twice / divisor : -((divisor - 1 - twice) / divisor);  // rounded to the lower one
    }
};

/// Each value is that of the point before.
[[nodiscard]] ValuePrediction predict_by_number(std::size_t points);

/// Cell after cell: the eighth corner of a cell is predicted from its seven, f = Σ ± f, exact for products of linear
/// functions but u v w; the fourth corner of a face from its three; else the value of a neighbour.
[[nodiscard]] ValuePrediction predict_in_cells(const Topology& topology);

/// From coarse to fine: pairs of neighbouring sheets of cells are joined, level by level, and the points between them are
/// predicted by the cubic, at ends the quadratic, through their neighbours across the sheets.
[[nodiscard]] ValuePrediction predict_between_sheets(const Topology& topology);

}  // namespace subvol::detail
