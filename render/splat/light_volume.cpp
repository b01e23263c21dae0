// SPDX-License-Identifier: Apache-2.0
#include "light_volume.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

GridCorners corners_around(const Vec3& place, const std::array<int, 3>& size) {
    std::array<std::size_t, 3> cell{};
    std::array<double, 3> part{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double x = std::clamp(place[static_cast<int>(k)], 0.0, static_cast<double>(size[k] - 1));
        const double low = std::min(std::floor(x), static_cast<double>(size[k] - 2));
        cell[k] = static_cast<std::size_t>(low);
        part[k] = x - low;
    }
    const auto width = static_cast<std::size_t>(size[0]), height = static_cast<std::size_t>(size[1]);
    GridCorners corners;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::size_t x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        corners.nodes[corner] = ((cell[2] + z) * height + cell[1] + y) * width + cell[0] + x;
        corners.weights[corner] = (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2]);
    }
    return corners;
}

std::array<float, 2> LightVolume::at(const Vec3& world) const {
    const GridCorners corners = corners_around(to_nodes * world + offset, size);
    std::array<double, 2> sum{};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t c = 0; c < 2; ++c) sum[c] += corners.weights[k] * static_cast<double>(nodes[corners.nodes[k]][c]);
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1])};
}

EyeToNodes eye_to_nodes(const LightVolume& light, const View& view, double middle) {
    const auto& [right, up, forward] = view.axes();
    const Mat3 to_nodes = light.to_nodes * Mat3(right, up, forward);  // the axes are columns: from eye space to the world
    const Vec3 offset = light.to_nodes * (view.eye() + middle * forward) + light.offset;
    EyeToNodes rows;
    for (int k = 0; k < 3; ++k) {
        rows[static_cast<std::size_t>(k)] = {static_cast<float>(to_nodes[0][k]), static_cast<float>(to_nodes[1][k]),
                                             static_cast<float>(to_nodes[2][k]), static_cast<float>(offset[k])};
    }
    return rows;
}

}  // namespace subvol::detail
