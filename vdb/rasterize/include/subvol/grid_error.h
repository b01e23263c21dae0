// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/vdb_grid.h"

namespace subvol {

struct GridErrorOptions {
    SchemeOptions scheme{};
    bool half = false;  ///< the grid will be written with 16 bits a value: the bound has their rounding
    Progress* progress = nullptr;
};

struct GridError {
    /// Grid of floats, named NAME_error, with the active voxels of the other: an upper bound of |value − limit| at each centre.
    VdbGrid grid;
    double max = 0, rms = 0;  ///< over its active voxels, in the field's unit
    /// Voxels whose centre lies outside the limit, by less than the grid's tolerance of positions or by its rounding; they are
    /// compared with the nearest place of the boundary, or if that is not within a voxel, have the field's whole range.
    std::size_t outside = 0;
};

/// How far the values of a grid are from the limit of a mesh: the limit is evaluated at the centre of every active voxel
/// (`LimitProbe`). The bound is the difference found there and what that evaluation itself may be off, an estimate: 1e-5 of
/// the field's range, and of the box's diagonal times the gradient.
///
/// field:  of the mesh, with one channel
/// throws: Error(InvalidInput) if the voxels are not floats, or as `LimitProbe`; Error(Cancelled)
/// cost:   as `LimitProbe::at` for all active voxels; memory for some million of them at a time. Parallel; the same bits for
///         any number of threads
[[nodiscard]] GridError grid_error(const VdbGrid& grid, const HexMesh& mesh, std::string_view field,
                                   const GridErrorOptions& options = {});

}  // namespace subvol
