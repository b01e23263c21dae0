// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/bricks.h"
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

}  // namespace subvol
