// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/refine.h"

namespace subvol {

/// position_world:        how far a new point may lie from the mean of the parent's points around it
/// value_of_range:        the same for a new value, as a part of its attribute's range
/// max_levels, max_cells: the search goes no further
struct LimitLevelOptions {
    double position_world = 0;
    double value_of_range = 1e-3;
    int max_levels = 4;
    double max_cells = 3e7;
};

/// level:          the level whose trilinear cells approximate the limit
/// position_world: how far the last new points lay from the cells of the level before
/// value_of_range: the same for values
/// converged:      both are within tolerance; otherwise `level` is the finest one within max_levels and max_cells
struct LimitLevel {
    int level = 0;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Finds the lowest level for which all new points and values of the next level lie within the tolerances of its trilinear
/// cells. The error to the limit is about a third more: where the field is smooth, each further level adds a quarter of the
/// step before. At each level only the control cells that have not converged yet are refined.
///
/// options.levels is not used.
/// throws: Error(InvalidInput) as `for_each_dense_cell`
[[nodiscard]] LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options);

/// The limit as cells of 27 nodes, triquadratic between them. Where the limit is smooth they approximate it as well as
/// trilinear cells of two more levels.
///
/// level:          the level whose trilinear cells bound the volume
/// cell_levels:    the level of each control cell's nodes: at least `level` and at least 1; the same for all cells if the
///                 scheme does not interpolate. Empty if the mesh has too many cells for one level: they stay as they are
/// position_world: how far the last new points lay from the trilinear cells
/// value_of_range: how far the last new values lay from the curved cells
/// converged:      both are within tolerance
struct LimitCells {
    int level = 0;
    std::vector<std::uint8_t> cell_levels;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Finds the lowest such levels: by the tolerance of positions one for all cells, so that they fit together, and by the
/// tolerance of values one for each cell. A cell's level is enough if the new values of the next level lie within tolerance of
/// its curved cells, or if a quarter of the distance of its own new values from the cells before, curved or trilinear, does:
/// where the field is smooth, no more is left (up to three times as much at its kinks).
///
/// options.levels is not used.
/// throws: Error(InvalidInput) as `for_each_dense_cell`
[[nodiscard]] LimitCells find_limit_cells(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options);

/// The tolerance of positions where the limit is sampled at voxels.
inline constexpr double kLimitTolerance_voxels = 0.1;

/// `find_limit_cells` for a grid with voxels of this size: positions within kLimitTolerance_voxels, values within the default
/// tolerance.
[[nodiscard]] LimitCells limit_for_voxels(const HexMesh& mesh, const RefineOptions& refinement, double voxel_world);

}  // namespace subvol
