#pragma once

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

}  // namespace subvol
