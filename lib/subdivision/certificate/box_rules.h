// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <compare>
#include <cstdint>

namespace subvol::detail {

/// How a cell of a grid lies along an axis: the layers of cells before and behind it, up to 2; more change nothing.
struct AxisType {
    std::uint8_t low = 2, high = 2;

    [[nodiscard]] std::size_t points() const { return std::size_t{2} + low + high; }
    auto operator<=>(const AxisType&) const = default;
};

/// Such a type for each axis. A cell of this type depends on its *window*: the points of these layers; point (i, j, k) of it
/// has the number (i n₁ + j) n₂ + k.
using BoxType = std::array<AxisType, 3>;

[[nodiscard]] std::size_t window_points(const BoxType& type);

/// The type of a child: bit 2 of `child` is its half along the first axis, bit 0 that along the last.
[[nodiscard]] BoxType child_type(const BoxType& type, std::size_t child);

/// The rules of MCQ on the window of a cell: those of a whole box, as `refine` has them, cut out.
struct BoxRules {
    /// For each child the points of its window, from those of the cell's. All entries are dyadic, and exact
    std::array<Eigen::MatrixXd, 8> children;
};

[[nodiscard]] BoxRules box_rules(const BoxType& type);

}  // namespace subvol::detail
