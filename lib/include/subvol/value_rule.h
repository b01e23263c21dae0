#pragma once

#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/kernel.h"

namespace subvol {

/// Where the value of a sample between control points comes from.
///
/// Scheme: the subdivision scheme itself
/// Cubic:  Catmull-Rom in the cell's parameters over the 4×4×4 control points about it
/// Paper:  Σ w f / Σ w over the control points within a kernel's extent, in the cell's parameters [mnmq2007]
///
/// Where the surroundings are no grid, `Cubic` extrapolates the points that are missing and `Paper` does without them.
enum class ValueRule { Scheme, Cubic, Paper };

/// What a rule makes of the first refinement's new points: the error of a rule is its difference from the scheme there.
///
/// attribute: of `mesh`, one channel
/// kernel:    of the rule `Paper`
/// returns:   a value for each point that `refine` adds to those of the mesh, in its order
/// throws:    Error(InvalidInput) as `refine`, or if the attribute has several channels
[[nodiscard]] std::vector<double> values_at_new_points(const HexMesh& mesh, const Attribute& attribute, ValueRule rule,
                                                       const Kernel& kernel);

}  // namespace subvol
