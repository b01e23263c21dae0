// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hull_levels.h"
#include "settled_cut.h"

namespace subvol::detail {

/// The boundary of the limit as triangles on it: two for each leaf, or a fan where finer neighbours have divided its sides.
///
/// The normals at points are those of the vertices about them, of the next level too where it has been computed. There are no
/// fields.
///
/// topology: that the leaves were made with
[[nodiscard]] SettledCut hull_cut(const HullLeaves& hull, const Topology& topology, int max_level);

/// The triangles in a range of the cells of a surface, and their points.
[[nodiscard]] SettledCut part_of(const SettledCut& whole, const ShareRange& range);

}  // namespace subvol::detail
