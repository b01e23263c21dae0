// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/split.h"

namespace subvol::detail {

inline constexpr std::size_t kMostBricks = 1'000'000;

/// A folder of bricks that is being written: beside its place, under NAME.unfinished. What an interrupted run has finished is
/// kept if it was cut from the same mesh in the same way.
class BricksWriter {
public:
    /// id: of the mesh and of how it is cut
    ///
    /// throws: Error(InvalidInput) if `folder` exists and is no folder of bricks; Error(Io)
    BricksWriter(std::filesystem::path folder, std::uint64_t id, int halo_layers);

    /// Whether brick k need not be made again.
    bool keeps(std::size_t k);

    void write(std::size_t k, const BrickMesh& brick);

    /// Writes the index and puts the folder in its place.
    SplitResult finish();

private:
    void save_progress();

    std::filesystem::path folder_, work_;
    Bricks done_;            // in the order in which they were finished
    std::size_t saved_ = 0;  // bricks, when the progress was written last
    SplitResult result_;
};

/// throws: Error(InvalidInput) if `folder` exists and is no folder of bricks; Error(Io) if it has no place
void check_target(const std::filesystem::path& folder);

/// throws: Error(InvalidInput) for options out of range
void check_options(const SplitOptions& options);

/// How many bricks there are to be for so many cells.
[[nodiscard]] std::size_t brick_count(std::uint64_t cells, const SplitOptions& options);

}  // namespace subvol::detail
