// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "subvol/bricks.h"
#include "subvol/sample.h"

namespace subvol {

/// Kernels at the points that a brick owns. Their bits are those that `sample_rbf_points` gives the whole mesh.
///
/// volume:  without a boundary
/// numbers: of the points in the whole mesh, ascending
struct BrickPoints {
    RbfVolume volume;
    std::vector<std::uint64_t> numbers;
    std::size_t flat_frames = 0;
};

/// Samples the points that a brick owns.
///
/// brick:   as `read_brick` returns it, perhaps with other attributes
/// options: one interval per edge, values of the scheme
/// throws:  Error(InvalidInput) as `sample_rbf_points`, for other options, and if the bricks have too few layers of halo
[[nodiscard]] BrickPoints sample_brick(const Bricks& bricks, MeshPiece brick, const SampleOptions& options = {});

/// The boundary of the whole mesh, as `sample_rbf_points` makes it.
///
/// cost: memory: some 1,500 bytes for each cell at the hull
[[nodiscard]] Surface sample_bricks_boundary(const Bricks& bricks, const SampleOptions& options = {});
[[nodiscard]] Surface sample_bricks_boundary(const BrickHull& hull, const SampleOptions& options = {});

/// points:      how many were written; flat_frames: of them, those whose cells are flat
/// min, max:    of the first channel; triangles: of the boundary
struct BrickPointsReport {
    std::uint64_t points = 0;
    std::size_t flat_frames = 0;
    double min = 0, max = 0;
    std::size_t triangles = 0;
};

/// Some of the bricks, as one share of the work.
///
/// begin, end: their numbers, from `begin` to before `end`; the share that begins at 0 has the boundary
/// note:       of the share's file, for `read_points_note`
struct BrickShare {
    std::size_t begin = 0, end = 0;
    std::string note;
};

/// Samples brick after brick and writes one binary `.ply`, or a `.svk` if the path ends so: the bytes are those that
/// `write_points` and `write_kernel_file` write for the whole mesh.
///
/// share:  null, or what is written: a part, whose points have their numbers in the whole; as `.ply` only
/// throws: as `sample_brick`, `write_points` and `write_kernel_file`
/// cost:   memory: that of one brick, and of the boundary; of a `.svk` also 16 bytes a point, and 90 on disk until it is done
BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                         const BrickFields& fields, const BrickShare* share = nullptr);

/// Writes the file that `write_points_of_bricks` writes without shares, from the parts of all shares. One part at a time is in
/// memory.
///
/// parts:   in the order of the shares
/// returns: points and triangles
/// throws:  Error(InvalidInput) if a part is malformed, or a point occurs twice or is missing; Error(Io)
BrickPointsReport join_points_of_bricks(const std::filesystem::path& path, std::span<const std::filesystem::path> parts,
                                        std::uint64_t points, Progress* progress = nullptr);

}  // namespace subvol
