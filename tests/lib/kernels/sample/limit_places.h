// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "subvol/limit.h"
#include "subvol/rbf_field.h"

namespace subvol::test {

/// The root mean square error of a volume's first channel at places of the limit.
inline double rmse_at(const RbfVolume& volume, const LimitSamples& limit) {
    const auto values = RbfField(volume).evaluate(limit.positions);
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_FALSE(std::isnan(values[i]));
        sum += std::pow(values[i] - limit.attributes[0].values[i], 2);
    }
    return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Three random places per cell.
inline std::vector<LimitQuery> places(std::size_t cells) {
    std::mt19937 random(5);
    const auto unit = [&] { return static_cast<double>(random()) * 0x1p-32; };
    std::vector<LimitQuery> queries;
    for (std::size_t c = 0; c < 3 * cells; ++c) {
        const double u = unit(), v = unit(), w = unit();
        queries.push_back({static_cast<Index>(c / 3), Vec3(u, v, w)});
    }
    return queries;
}

}  // namespace subvol::test
