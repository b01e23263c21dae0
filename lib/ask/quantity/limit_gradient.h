// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// The derivatives of an attribute's limit by places, at the mesh's points: for each channel the three by x, y, z.
///
/// Where cells meet at a point, their derivatives are the same if the limit is smooth there; else their mean counts, weighted
/// by volume. The scheme is MCQ, whose limit goes through the points. Where more is known of the gradient on the boundary
/// (`Attribute::walls`), points there have that.
///
/// throws: Error(InvalidInput) as `evaluate_limit`; Error(Cancelled)
[[nodiscard]] Attribute limit_gradient(const HexMesh& mesh, const Attribute& attribute, Progress* progress);

}  // namespace subvol::detail
