// SPDX-License-Identifier: Apache-2.0
// The twisted block into voxels, by resolution: seconds with 2 and 1 threads, memory, speed as a fraction of a plain copy's,
// writing, error against the exact inverse. Every resolution runs in its own process, so that its peak memory can be measured.
//
//   vdb_speed [-n cells a side = 40] [-l level = none] [voxels along the longest side = 200 400 800…]
//
// level: of the refined mesh, its vertices on the limit; -l limit: the curved cells that approximate the limit; none: the
// control mesh.
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "measure.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace {

using namespace subvol;

constexpr std::size_t kThreads = 2;
constexpr int kAsItIs = -1, kLimit = -2;
constexpr int kFine = 300;  // voxels from which on a run takes long

/// Every voxel of a grid as `visit(centre, value)`.
template <class Visit>
void for_each_voxel(const VdbGrid& grid, const Visit& visit) {
    const double h = grid.report().voxel_size_world;
    const auto voxels = grid.voxels();
    const auto cursor = voxels->cursor();
    const auto [lower, upper] = voxels->range();
    for (int x = lower[0]; x <= upper[0]; ++x) {
        for (int y = lower[1]; y <= upper[1]; ++y) {
            for (int z = lower[2]; z <= upper[2]; ++z) {
                const VoxelCorners corners = cursor->corners({x, y, z});
                if (corners.active & 1) visit(h * Vec3(x, y, z), corners.values[0]);
            }
        }
    }
}

void print_error(const VdbGrid& grid) {
    double most = 0, squares = 0;
    std::size_t count = 0;
    for_each_voxel(grid, [&](const Vec3& x, double value) {
        const double error = std::abs(value - TwistField::density(TwistField::parameter(x)));
        most = std::max(most, error);
        squares += error * error;
        ++count;
    });
    std::printf("  error against the exact inverse: largest %.2e, RMS %.2e\n", most,
                std::sqrt(squares / static_cast<double>(count)));
}

/// Seconds to copy this many bytes in memory, with all threads.
double seconds_of_copy(std::size_t bytes) {
    constexpr std::size_t kPiece = 1 << 18;
    const std::vector<char> from(bytes, 1);
    std::vector<char> to(bytes, 2);
    return bench::seconds_of(
        [&] {
            tbb::parallel_for(std::size_t{0}, (bytes + kPiece - 1) / kPiece, [&](std::size_t p) {
                std::memcpy(&to[p * kPiece], &from[p * kPiece], std::min(kPiece, bytes - p * kPiece));
            });
        },
        5);
}

void print_writing(std::span<const VdbGrid> grids) {
    const auto path = std::filesystem::temp_directory_path() / ("subvol_vdb_speed" + std::to_string(getpid()) + ".vdb");
    const double seconds = bench::seconds_of([&] { write_vdb(path, grids); }, 1);
    std::printf("  write: %.3f s, %.1f MB\n", seconds, static_cast<double>(std::filesystem::file_size(path)) / 1e6);
    std::filesystem::remove(path);
}

LimitCells limit_cells(const HexMesh& mesh, int resolution) {
    const Vec3 size = bounds(mesh).size();
    const double voxel_size = std::max({size.x, size.y, size.z}) / resolution;
    LimitCells limit;
    const double seconds = bench::seconds_of([&] { limit = limit_for_voxels(mesh, {}, voxel_size); }, 1);
    std::printf("  limit: level %d%s, found in %.3f s; control cells with nodes of level", limit.level,
                limit.converged ? "" : " (not converged)", seconds);
    for (int level = 1; level <= 5; ++level) {
        std::printf(" %d: %td", level, std::ranges::count(limit.cell_levels, level));
    }
    std::printf("\n");
    return limit;
}

void measure(int resolution, int side, int level) {
    std::printf("%d voxels along the longest side, %d^3 cells\n", resolution, side);
    const HexMesh mesh = make_model("twist", side);
    const std::vector<std::string> fields{"density"};
    RasterizeOptions options{.resolution = resolution};
    const tbb::global_control both(tbb::global_control::max_allowed_parallelism, kThreads);
    const double before = bench::peak_bytes();
    LimitCells limit;
    if (level == kLimit) {
        limit = limit_cells(mesh, resolution);
        options.limit = &limit;
    } else if (level >= 0) {
        options.refine.levels = level;
        options.on_limit = true;
    }
    std::vector<VdbGrid> grids;
    const auto run = [&] {
        grids.clear();
        grids = rasterize(mesh, fields, options);
    };
    const double first = bench::seconds_of(run, 1);
    const GridReport about = grids.front().report();
    const double held = bench::peak_bytes() - before, bytes = static_cast<double>(about.bytes);
    const double voxels = static_cast<double>(about.active_voxels) / 1e6;
    std::printf("  %.3f M active voxels, grid %.1f MB, peak memory %.1f MB above the start: %.2f of the grid\n", voxels,
                bytes / 1e6, held / 1e6, held / bytes);
    const int repeats = first > 2 ? 1 : resolution > kFine ? 4 : 30;
    const double seconds = std::min(first, bench::seconds_of(run, repeats));
    const double copy = seconds_of_copy(about.bytes);
    std::printf(
        "  %zu threads: %.4f s, %.1f M voxels/s, first run %.4f s; copying as many bytes: %.4f s (%.1f GB/s), %.3f of it\n",
        kThreads, seconds, voxels / seconds, first, copy, bytes / copy / 1e9, copy / seconds);
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        const double alone = bench::seconds_of(run, repeats);
        std::printf("  1 thread: %.4f s, %.1f M voxels/s\n", alone, voxels / alone);
    }
    print_writing(grids);
    if (resolution <= kFine) print_error(grids.front());
}

/// Runs in its own process. returns: whether it succeeded
bool measure_apart(int resolution, int side, int level) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        measure(resolution, side, level);
        std::fflush(stdout);
        _exit(0);
    }
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

int main(int argc, char** argv) {
    int side = 40, level = kAsItIs;
    for (int option; (option = getopt(argc, argv, "n:l:")) != -1;) {
        if (option == 'n') {
            side = std::atoi(optarg);
        } else if (option == 'l') {
            level = std::string(optarg) == "limit" ? kLimit : std::atoi(optarg);
        } else {
            return 2;
        }
    }
    std::vector<int> resolutions;
    for (int i = optind; i < argc; ++i) resolutions.push_back(std::atoi(argv[i]));
    if (resolutions.empty()) resolutions = {200, 400, 800};
    bool good = true;
    for (const int resolution : resolutions) good = measure_apart(resolution, side, level) && good;
    return good ? 0 : 1;
}
