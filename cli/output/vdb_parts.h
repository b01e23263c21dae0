// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <string>

#include "report.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/vdb_grid.h"
#include "vdb_output.h"

namespace subvol::cli {

/// Grids in several files, NAME_0000.vdb and so on, and NAME.json that lists them. All of these files appear, or none.
class VdbParts {
public:
    explicit VdbParts(const VdbOutput& output) : output_(output) {}

    /// Writes the file with a number.
    ///
    /// more: for the list, beside the file's name, its active voxels and their bounds
    void write(std::span<const VdbGrid> grids, std::size_t number, const Json& more = Json::object());

    [[nodiscard]] std::size_t count() const { return list_.size(); }
    [[nodiscard]] std::uint64_t active_voxels() const { return active_voxels_; }

    /// Writes the list; then all files have their names. Returns the list's.
    std::string finish(const std::string& input, double voxel_size_world);

private:
    const VdbOutput& output_;
    std::deque<detail::AtomicFile> files_;
    Json list_ = Json::array();
    std::uint64_t active_voxels_ = 0;
};

}  // namespace subvol::cli
