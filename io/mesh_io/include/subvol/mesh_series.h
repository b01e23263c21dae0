// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol {

/// A mesh file, or a file that lists others, with its steps in the order of their times.
struct MeshSeries {
    std::filesystem::path path;
    /// One for each step, at least one; the number of the step where the file has no times. A file of one step has the time 0
    std::vector<double> times;

    [[nodiscard]] std::size_t size() const { return times.size(); }
};

/// Reads which steps a file has, and nothing of their meshes: `read_mesh(series.path, {.step = k})` does that, one at a time.
///
/// throws: as `read_mesh`
[[nodiscard]] MeshSeries open_series(const std::filesystem::path& path);

/// The step whose time is nearest to this one; of two the earlier.
[[nodiscard]] std::size_t nearest_step(const MeshSeries& series, double time);

}  // namespace subvol
