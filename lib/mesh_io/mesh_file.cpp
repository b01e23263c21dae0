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

void check_corners(const TextScanner& in, std::size_t position, std::span<const Index> corners, std::size_t cell,
                   const EntityNames& names, std::string_view kind) {
    for (std::size_t k = 1; k < corners.size(); ++k) {
        const auto before = corners.first(k);
        if (std::find(before.begin(), before.end(), corners[k]) == before.end()) continue;
        in.fail_at(position, names.cell(cell) + " has " + names.point(corners[k]) + " twice",
                   std::string(kind) + " needs " + std::to_string(corners.size()) + " different corners");
    }
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
    return used;
}

}  // namespace subvol::detail
