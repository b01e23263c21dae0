// SPDX-License-Identifier: Apache-2.0
#include "mesh_file.h"

#include <algorithm>
#include <cmath>

#include "sheet_faces.h"
#include "subvol/error.h"

namespace subvol::detail {

void add_point(MeshFile& file, const Vec3& point, std::size_t position) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
        file.not_finite.push_back({file.points.size(), position});
    }
    file.points.push_back(point);
}

void add_left_out_warning(MeshFile& found, const std::string& list, std::string_view file) {
    bool has_cells = !found.quads.corners.empty() || !found.lines.corners.empty();  // sheets that are wanted
    each_kind(found, [&](const auto& cells) { has_cells = has_cells || !cells.corners.empty(); });
    if (!has_cells) {
        throw Error(ErrorCode::InvalidInput, "no hexahedra" + (list.empty() ? "" : ", but " + list + ", which are ignored"),
                    std::string(file));
    }
    if (!list.empty()) found.warnings.push_back(list + " ignored");
}

std::array<std::size_t, 2> drop_parts_of_cells(MeshFile& found, bool alone) {
    if (found.quads.corners.empty() && found.lines.corners.empty()) return {0, 0};
    const bool others = !found.tets.corners.empty() || !found.prisms.corners.empty() || !found.pyramids.corners.empty();
    if (others || found.curved.size() > 0 || (found.hexes.corners.empty() && !alone)) {
        const std::array all{found.quads.corners.size(), found.lines.corners.size()};
        found.quads = {};
        found.lines = {};
        return all;
    }
    const std::size_t points = found.points.size();
    const auto of_cells = [](auto& cells, const std::vector<std::uint8_t>& flags) {
        return drop_where(cells, [&](std::size_t c) { return flags[c] != 0; });
    };
    return {of_cells(found.quads, are_faces(found.quads.corners, found.hexes.corners, points)),
            of_cells(found.lines, are_edges(found.lines.corners, found.hexes.corners, points))};
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
