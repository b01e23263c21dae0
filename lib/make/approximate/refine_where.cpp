// SPDX-License-Identifier: Apache-2.0
#include "refine_where.h"

#include <algorithm>

#include "least_squares.h"
#include "subvol/cell.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

std::vector<double> coordinates(const std::vector<Vec3>& points, int axis) {
    std::vector<double> values;
    for (const Vec3& point : points) values.push_back(point[axis]);
    return values;
}

}  // namespace

SplitMesh refine_where(const HexMesh& given, std::span<const std::uint8_t> cells, const RefineOptions& options) {
    const HexMesh mesh = without_unused_points(given);
    RefineOptions once = options;
    once.levels = 1;
    const Topology before = build_topology(mesh);
    const std::vector<std::uint8_t> edges = edges_to_split(mesh, before, cells);
    if (std::ranges::count(edges, 0) == 0) {
        HexMesh bare = mesh;
        bare.attributes.clear();
        SplitMesh halved{refine(bare, once), {}};
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            for (const auto& at : kCornerParameters) halved.parts.push_back({c, Vec3(at[0], at[1], at[2]) / 2.0, Vec3(0.5)});
        }
        return halved;
    }
    SplitMesh split = split_sheets(mesh, before, edges);
    const Topology after = build_topology(split.mesh);
    const std::vector<LimitQuery> wanted_places = graded_places(split, after);
    std::vector<LimitQuery> corners(after.point_count);
    for (Index c = 0; c < after.cells.size(); ++c) {
        for (std::size_t k = 0; k < 8; ++k) {
            const auto& at = kCornerParameters[k];
            corners[after.cells[c][k]] = {c, Vec3(at[0], at[1], at[2])};
        }
    }
    const LimitMatrix old_limit(mesh, options, wanted_places), new_limit(split.mesh, once, corners);
    const CsrMatrix no_differences;
    const LeastSquares fit(new_limit, no_differences, false, std::vector<double>(after.point_count, 1));
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<double> wanted = old_limit.apply(coordinates(mesh.points, axis));
        std::vector<double> x = wanted;
        constexpr int kSteps = 200;  // none with a scheme that interpolates
        (void)fit.solve(wanted, x, kSteps, options.progress);
        for (std::size_t p = 0; p < x.size(); ++p) split.mesh.points[p][axis] = x[p];
    }
    return split;
}

}  // namespace subvol::detail
