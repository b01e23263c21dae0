// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/sample.h"

namespace subvol::detail {

/// One kernel at each point of a part of a mesh, without a boundary: those at points that are far enough from where the part
/// ends have the bits that `sample_rbf_points` gives them in the whole mesh.
///
/// options:  as for `sample_rbf_points`: one interval per edge, values of the scheme
/// diagonal: of the bounding box of the whole mesh's control points
/// throws:   Error(InvalidInput) as `sample_rbf_points`, and for other options
[[nodiscard]] SampleResult sample_part(HexMesh part, const SampleOptions& options, double diagonal);

/// The boundary that `sample_rbf_points` gives a mesh, from the cells at its hull.
///
/// hull:    the cells of the mesh that have a point on the hull; on_hull: a flag for each of its points
/// options: as above
[[nodiscard]] Surface sample_hull(HexMesh hull, const std::vector<std::uint8_t>& on_hull, const SampleOptions& options);

/// How far into the neighbourhood these kernels look: layers of cells about the cells that have their points.
[[nodiscard]] int layers_of_samples(const SampleOptions& options);

}  // namespace subvol::detail
