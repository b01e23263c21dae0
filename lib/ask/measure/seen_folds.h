// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/measure.h"

namespace subvol::detail {

/// Samples cells whose pieces have a negative determinant somewhere: pieces are near the limit, but they are not the limit.
///
/// cells:   in any order, several times or once; those that are inverted in the control mesh do not count. At most 1,000 of
///          them are sampled, so that the cost has an end
/// returns: those of them whose limit folds, of which the first is the one with the smallest number
/// cost:    nothing without cells; else a copy of what is around them, and about 1 ms a cell, parallel
[[nodiscard]] SeenFolds seen_folds(const HexMesh& mesh, std::vector<Index> cells, const SchemeOptions& scheme,
                                   Progress* progress);

}  // namespace subvol::detail
