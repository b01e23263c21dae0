// SPDX-License-Identifier: Apache-2.0
#include "fine_walls.h"

#include <algorithm>
#include <array>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/surface_builder.h"
#include "subvol/limit.h"
#include "subvol/refine.h"
#include "surface_bodies.h"

namespace subvol::detail {

std::vector<FineWalls> fine_walls(const HexMesh& mesh, std::span<const Index> materials, const SchemeOptions& scheme) {
    const Topology topology = build_topology(mesh);
    const auto wall_at = [&](Index face) { return wall_of(topology, materials, face); };
    std::vector<Index> cells;
    for (Index c = 0; c < topology.cells.size(); ++c) {
        const bool at_wall = std::ranges::any_of(topology.cell_faces[c], [&](Index face) { return wall_at(face) != kNone; });
        if (at_wall || !interpolates(scheme.kind)) cells.push_back(c);
    }
    constexpr int kLevels = 2;
    constexpr std::size_t kDescendants = 64;
    const HexMesh fine = on_limit(refine_cells(mesh, cells, {.scheme = scheme, .levels = kLevels}), scheme.kind);
    std::vector<FineWalls> walls(materials.empty() ? 1 : std::size_t{1} + std::ranges::max(materials));
    for (Index m = 0; m < walls.size(); ++m) {
        SurfaceBuilder closed(fine.points.size()), own(fine.points.size());
        for (std::size_t c = 0; c < fine.cells.size(); ++c) {
            const Index parent = cells[c / kDescendants];
            if (!materials.empty() && materials[parent] != m) continue;
            const auto& faces = topology.cell_faces[parent];
            for (std::size_t side = 0; side < 6; ++side) {
                // A child lies at a side of its parent where its corner does.
                const auto at_side = [&](std::size_t corner) { return std::ranges::count(kCellFaces[side], corner) > 0; };
                const Index wall = wall_at(faces[side]);
                if (wall == kNone || !at_side(c % 8) || !at_side(c / 8 % 8)) continue;
                std::array<Index, 4> quad;
                for (std::size_t k = 0; k < 4; ++k) quad[k] = fine.cells[c][kCellFaces[side][k]];
                std::rotate(quad.begin(), std::ranges::min_element(quad), quad.end());
                closed.add(quad);
                if (wall != m) continue;
                own.add(quad);
                walls[m].sides.push_back({parent, static_cast<std::uint8_t>(side)});
            }
        }
        const auto place = [&](Index p) { return fine.points[p]; };
        walls[m].closed = closed.finish(place);
        walls[m].own = own.finish(place);
    }
    return walls;
}

ShapeError error_of(const std::vector<FineWalls>& fine, const WallTargets& walls, const Progress* progress) {
    if (is_cancelled(progress)) return {};
    DistanceSums sums;
    for (std::size_t m = 0; m < fine.size(); ++m) {
        if (fine[m].own.triangles.empty()) continue;
        SurfaceDistances(walls.targets[m], fine[m].own.points.size(), progress).add_errors(fine[m].own, sums);
    }
    return sums.result();
}

std::vector<CellSide> lids_of(const std::vector<FineWalls>& fine, const WallTargets& walls) {
    std::vector<std::pair<CellSide, double>> parts;
    for (std::size_t m = 0; m < fine.size(); ++m) {
        const Surface& own = fine[m].own;
        if (own.triangles.empty() || open_edges(*walls.targets[m].surface).count == 0) continue;
        const std::vector<std::uint8_t> over = SurfaceDistances(walls.targets[m], 1).over_holes(own);
        for (std::size_t t = 0; t < own.triangles.size(); ++t) {
            const auto& corners = own.triangles[t];
            const Vec3& a = own.points[corners[0]];
            const double area = glm::length(glm::cross(own.points[corners[1]] - a, own.points[corners[2]] - a));
            const auto count = std::ranges::count_if(corners, [&](Index p) { return over[p] != 0; });
            constexpr double kHalfOfCorners = 1.5;
            parts.emplace_back(fine[m].sides[t / 2], (static_cast<double>(count) - kHalfOfCorners) * area);
        }
    }
    const auto key = [](const auto& part) { return std::pair(part.first.cell, part.first.side); };
    std::ranges::stable_sort(parts, {}, key);
    std::vector<CellSide> lids;
    for (std::size_t k = 0, end = 0; k < parts.size(); k = end) {
        double sum = 0;
        for (end = k; end < parts.size() && parts[end].first == parts[k].first; ++end) sum += parts[end].second;
        if (sum > 0) lids.push_back(parts[k].first);
    }
    return lids;
}

}  // namespace subvol::detail
