// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/split.h"

namespace subvol::detail {

inline constexpr std::size_t kMostBricks = 1'000'000;

/// A folder of bricks that is being written: beside its place, under NAME.unfinished. What an interrupted run has finished is
/// kept if it was cut from the same mesh in the same way.
///
/// Nothing is removed but files that an index or a progress of ours lists, bricks of the same mesh, and temporary files of
/// ours. Where there is anything else, nothing is removed at all.
class BricksWriter {
public:
    /// id: of the mesh and of how it is cut
    ///
    /// folder: may be a link to a folder, which stays a link
    ///
    /// throws: Error(InvalidInput) if `folder` or NAME.unfinished exists and holds anything else than bricks; Error(Io)
    BricksWriter(std::filesystem::path folder, std::uint64_t id, int halo_layers);

    /// Whether brick k need not be made again.
    bool keeps(std::size_t k);

    void write(std::size_t k, const MeshPiece& brick);

    /// Writes the index and puts the folder in its place.
    SplitResult finish();

private:
    void take_up(std::uint64_t id, int halo_layers);
    void save_progress();

    std::filesystem::path folder_, place_, work_;  // as it was named, without links, and where it is made
    Bricks done_;                                  // in the order in which they were finished
    std::size_t saved_ = 0;                        // bricks, when the progress was written last
    SplitResult result_;
};

/// throws: Error(InvalidInput) if `folder` exists and holds anything else than bricks; Error(Io) if it has no place
void check_target(const std::filesystem::path& folder);

/// throws: Error(InvalidInput) for options out of range
void check_options(const SplitOptions& options);

/// How many bricks there are to be for so many cells.
[[nodiscard]] std::size_t brick_count(std::uint64_t cells, const SplitOptions& options);

}  // namespace subvol::detail
