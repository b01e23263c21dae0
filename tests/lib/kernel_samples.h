// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "subvol/kernel.h"

namespace subvol::test {

inline TableKernel small_table() {  // symmetric in the axes, as every basis function here is
    TableKernel table{.radius = 1.5, .count = 5, .values = {}};
    for (std::size_t k = 0; k < 5; ++k) {
        for (std::size_t j = 0; j < 5; ++j) {
            for (std::size_t i = 0; i < 5; ++i) {
                const auto x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
                table.values.push_back(1 / (1 + x * x + y * y + z * z + 0.3 * x * y * z));
            }
        }
    }
    return table;
}

/// One kernel or more of every type; names only for messages.
inline std::vector<std::pair<std::string, Kernel>> every_kernel() {
    return {{"compact", CompactKernel{}},
            {"gaussian", GaussianKernel{.sigma = 0.43, .amplitude = 0.9, .radius = 1.7}},
            {"gaussian sum", GaussianSumKernel{.amplitudes = {1.01, -0.16, 0.02}, .sigmas = {0.5, 0.75, 1}, .radius = 2.5}},
            {"bc", BcSplineKernel{}},
            {"bc of extent 1", BcSplineKernel{.b = 0.382175, .c = 0.253253, .extent = 1}},
            {"bc of extent 3", BcSplineKernel{.b = -0.0628, .c = 0.012591, .extent = 3}},
            {"cardinal", CardinalSplineKernel{}},
            {"wendland c2", WendlandC2Kernel{}},
            {"wendland c4", WendlandC4Kernel{}},
            {"separable gaussian", SeparableGaussianKernel{}},
            {"cubic convolution", CubicConvolutionKernel{}},
            {"separable table", SeparableTableKernel{.radius = 2, .values = {1, 0.6, 0.1, -0.05, 0.01, 0}}},
            {"table", small_table()}};
}

/// Whether the kernel's value jumps somewhere (a cut-off counts).
inline bool has_jumps(const Kernel& kernel) {
    if (const auto* bc = std::get_if<BcSplineKernel>(&kernel)) return bc->extent != 2;
    return std::holds_alternative<GaussianKernel>(kernel) || std::holds_alternative<GaussianSumKernel>(kernel) ||
           std::holds_alternative<SeparableGaussianKernel>(kernel) || std::holds_alternative<TableKernel>(kernel);
}

}  // namespace subvol::test
