// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"

namespace subvol {

/// The meshes of a series, each read when it is asked for. `write_series_file` reads each twice, in order: once for the ranges
/// of fields, once for the values; those that fit into 256 MB, from the first on, once.
struct MeshSteps {
    std::vector<double> times;                      ///< one for each step, ascending
    std::function<HexMesh(std::size_t step)> read;  ///< the mesh of a step, from 0
    /// Patches and sets of cells of the mesh that was read last; they stay as long as its cells. Empty: there are none
    std::function<MeshSets()> sets{};
};

struct SeriesFileOptions {
    /// Most error of each value of a field, in parts of the field's range in all steps (of vectors: of the longest side of the
    /// box of their values); [1e-12,1]
    double tolerance = 1e-3;
    /// Most distance of each coordinate from where it was, in parts of the longest side of the mesh in the first step; if not
    /// given a tenth of `tolerance`, and less where cells would be inverted
    std::optional<double> point_tolerance{};
    /// Every so many steps one does not depend on others, so that no more are decoded to read one; 1 to 1000
    int key_steps = 10;
    Progress* progress = nullptr;
};

/// max-error, max-point-error, key-steps
[[nodiscard]] std::vector<Option> options_of(SeriesFileOptions& options);

/// What was kept of an array.
struct SeriesArrayReport {
    std::string name;  ///< empty for the points
    int channels = 1;
    std::size_t steps = 0;    ///< steps that have it
    std::uint64_t bytes = 0;  ///< about how many bytes it takes in all steps
    double max = 0;           ///< the largest error of a value, in the parts that the tolerance is in
    /// Values that are kept as they are, since they are not finite or rounding would exceed the tolerance
    std::size_t exact = 0;
};

struct SeriesFileReport {
    std::size_t steps = 0;
    std::size_t key_steps = 0;
    /// How often the cells are stored: once, and once more for each step that has others than the step before
    std::size_t meshes = 0;
    std::size_t points = 0;                 ///< points of the last step as it is read
    std::size_t cells = 0;                  ///< cells of the last step as it is read
    std::vector<SeriesArrayReport> arrays;  ///< the points, then the fields in the order in which they appear
    std::uint64_t bytes = 0;
    std::uint64_t mesh_bytes = 0;           ///< bytes that the stored cells take
    std::size_t inverted_cells_before = 0;  ///< inverted cells of the last step as it was
    std::size_t inverted_cells = 0;         ///< inverted cells of the last step as it is read
};

/// The report under its members' names, with max, the largest error of all fields, and point_max; "arrays" is a list.
[[nodiscard]] Facts facts_of(const SeriesFileReport& report);

/// Writes meshes of any hexahedra as a `.svw` file of steps: cells once, and each value as a whole number of steps of its
/// quantization, less what its neighbours or the step before predict, compressed. No value is farther from what it was than
/// the tolerance; values that are not finite are kept, and so are creases, sharp faces, patches and sets of cells. `read_mesh`
/// and `open_series` read it. Points and cells keep their order.
///
/// throws: Error(InvalidInput) if there is no step, an option is out of range, times do not ascend, or a mesh has more points
///         than corners of cells; Error(Io); what `steps.read` throws
/// cost:   one step is in memory, others up to 256 MB, and the whole numbers of three; the same bits for any number of threads
SeriesFileReport write_series_file(const std::filesystem::path& path, const MeshSteps& steps,
                                   const SeriesFileOptions& options = {});

/// The same for one mesh, whose time is kept.
SeriesFileReport write_series_file(const std::filesystem::path& path, const HexMesh& mesh,
                                   const SeriesFileOptions& options = {});

}  // namespace subvol
