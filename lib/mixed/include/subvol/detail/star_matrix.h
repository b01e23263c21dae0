// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/refine_mixed.h"

namespace subvol::detail {

/// The refinement of the cells at one point: the new points around it as weights of the old ones, which correspond to each
/// other.
///
/// points:  of the cells at the point; the first is the point itself
/// weights: row r are those of the new point that corresponds to points[r], row-major
struct StarMatrix {
    std::vector<Index> points;
    std::vector<double> weights;
};
[[nodiscard]] StarMatrix star_matrix(const MixedMesh& mesh, TetScheme scheme, Index point);

}  // namespace subvol::detail
