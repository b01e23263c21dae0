// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol {

/// The body that the limit fills, and the one of the cells as they were given, trilinear between their corners.
struct LimitBody {
    double volume = 0, given_volume = 0;  ///< world³
    Box bounds, given_bounds;

    /// How much the limit differs from the cells: the larger of the difference of volumes, as a part of it, and that of the
    /// boxes' corners, as a part of the longest side.
    [[nodiscard]] double difference() const;
};

/// Finds it from the boundary of the first levels alone. What follows is a third of what the last one changes: of two levels
/// the volume is within 10⁻³ for a ball of eight cells, and exact where the limit has flat sides.
///
/// mesh:   valid, with its creases; scheme.crease_angle_deg is not used
/// levels: 1 or more
/// throws: Error(InvalidInput) as `refine`; Error(Cancelled)
/// cost:   parallel; with one level the cells at the boundary and the volume of each cell, in some 25 bytes a cell of a large
///         mesh; each other level makes 20 points for each point of the boundary
[[nodiscard]] LimitBody limit_body(const HexMesh& mesh, const SchemeOptions& scheme = {}, int levels = 2,
                                   Progress* progress = nullptr);

}  // namespace subvol
