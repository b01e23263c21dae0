// The twisted block into voxels: active voxels a second with 1 and 2 threads, error against the exact inverse, memory, writing.
// Arguments: voxels along the longest side, cells a side, level (its vertices on the limit; -1: the mesh as it is).
#include <tbb/global_control.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "measure.h"
#include "subvol/model.h"
#include "subvol/vdb.h"

namespace {

using namespace subvol;

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
    std::printf("error against the exact inverse: largest %.2e, RMS %.2e over %zu voxels\n", most,
                std::sqrt(squares / static_cast<double>(count)), count);
}

}  // namespace

int main(int argc, char** argv) {
    const int resolution = argc > 1 ? std::atoi(argv[1]) : 200, side = argc > 2 ? std::atoi(argv[2]) : 40;
    const int levels = argc > 3 ? std::atoi(argv[3]) : -1;
    const HexMesh mesh = make_model("twist", side);
    const std::vector<std::string> fields{"density"};
    RasterizeOptions options{.resolution = resolution};
    if (levels >= 0) {
        options.refine.levels = levels;
        options.on_limit = true;
    }
    const double before = bench::peak_bytes();
    std::vector<VdbGrid> grids;
    const auto run = [&] { grids = rasterize(mesh, fields, options); };
    for (const std::size_t threads : {2u, 1u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        run();
        if (threads == 2) {
            const GridReport& about = grids.front().report();
            const double held = bench::peak_bytes() - before, bytes = static_cast<double>(about.bytes);
            std::printf("%zu active voxels, grid %.1f MB, peak memory %.1f MB above the start: %.2f of the grid\n",
                        about.active_voxels, bytes / 1e6, held / 1e6, held / bytes);
        }
        grids.clear();
        const double seconds = bench::seconds_of(
            [&] {
                grids.clear();
                run();
            },
            resolution > 300 ? 2 : 5);
        std::printf("%zu threads: %.4f s, %.1f M voxels/s\n", threads, seconds,
                    static_cast<double>(grids.front().report().active_voxels) / seconds / 1e6);
    }
    const auto path = std::filesystem::temp_directory_path() / "subvol_vdb_speed.vdb";
    const double seconds = bench::seconds_of([&] { write_vdb(path, grids); }, 1);
    std::printf("write: %.3f s, %.1f MB\n", seconds, static_cast<double>(std::filesystem::file_size(path)) / 1e6);
    std::filesystem::remove(path);
    print_error(grids.front());
}
