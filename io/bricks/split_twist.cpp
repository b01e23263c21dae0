// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "brick_file.h"
#include "brick_folder.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/twist_block.h"
#include "subvol/error.h"
#include "subvol/option.h"

// The model `twist` is a box of cells, so each brick is a smaller box: it is computed with its halo, and nothing else is.
//
//      i0 - halo    i0         i1    i1 + halo        along each axis: own cells i0 to i1, clipped at the ends of the box
//         +---------+----------+---------+

namespace subvol {

using namespace detail;

namespace {

using Three = std::array<std::size_t, 3>;

/// So many bricks along each axis that there are `count` together, each as near to a cube as can be.
Three bricks_along(std::size_t count, std::size_t cells, BrickShape shape) {
    if (shape == BrickShape::Slabs) return {1, 1, count};
    Three best{1, 1, count};
    double least = HUGE_VAL;
    // All ways to write count = a·b·c with a ≤ b ≤ c. The least sum is the most compact shape; the longest side goes along the
    // last axis, in which the numbers of cells run slowest.
    for (std::size_t a = 1; a * a * a <= count; ++a) {
        if (count % a != 0) continue;
        for (std::size_t b = a; a * b * b <= count; ++b) {
            if (count / a % b != 0) continue;
            const std::size_t c = count / a / b;
            const double surface = static_cast<double>(a) + static_cast<double>(b) + static_cast<double>(c);
            if (c <= cells && surface < least) {
                least = surface;
                best = {a, b, c};
            }
        }
    }
    return best;
}

}  // namespace

SplitResult split_twist(const std::filesystem::path& folder, int resolution, const SplitOptions& options) {
    check_options(options);
    if (resolution < 2 || resolution > 4096) {
        throw Error(ErrorCode::InvalidInput, "'" + std::to_string(resolution) + "' is not a resolution", "model:twist",
                    "2..4096");
    }
    if (options.shape == BrickShape::Random) {
        throw Error(ErrorCode::InvalidInput, "random bricks are cut from a mesh in memory only", "model:twist",
                    "blocks or slabs");
    }
    const auto n = static_cast<std::uint64_t>(resolution);
    Three along{};
    if (options.bricks > 0) {
        along = bricks_along(options.bricks, n, options.shape);
    } else if (options.shape == BrickShape::Slabs) {
        along = {1, 1, brick_count(n * n * n, options)};
    } else {
        std::size_t side = 1;
        while (side * side * side < brick_count(n * n * n, options)) ++side;
        along = {side, side, side};
    }
    if (std::ranges::max(along) > n) {
        throw Error(ErrorCode::InvalidInput, std::to_string(std::ranges::max(along)) + " bricks along a side", {},
                    "there are " + std::to_string(n) + " cells along it");
    }
    const std::size_t count = along[0] * along[1] * along[2];
    if (count > kMostBricks) {
        throw Error(ErrorCode::InvalidInput, std::to_string(count) + " bricks are too many", "model:twist",
                    "at most a million");
    }
    ByteHash id;
    id.add("model twist " + std::to_string(n) + " in " + std::to_string(along[0]) + " " + std::to_string(along[1]) + " " +
           std::to_string(along[2]));
    BricksWriter writer(folder, id.value(), options.halo_layers);
    const auto halo = static_cast<std::uint64_t>(options.halo_layers);
    for (std::size_t k = 0; k < count; ++k) {
        report_progress(options.progress, "split", k, count);
        if (writer.keeps(k)) continue;
        const Three place{k % along[0], k / along[0] % along[1], k / along[0] / along[1]};
        CellRange owned, stored;
        for (std::size_t d = 0; d < 3; ++d) {
            // Rounded down in the same way for the end of one brick and the beginning of the next, so there are neither gaps
            // nor overlaps, and lengths differ by one cell at most.
            owned.begin[d] = n * place[d] / along[d];
            owned.end[d] = n * (place[d] + 1) / along[d];
            stored.begin[d] = owned.begin[d] - std::min(owned.begin[d], halo);
            stored.end[d] = std::min(n, owned.end[d] + halo);
        }
        MeshPiece brick{
            .mesh = twist_block(n, stored), .point_numbers = {}, .cell_numbers = {}, .owned_points = {}, .owned_cells = {}};
        for (std::uint64_t z = stored.begin[2]; z <= stored.end[2]; ++z) {
            for (std::uint64_t y = stored.begin[1]; y <= stored.end[1]; ++y) {
                for (std::uint64_t x = stored.begin[0]; x <= stored.end[0]; ++x) {
                    brick.point_numbers.push_back(x + (n + 1) * (y + (n + 1) * z));
                    // The first cell at a point is the one before it on each axis, where there is one.
                    const auto first = [](std::uint64_t i) { return i == 0 ? 0 : i - 1; };
                    brick.owned_points.push_back(owned.contains({first(x), first(y), first(z)}));
                    if (x == stored.end[0] || y == stored.end[1] || z == stored.end[2]) continue;
                    brick.cell_numbers.push_back(x + n * (y + n * z));
                    brick.owned_cells.push_back(owned.contains({x, y, z}));
                }
            }
        }
        writer.write(k, brick);
    }
    report_progress(options.progress, "split", 1);
    return writer.finish();
}

}  // namespace subvol
