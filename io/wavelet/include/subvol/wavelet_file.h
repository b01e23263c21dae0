// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol {

struct WaveletFileOptions {
    SchemeOptions scheme{};
    /// Most root mean square error of each field, in parts of its range (of vectors: of the box of their values); [1e-15,1]
    double tolerance = 1e-3;
    /// Most root mean square distance of the points from where they were, in parts of the mesh's longest side; if not given a
    /// tenth of `tolerance`, and less where cells would be inverted
    std::optional<double> point_tolerance{};
    int levels = 6;  ///< the most levels of wavelets, 1 to 10
    Progress* progress = nullptr;
};

/// wavelet-tolerance and wavelet-point-tolerance, which Python calls tolerance and point_tolerance, and levels
[[nodiscard]] std::vector<Option> options_of(WaveletFileOptions& options);

/// What was kept of an array.
struct WaveletArrayReport {
    std::string name;  ///< empty for the points
    std::size_t coefficients = 0;
    std::size_t kept = 0;
    double rms = 0;  ///< in the parts that the tolerance is in
    double max = 0;  ///< in the parts that the tolerance is in
};

struct WaveletFileReport {
    int levels = 0;
    std::size_t coarse_cells = 0;
    std::size_t cells = 0;
    std::size_t added_cells = 0;             ///< cells with which a grid was filled up; they are not in the mesh that is read
    std::vector<WaveletArrayReport> arrays;  ///< the points, then the fields
    std::uint64_t bytes = 0;
    std::size_t inverted_cells_before = 0;
    std::size_t inverted_cells = 0;  ///< inverted cells of the mesh that is read, as `inspect` counts them
};

/// Writes a mesh as control values and wavelet details (`.svw`), rounded as far as the tolerance allows. `read_mesh` reads it.
/// Points and cells are then in the order of `refine`.
///
/// throws: Error(InvalidInput) as `find_hierarchy`: the mesh must be the refinement of a coarser one, or a structured grid; if
///         a tolerance is not in (0,1]; Error(Io)
/// cost:   about 15 analyses and syntheses of each field
WaveletFileReport write_wavelet_file(const std::filesystem::path& path, const HexMesh& mesh,
                                     const WaveletFileOptions& options = {});

}  // namespace subvol
