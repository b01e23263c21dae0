// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
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
/// options: one interval per edge, values of the scheme; the schemes MCQ and linear
/// throws:  Error(InvalidInput) as `sample_rbf_points`, for other options, and if the bricks have too few layers of halo
[[nodiscard]] BrickPoints sample_brick(const Bricks& bricks, BrickMesh brick, const SampleOptions& options = {});

/// The boundary of the whole mesh, as `sample_rbf_points` makes it.
///
/// cost: memory: some 1,500 bytes for each cell at the hull
[[nodiscard]] Surface sample_bricks_boundary(const Bricks& bricks, const SampleOptions& options = {});

/// points: how many were written; clamped, min, max: of the first channel
struct BrickPointsReport {
    std::uint64_t points = 0;
    std::size_t flat_frames = 0;
    double min = 0, max = 0;
    std::size_t triangles = 0;
};

/// Samples brick after brick and writes one binary `.ply`: the bytes are those that `write_points` writes for the whole mesh.
///
/// throws: as `sample_brick` and `write_points`
/// cost:   memory: that of one brick, and of the boundary
BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                         const BrickFields& fields);

}  // namespace subvol
