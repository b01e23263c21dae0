// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

// Named views show kernels as they show the mesh that these were sampled from. A mesh is framed by its control points; there is
// a kernel at each of them, so the centres frame the kernels. The boundary bulges a little beyond them. Kernels elsewhere, as
// those that `reduce` places, do not reach to the boundary, which frames them then.

/// The box that views and opacity units refer to: of the centres, if they reach to the boundary within a hundredth; else
/// `volume.bounds`.
[[nodiscard]] Box frame_of(const RbfVolume& volume);

/// What a camera is fitted to where the whole surface is seen: the centres, or the boundary's points. Empty without a boundary.
[[nodiscard]] std::vector<Vec3> outline_of(const RbfVolume& volume);

}  // namespace subvol::detail
