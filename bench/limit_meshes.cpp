// SPDX-License-Identifier: Apache-2.0
// The limit of meshes as voxel grids, against their cells as they are. Arguments: mesh files, or models as NAME:RESOLUTION; an
// option --resolution N before them (128), and --deep to compare voxels and values with those of trilinear cells of level 3.
//
// ratio: seconds of the limit (levels and voxels) to those of level 0, and the same of CPU-seconds, which depend less on what
// else the machine does. left: of voxels and of the values' range, as reported.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "measure.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "subvol/voxels.h"

namespace {

using namespace subvol;

HexMesh load(const std::string& name) {
    const auto colon = name.find(':');
    HexMesh mesh = colon == std::string::npos ? read_mesh(name).mesh
                                              : make_model(name.substr(0, colon), std::atoi(name.c_str() + colon + 1));
    mesh = without_unused_points(std::move(mesh));
    if (std::ranges::none_of(mesh.attributes, [](const Attribute& a) { return a.channels == 1; })) {
        mesh.attributes = {{"density", 1, std::vector<double>(mesh.points.size(), 1.0)}};
    }
    std::erase_if(mesh.attributes, [](const Attribute& a) { return a.channels != 1; });
    mesh.attributes.resize(1);
    return mesh;
}

}  // namespace

int main(int argc, char** argv) {
    int resolution = 128;
    bool deep = false;
    std::printf("%-34s %8s %7s %7s %7s %6s %6s %6s %8s %8s %8s\n", "mesh", "cells", "level 0", "levels", "voxels", "ratio",
                "CPU", "finest", "left vox", "left val", "active");
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--resolution") {
            resolution = std::atoi(argv[++i]);
            continue;
        }
        if (name == "--deep") {
            deep = true;
            continue;
        }
        const HexMesh mesh = load(name);
        const std::vector<std::string> fields{mesh.attributes.front().name};
        const Vec3 size = bounds(mesh).size();
        const double voxel = std::max({size.x, size.y, size.z}) / resolution;
        const auto cpu_seconds = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
        double flat_cpu = HUGE_VAL;
        const double flat = bench::seconds_of(
            [&] {
                const double start = cpu_seconds();
                (void)rasterize(mesh, fields, {.voxel_size_world = voxel});
                flat_cpu = std::min(flat_cpu, cpu_seconds() - start);
            },
            3);
        LimitCells limit;
        std::vector<VdbGrid> grids;
        const double start = cpu_seconds();
        const double search = bench::seconds_of([&] { limit = limit_for_voxels(mesh, {}, voxel); }, 1);
        const double searched = cpu_seconds();
        const double fill =
            bench::seconds_of([&] { grids = rasterize(mesh, fields, {.voxel_size_world = voxel, .limit = &limit}); }, 1);
        const double filled = cpu_seconds();
        std::printf("%-34s %8zu %7.2f %7.2f %7.2f %6.1f %6.1f %6d %8.3f %8.5f %8zu\n", name.substr(name.rfind('/') + 1).c_str(),
                    mesh.cells.size(), flat, search, fill, (search + fill) / flat, (filled - start) / flat_cpu,
                    finest_level(limit), limit.position_world / voxel, limit.value_of_range,
                    grids.front().report().active_voxels);
        std::printf("    CPU-seconds %.2f, levels %.2f, voxels %.2f; cells by level", flat_cpu, searched - start,
                    filled - searched);
        for (int level = 1; level <= finest_level(limit); ++level) {
            std::printf(" %d: %td", level, std::ranges::count(limit.cell_levels, level));
        }
        std::printf("\n");
        if (!deep) continue;
        const auto fine =
            rasterize(mesh, fields, {.voxel_size_world = voxel, .refine = {.levels = 3}, .on_limit = true, .mask = false});
        const auto [low, high] = std::ranges::minmax(mesh.attributes.front().values);
        std::size_t only_ours = 0, only_theirs = 0;
        double most = 0;
        const Box box = bounds(mesh);
        const int n = resolution + 4;
        for (int x = -4; x < n; ++x) {
            for (int y = -4; y < n; ++y) {
                for (int z = -4; z < n; ++z) {
                    const Vec3 at = voxel * (Vec3(std::floor(box.lower.x / voxel), std::floor(box.lower.y / voxel),
                                                  std::floor(box.lower.z / voxel)) +
                                             Vec3(x, y, z));
                    const auto ours = grids.front().value(at), theirs = fine.front().value(at);
                    only_ours += ours && !theirs;
                    only_theirs += theirs && !ours;
                    if (ours && theirs && high > low) most = std::max(most, std::abs(*ours - *theirs) / (high - low));
                }
            }
        }
        std::printf("    against level 3: %zu voxels more, %zu fewer, values differ by %.5f of the range\n", only_ours,
                    only_theirs, most);
    }
    std::printf("peak memory %.0f MB\n", bench::peak_bytes() / 1e6);
}
