// SPDX-License-Identifier: Apache-2.0
// One table for a mesh that moves, and the limit at a place: as an animation or a simulation would use them in every frame.

#include <cmath>
#include <cstdio>

#include "subvol/subvol.h"

int main() try {
    subvol::HexMesh mesh = subvol::make_model("ball", 8);

    // Computed once, from the topology alone. The points may then move freely.
    const subvol::RefinementTables tables = subvol::refinement_tables(build_topology(mesh), {.levels = 2});
    std::printf("%zu control points, %zu refined, %.1f MB of tables\n", tables.control_points, tables.levels.back().rows(),
                static_cast<double>(tables.bytes()) / 1e6);

    // The same place of the same cell, in every frame.
    const subvol::LimitQuery place{.cell = 0, .uvw = {.3, .5, .7}};
    bool moves = true;
    double last_x = -1e9;
    for (int frame = 0; frame < 4; ++frame) {
        for (auto& p : mesh.points) p += subvol::Vec3(.1 * std::cos(p.y), .05 * p.z, 0);
        const std::span<const double> control(&mesh.points[0].x, 3 * mesh.points.size());
        const std::vector<double> refined = tables.apply(control, 3);

        const subvol::LimitSamples limit = evaluate_limit(mesh, std::span(&place, 1));
        const subvol::Vec3& x = limit.positions[0];
        std::printf("frame %d: first refined point (%.3f %.3f %.3f), the place (%.3f %.3f %.3f), volume element %.2e\n", frame,
                    refined[0], refined[1], refined[2], x.x, x.y, x.z, glm::determinant(limit.jacobians[0]));
        moves = moves && x.x > last_x;
        last_x = x.x;
    }
    return moves ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
