// SPDX-License-Identifier: Apache-2.0
#include "weight_inside.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel_axes.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 101;

double weight_at(const RbfVolume& volume, const Vec3& x) {
    const bool radial = is_radial(volume.kernel);
    const double radius = support_radius(volume.kernel), reach = radial ? 1 : 3;  // a cube's corner has e = 3
    double sum = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Vec3 d = x - volume.centers[i];
        const auto& f = volume.frames[i];
        const double reach_x = reach * static_cast<double>(f[0]), reach_y = reach * static_cast<double>(f[3]);
        if (d.x * d.x >= reach_x || d.y * d.y >= reach_y) continue;
        const Vec3 scaled = radius * (inverse_symmetric_root(f) * d);
        sum += radial ? radial_value(volume.kernel, glm::length(scaled)) : kernel_value(volume.kernel, scaled);
    }
    return sum;
}

}  // namespace

double weight_inside(const RbfVolume& volume) {
    if (volume.size() == 0) return 1;
    const std::size_t places = std::min(kPlaces, volume.size());
    std::vector<double> weights(places);
    tbb::parallel_for(std::size_t{0}, places, [&](std::size_t k) {
        weights[k] = weight_at(volume, volume.centers[(2 * k + 1) * volume.size() / (2 * places)]);
    });
    std::nth_element(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(places / 2), weights.end());
    return weights[places / 2];
}

}  // namespace subvol::detail
