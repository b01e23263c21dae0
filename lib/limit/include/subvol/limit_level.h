// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/refine.h"

namespace subvol {

/// position_world:   how far a new point may lie from the trilinear middle of its parent's points
/// value_of_range:   how far a new value may, as a part of its attribute's range
/// max_levels, max_cells: where the search ends at the latest
struct LimitLevelOptions {
    double position_world = 0;
    double value_of_range = 1e-3;
    int max_levels = 4;
    double max_cells = 3e7;
};

/// level:          the level whose trilinear cells stand for the limit
/// position_world: how far the last new points lay from the cells before; value_of_range: new values
/// converged:      both are within tolerance; otherwise the largest level came first, and is taken
struct LimitLevel {
    int level = 0;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Looks for the lowest level at which no new point and no new value of the next one lies further than the tolerances from its
/// trilinear cells. The error itself is about a third more: later levels add a quarter of the step each, where the field is
/// smooth. Of each level only the control cells are refined that had not converged before it.
///
/// options.levels is not used.
/// throws: Error(InvalidInput) as `for_each_dense_cell`
[[nodiscard]] LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options);

/// The limit as cells with 27 nodes each, triquadratic between them: they stand for the limit as well as trilinear cells of two
/// more levels do where it is smooth.
///
/// level:          the level whose trilinear cells bound the volume
/// cell_levels:    of each control cell: the level of its nodes, at least that and at least 1, the same for all if the scheme
/// does
///                 not interpolate; empty where the mesh has too many cells even for one level: they stay as they are
/// position_world: how far the last new points lay from the trilinear cells; value_of_range: new values from the curved ones
/// converged:      both are within tolerance
struct LimitCells {
    int level = 0;
    std::vector<std::uint8_t> cell_levels;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Looks for the lowest such levels: one for all cells by the tolerance of positions, so that they fit together, and one for
/// each by that of values. There, what a further level brings to the curved cells has to be within tolerance, or a quarter of
/// what their own level brought to the cells before, curved or trilinear: where the field is smooth, no more is left (up to
/// three times as much at its kinks).
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
