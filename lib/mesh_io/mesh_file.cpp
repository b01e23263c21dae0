// SPDX-License-Identifier: Apache-2.0
#include "mesh_file.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"

namespace subvol::detail {

void add_point(MeshFile& file, const Vec3& point, std::size_t position) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
        file.not_finite.push_back({file.points.size(), position});
    }
    file.points.push_back(point);
}

void add_left_out_warning(MeshFile& found, const std::string& list, std::string_view file) {
    bool has_cells = false;
    each_kind(found, [&](const auto& cells) { has_cells = has_cells || !cells.corners.empty(); });
    if (!has_cells) {
        throw Error(ErrorCode::InvalidInput, "no hexahedra" + (list.empty() ? "" : ", but " + list + ", which are ignored"),
                    std::string(file));
    }
    if (!list.empty()) found.warnings.push_back(list + " ignored");
}

std::vector<std::uint8_t> used_points(const MeshFile& found) {
    std::vector<std::uint8_t> used(found.points.size());
    each_kind(found, [&](const auto& cells) {
        for (const auto& cell : cells.corners) {
            for (const Index p : cell) used[p] = 1;
        }
    });
    for (const Index p : found.curved.nodes) used[p] = 1;
    return used;
}

}  // namespace subvol::detail
