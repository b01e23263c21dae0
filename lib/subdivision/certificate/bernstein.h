// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// A polynomial of a cell's parameters by its Bernstein coefficients: entry (i, j, k) at (i (d₁ + 1) + j) (d₂ + 1) + k.
template <class Value>
struct Bernstein {
    std::array<int, 3> degree{};
    std::vector<Value> values{};

    [[nodiscard]] std::array<std::size_t, 3> size() const {
        return {static_cast<std::size_t>(degree[0]) + 1, static_cast<std::size_t>(degree[1]) + 1,
                static_cast<std::size_t>(degree[2]) + 1};
    }
    /// The coefficient at a corner of the cell, which is the value there.
    [[nodiscard]] const Value& corner(std::size_t u, std::size_t v, std::size_t w) const {
        const auto n = size();
        return values[((u * (n[0] - 1)) * n[1] + v * (n[1] - 1)) * n[2] + w * (n[2] - 1)];
    }
};

/// The derivatives ∂x/∂u, ∂x/∂v, ∂x/∂w.
using BernsteinColumns = std::array<Bernstein<Vec3>, 3>;

/// The value at a place.
[[nodiscard]] Vec3 value_at(const Bernstein<Vec3>& polynomial, const Vec3& uvw);

/// The values at the 3×3×3 corners of its eighths, place (9i + 3j + k) at (i, j, k) / 2.
[[nodiscard]] std::array<Vec3, 27> values_at_halves(const Bernstein<Vec3>& polynomial);

/// The determinant of three columns. Its coefficients are sums of products with positive weights whose sum is 1, so that
/// rounding errors are below 100 units in the last place of the same sum of magnitudes.
[[nodiscard]] Bernstein<double> determinant(const BernsteinColumns& columns);

/// The polynomial on a half along an axis, in the parameters of the half. Exact but for the last place of its means.
[[nodiscard]] Bernstein<Vec3> half(const Bernstein<Vec3>& polynomial, std::size_t axis, bool upper);

}  // namespace subvol::detail
