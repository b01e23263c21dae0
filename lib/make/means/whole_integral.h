// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mean_channels.h"
#include "mean_stencils.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// A channel whose values are found, but for the whole integral. Means and values are divided by a power of two, and then
/// relative to the least mean, so that a large constant takes no digits from what varies.
struct FittedChannel {
    MeanChannel channel{};
    int exponent = 0;
    double low = 0, high = 0;    ///< range of the means
    double least = 0, most = 0;  ///< what values are kept within, relative; or infinite
    double integral = 0;         ///< integral of the relative means over the straight cells
    double lacks = 0;            ///< what the integral of the values' limit over the straight cells lacks of that
    std::vector<double> values{};
    std::vector<double> from{}, to{};  ///< what each value is kept between, by the means around it

    [[nodiscard]] bool is_constant() const { return !(high > low); }
    /// What the field is kept within.
    [[nodiscard]] std::array<double, 2> bounds() const;
    /// The field's value at a point.
    [[nodiscard]] double value(std::size_t point) const;
};

/// The volume of the straight cells, its first moments, and the weights of control values in the integral of their limit over
/// it.
struct StraightVolume {
    double volume = 0;
    Vec3 moment{0.0};
    std::vector<double> weights{};
};

[[nodiscard]] StraightVolume straight_volume(const HexMesh& mesh, const MeanStencils& stencils);

/// Changes the values so that the integral over all cells is that of the means.
void correct_integrals(const HexMesh& mesh, const StraightVolume& straight, std::vector<FittedChannel>& channels,
                       Progress* progress);

}  // namespace subvol::detail
