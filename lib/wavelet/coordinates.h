// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// x, y, z of each point, point-major.
[[nodiscard]] inline std::vector<double> coordinates(const std::vector<Vec3>& points) {
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (const Vec3& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

}  // namespace subvol::detail
