// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/vec.h"

namespace subvol::detail {

/// A linear function of places in the world.
struct Trend {
    Vec3 center{0.0};
    double mean = 0;
    Vec3 gradient{0.0};

    [[nodiscard]] double at(const Vec3& x) const { return mean + glm::dot(gradient, x - center); }
};

/// The linear function that is nearest to samples by least squares, with as much of its gradient as it explains of their
/// variance: a linear function itself is found again, and noise in a small cluster of samples has no gradient. Along directions
/// in which the samples do not differ, the gradient is 0.
///
/// values: one for each place
[[nodiscard]] Trend trend_of(std::span<const Vec3> places, std::span<const double> values);

}  // namespace subvol::detail
