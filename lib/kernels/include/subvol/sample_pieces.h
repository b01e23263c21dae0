// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/mesh_source.h"
#include "subvol/sample.h"

namespace subvol {

/// Kernels at the points that a piece of a mesh owns. Their bits are those that `sample_rbf_points` gives the whole mesh.
struct PieceKernels {
    RbfVolume volume;                    ///< without a boundary
    std::vector<std::uint64_t> numbers;  ///< numbers of the points in the whole mesh, ascending
    std::size_t flat_frames = 0;
};

/// Samples the points that a piece owns.
///
/// piece:   of the source, perhaps with other attributes
/// options: one interval per edge, values of the scheme
/// throws:  Error(InvalidInput) as `sample_rbf_points`, for other options, and if the pieces have too few layers of halo
[[nodiscard]] PieceKernels sample_piece(const MeshSource& source, MeshPiece piece, const SampleOptions& options = {});

/// The boundary of the whole mesh, as `sample_rbf_points` makes it.
///
/// options: as above
/// cost:    memory: some 1,500 bytes for each cell at the hull
[[nodiscard]] Surface sample_boundary(const MeshHull& hull, const SampleOptions& options = {});

/// throws: Error(InvalidInput) if the pieces have fewer layers of halo than these kernels depend on
void check_halo(const MeshSource& source, const SampleOptions& options);

}  // namespace subvol
