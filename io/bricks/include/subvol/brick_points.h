// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "subvol/sample_pieces.h"

namespace subvol {

struct BrickPointsReport {
    std::uint64_t points = 0;     ///< how many were written
    std::size_t flat_frames = 0;  ///< of these points, those whose cells are flat
    double min = 0, max = 0;      ///< range of the first channel
    std::size_t triangles = 0;    ///< triangles of the boundary
};

/// Some of the pieces, as one share of the work.
struct BrickShare {
    /// Numbers of the pieces, from `begin` to before `end`; the share that begins at 0 has the boundary
    std::size_t begin = 0, end = 0;
    std::string note;  ///< note of the share's file, for `read_points_note`
};

/// Samples piece after piece and writes one binary `.ply`, or a `.svk` if the path ends so: the bytes are those that
/// `write_points` and `write_kernel_file` write for the whole mesh.
///
/// share:  null, or what is written: a part, whose points have their numbers in the whole; as `.ply` only
/// throws: as `sample_piece`, `write_points` and `write_kernel_file`
/// cost:   memory: that of one piece, and of the boundary; of a `.svk` also 16 bytes a point, and 90 on disk until it is done
BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const MeshSource& source,
                                         const SampleOptions& options, const BrickShare* share = nullptr);

/// Writes the file that `write_points_of_bricks` writes without shares, from the parts of all shares. One part at a time is in
/// memory.
///
/// parts:   in the order of the shares
/// returns: points and triangles
/// throws:  Error(InvalidInput) if a part is malformed, or a point occurs twice or is missing; Error(Io)
BrickPointsReport join_points_of_bricks(const std::filesystem::path& path, std::span<const std::filesystem::path> parts,
                                        std::uint64_t points, Progress* progress = nullptr);

}  // namespace subvol
