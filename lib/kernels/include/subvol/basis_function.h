// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "subvol/detail/wedge.h"
#include "subvol/scheme.h"

namespace subvol {

/// What one control vertex of a regular mesh adds to the field: the limit of the scheme for the value 1 at one vertex and 0 at
/// all others, at the places (i, j, k)/2^level of the lattice.
struct BasisFunction {
    Scheme scheme = Scheme::Mcq;
    int level = 0;
    /// Half the width of the support, in sample intervals of the control mesh: 3 for MCQ, 2 for Catmull-Clark and BSXW, 1 for
    /// linear
    int half_width = 0;
    std::vector<double> values;  ///< values of the wedge i ≥ j ≥ k ≥ 0, in the order of wedge_index

    /// The last index of the support along an axis.
    [[nodiscard]] int last() const { return half_width << level; }

    /// 0 outside the support; any signs, any order.
    [[nodiscard]] double at(int i, int j, int k) const {
        const bool inside = std::max({std::abs(i), std::abs(j), std::abs(k)}) <= last();
        return inside ? values[detail::wedge_index_of(i, j, k)] : 0;
    }
};

/// Samples the basis function of a scheme: that of MCQ by its masks, without rounding at ω = 1/16 (no value needs more than 53
/// bits); that of Catmull-Clark and BSXW is the tricubic B-spline, that of linear the trilinear hat.
///
/// level:   0 to 7
/// tension: ω of MCQ
/// throws:  Error(InvalidInput) if the level is out of range or the tension not finite
/// cost:    O(8^level): 20 ms at level 5
[[nodiscard]] BasisFunction sample_basis_function(Scheme scheme, int level, double tension = 1.0 / 16.0);

}  // namespace subvol
