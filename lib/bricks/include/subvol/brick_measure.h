// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/bricks.h"
#include "subvol/measure.h"

namespace subvol {

/// Integrals, means, extremes and histograms of the limit of a mesh in bricks, as `measure_limit` of the whole to its
/// tolerance. Sums are those of the bricks in their order.
///
/// The cells of extremes have their numbers in the whole mesh; kNone if an Index cannot hold them.
///
/// options: without groups
/// fields:  changes the attributes of each brick; none: they stay
/// throws:  as `measure_limit` and `read_brick`; Error(InvalidInput) if the bricks have fewer than three layers of halo
/// cost:    each brick is read and cut into pieces twice; memory: that of `measure_limit` for a brick
[[nodiscard]] LimitMeasure measure_limit(const Bricks& bricks, const MeasureOptions& options = {},
                                         const BrickFields& fields = {});

}  // namespace subvol
