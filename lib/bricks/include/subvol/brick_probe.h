// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/bricks.h"
#include "subvol/limit_slice.h"
#include "subvol/probe.h"

namespace subvol {

/// Values and gradients of the limit at places, as `LimitProbe::at`; each brick is read once, if a place may lie in it. Where
/// cells meet, the one with the smallest number is found.
///
/// fields: changes the attributes of each brick; none: all are taken
/// throws: as `read_brick` and `LimitProbe`; Error(Cancelled)
/// cost:   memory: one brick, and the cells about the places in it
[[nodiscard]] ProbeResult probe_bricks(const Bricks& bricks, std::span<const Vec3> places, const ProbeOptions& options = {},
                                       const BrickFields& fields = {}, Progress* progress = nullptr);

/// A slice of a mesh in bricks, as `slice_limit` of the whole. Its frame is the box of the control points, not that of the
/// limit, which is known only when all bricks have been read.
///
/// fields: changes the attributes of each brick, whose first one is sampled; none: the first of each brick
/// throws: as `slice_limit` and `read_brick`
/// cost:   as `probe_bricks`: bricks that the plane misses are not read
[[nodiscard]] LimitSlice slice_limit(const Bricks& bricks, const Vec3& point, const Vec3& normal,
                                     const SliceOptions& options = {}, const BrickFields& fields = {});

}  // namespace subvol
