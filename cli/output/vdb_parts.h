// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/vdb_grid.h"
#include "vdb_output.h"

namespace subvol::cli {

/// Grids that are made part by part: NAME.vdb if all of them fit into the memory, else NAME_0000.vdb and so on, and NAME.json,
/// which lists them. With --memory there always is a list, so that scripts find the file or the files. If one
/// of these files cannot be written, none appears.
class VdbParts {
public:
    /// memory_bytes: what the grids may take together
    ///
    /// throws: Error(InvalidInput) if NAME.json exists, is not such a list, and a list has to be written
    VdbParts(const VdbOutput& output, std::uint64_t memory_bytes);

    /// Writes the part with a number.
    ///
    /// throws: as the constructor, as soon as the grids do not fit into the memory
    /// more: for the list, beside the file's name, its active voxels and their bounds
    void write(std::span<const VdbGrid> grids, std::size_t number, const Json& more = Json::object());

    [[nodiscard]] std::size_t count() const { return list_.size(); }
    [[nodiscard]] std::uint64_t active_voxels() const { return active_voxels_; }

    /// Gives the files their names, which are facts.
    ///
    /// throws: Error(InvalidInput) if there are files with the names of parts or of the list that are not of an earlier run
    [[nodiscard]] Facts finish(const std::string& input, double voxel_size_world, Progress* progress);

private:
    [[nodiscard]] bool always_listed() const { return output_.memory_bytes > 0; }
    [[nodiscard]] std::vector<VdbGrid> joined() const;
    void warn(bool whole, Facts& facts) const;
    [[nodiscard]] Json earlier_parts() const;
    void check_names() const;

    const VdbOutput& output_;
    std::filesystem::path list_file_;
    std::optional<std::set<std::string>> earlier_;  // parts of earlier runs; nothing if NAME.json is another file
    std::uint64_t memory_bytes_;
    std::deque<detail::AtomicFile> files_;
    Json list_ = Json::array();
    std::uint64_t active_voxels_ = 0, bytes_ = 0;
};

}  // namespace subvol::cli
