// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/bricks.h"
#include "subvol/limit_slice.h"

namespace subvol {

/// A slice of a mesh in bricks, as `slice_limit` of the whole. Its frame is the box of the control points, not that of the
/// limit, which is known only when all bricks have been read.
///
/// fields: changes the attributes of each brick, whose first one is sampled; none: the first of each brick
/// throws: as `slice_limit` and `read_brick`
/// cost:   as `probe_bricks`: bricks that the plane misses are not read
[[nodiscard]] LimitSlice slice_limit(const Bricks& bricks, const Vec3& point, const Vec3& normal,
                                     const SliceOptions& options = {}, const BrickFields& fields = {});

}  // namespace subvol
