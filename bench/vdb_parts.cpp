// SPDX-License-Identifier: Apache-2.0
// A grid made in parts compared with the same grid made in one piece, voxel by voxel: the pawn.
// Arguments: voxels along the longest side (800), memory of a part in MB (64).
#include <bit>
#include <cstdio>
#include <cstdlib>

#include "measure.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace {

using namespace subvol;

/// The contents of a grid, in the order of its voxels along x: parts that follow each other in x add up to the whole.
struct Contents {
    std::uint64_t hash = 0xcbf29ce484222325u;
    std::size_t voxels = 0, leaves = 0;

    void add(std::uint64_t number) { hash = (hash ^ number) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29; }

    /// Layers of leaves, one after the other; each leaf counts with its place and its active voxels.
    void add(const VdbGrid& grid) {
        if (grid.report().active_voxels == 0) return;
        const auto all = grid.voxels();
        const auto cursor = all->cursor();
        const auto [lower, upper] = all->range();
        for (int x = lower[0] & ~7; x <= upper[0]; x += 8) {
            for (int y = lower[1] & ~7; y <= upper[1]; y += 8) {
                for (int z = lower[2] & ~7; z <= upper[2]; z += 8) {
                    if (cursor->block({x, y, z}).kind != VoxelBlock::Kind::Nothing) add_leaf(*cursor, {x, y, z});
                }
            }
        }
    }

private:
    void add_leaf(VoxelCursor& cursor, const Voxel& origin) {
        ++leaves;
        for (const int x : origin) add(static_cast<std::uint32_t>(x));
        for (int i = 0; i < 512; ++i) {
            const VoxelCorners at = cursor.corners({origin[0] + i / 64, origin[1] + i / 8 % 8, origin[2] + i % 8});
            if (!(at.active & 1)) continue;
            ++voxels;
            add(static_cast<std::uint64_t>(i));
            add(std::bit_cast<std::uint64_t>(at.values[0]));
        }
    }
};

}  // namespace

int main(int argc, char** argv) {
    const int resolution = argc > 1 ? std::atoi(argv[1]) : 800;
    const std::size_t memory = (argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 64) << 20;
    const HexMesh mesh = make_model("pawn");
    const std::vector<std::string> fields{mesh.attributes.front().name};
    const RasterizeOptions options{.resolution = resolution, .refine = {.levels = 2}};
    Contents parts, whole;
    int count = 0;
    rasterize_parts(mesh, fields, options, memory, [&](const GridPart& part) {
        parts.add(part.grids.front());
        count = part.of;
    });
    const double of_parts = bench::peak_bytes();
    whole.add(rasterize(mesh, fields, options).front());
    std::printf("%d parts: %zu voxels in %zu leaves, hash %016lx, peak memory %.0f MB\n", count, parts.voxels, parts.leaves,
                parts.hash, of_parts / 1e6);
    std::printf("one piece: %zu voxels in %zu leaves, hash %016lx, peak memory %.0f MB\n", whole.voxels, whole.leaves,
                whole.hash, bench::peak_bytes() / 1e6);
    const bool same = parts.hash == whole.hash && parts.voxels == whole.voxels && parts.leaves == whole.leaves;
    std::printf("%s\n", same ? "identical" : "DIFFERENT");
    return same ? 0 : 1;
}
