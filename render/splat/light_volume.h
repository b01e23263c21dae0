// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "subvol/camera.h"

namespace subvol::detail {

/// The nodes of a grid about a place, and their weights in it.
struct GridCorners {
    std::array<std::size_t, 8> nodes{};
    std::array<double, 8> weights{};
};

/// place: in numbers of nodes; beyond the grid's ends it is moved to them. size: at least 2 along each axis, x fastest
[[nodiscard]] GridCorners corners_around(const Vec3& place, const std::array<int, 3>& size);

/// How much light arrives at places, on a grid that is linear between its nodes. Each node: the part of the key light that the
/// volume lets through, and the part of the surroundings that is open. Beyond its ends the grid continues with its last nodes.
struct LightVolume {
    std::array<int, 3> size{};                // x fastest
    std::vector<std::array<float, 2>> nodes;  // {key, open}
    Mat3 to_nodes{1.0};                       // places in numbers of nodes: to_nodes · world + offset
    Vec3 offset{0.0};
    double spacing_world = 0;  // the largest one between nodes

    [[nodiscard]] std::array<float, 2> at(const Vec3& world) const;
};

/// The same for places in the eye space of a view, with depths relative to `middle`: rows of {x, y, depth, 1}.
using EyeToNodes = std::array<std::array<float, 4>, 3>;
[[nodiscard]] EyeToNodes eye_to_nodes(const LightVolume& light, const View& view, double middle);

}  // namespace subvol::detail
