// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace subvol::detail {

/// Weights c_j = δ_j0 − (4/m) cos(2πj/m) that extrapolate data on a ring of m members to the side opposite member 0. In the
/// regular ring of four they select exactly the opposite member.
class AntipodalWeights {
public:
    AntipodalWeights() : table_(kTabulated + 1) {
        for (std::size_t m = 3; m <= kTabulated; ++m) {
            table_[m].resize(m);
            for (std::size_t j = 0; j < m; ++j) table_[m][j] = weight(m, j);
        }
    }

    [[nodiscard]] double operator()(std::size_t m, std::size_t j) const {
        return m <= kTabulated ? table_[m][j] : weight(m, j);
    }

private:
    static constexpr std::size_t kTabulated = 16;

    [[nodiscard]] static double weight(std::size_t m, std::size_t j) {
        if (m == 4) return j == 2 ? 1.0 : 0.0;
        const std::size_t nearer = j <= m - j ? j : m - j;  // the same double on both sides of the ring
        const double angle = 2 * std::numbers::pi * static_cast<double>(nearer) / static_cast<double>(m);
        return (j == 0 ? 1.0 : 0.0) - 4.0 / static_cast<double>(m) * std::cos(angle);
    }

    std::vector<std::vector<double>> table_;
};

}  // namespace subvol::detail
