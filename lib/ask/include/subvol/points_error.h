// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/scheme.h"

namespace subvol {

struct PointsErrorOptions {
    SchemeOptions scheme{};
    std::size_t channel = 0;  ///< channel of the points, which is compared with the mesh's field
    Progress* progress = nullptr;
};

struct PointsError {
    /// For each kernel the largest |sum of kernels − limit| of the places where it was compared, in the field's unit
    std::vector<double> of_points;
    double max = 0, rms = 0;  ///< over all of these places
    std::size_t places = 0;   ///< how many places lay inside the limit
    std::size_t gaps = 0;     ///< of these, places where kernels have no value (they are left out)
};

/// How far the field of kernels (`RbfField`) is from the limit of a mesh, about each kernel: an estimate. They are compared at
/// the kernel's centre and halfway to its neighbours' along the diagonals of its frame, where the sum of kernels is the
/// farthest from any centre. Between these places the error can be larger.
///
/// field:  of the mesh, with one channel
/// throws: Error(InvalidInput) as `RbfField` and `LimitProbe`, if there is no such channel; Error(Cancelled)
/// cost:   as `LimitProbe::at` for nine places a kernel. Parallel; the same bits for any number of threads
[[nodiscard]] PointsError points_error(const RbfVolume& points, const HexMesh& mesh, std::string_view field,
                                       const PointsErrorOptions& options = {});

/// The errors as one more channel of the points, NAME_error.
[[nodiscard]] RbfChannel error_channel(const PointsError& error, std::string_view name);

}  // namespace subvol
