// SPDX-License-Identifier: Apache-2.0
// The refined volume as OpenVDB grids, for Blender, Houdini and the like. Writes ball.vdb and reads it again.

#include <cmath>
#include <cstdio>

#include "subvol/subvol.h"
#include "subvol/vdb.h"

int main() try {
    // Refine first, since a grid shows the cells that it is given: only a refined mesh looks like a ball.
    subvol::HexMesh mesh = subvol::make_model("ball", 8);
    mesh.attributes.push_back({.name = "height", .channels = 1, .values = {}});
    for (const subvol::Vec3& p : mesh.points) mesh.attributes.back().values.push_back(p.z);
    const subvol::HexMesh fine = subvol::refine(mesh, {.levels = 2});

    // One float grid per field. Voxel centres lie at world = size * (i, j, k).
    const std::vector<std::string> fields{mesh.attributes[0].name, "height"};
    subvol::write_vdb("ball.vdb", rasterize(fine, fields, {.voxel_size_world = .02}));

    double worst = 0;
    for (const subvol::VdbGrid& grid : subvol::read_vdb("ball.vdb")) {
        const subvol::GridReport& report = grid.report();
        const double volume = static_cast<double>(report.active_voxels) * std::pow(report.voxel_size_world, 3);
        std::printf("%s: %zu active voxels, a volume of %.3f, values %.2f to %.2f\n", report.name.c_str(), report.active_voxels,
                    volume, report.min, report.max);
        worst = std::max(worst, std::abs(volume / (4 * std::acos(-1.0) / 3) - 1));
        if (report.name == "height") worst = std::max(worst, std::abs(grid.value({.1, .2, .3}).value_or(9) - .3));
    }
    return worst < .01 ? 0 : 1;  // a hundredth: the voxels at the rim
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
