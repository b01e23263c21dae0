#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include "subvol/refine.h"

namespace subvol {

// A function that is even and symmetric in the axes is known from its wedge i ≥ j ≥ k ≥ 0.

/// The place of a wedge's entry: i ≥ j ≥ k ≥ 0.
[[nodiscard]] constexpr std::size_t wedge_index(std::size_t i, std::size_t j, std::size_t k) {
    return i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k;
}

/// How many entries a wedge up to i = last has.
[[nodiscard]] constexpr std::size_t wedge_size(std::size_t last) {
    return wedge_index(last + 1, 0, 0);
}

/// The wedge's entry that stands for any i, j, k.
[[nodiscard]] inline std::size_t wedge_index_of(int i, int j, int k) {
    auto a = static_cast<std::size_t>(std::abs(i)), b = static_cast<std::size_t>(std::abs(j)),
         c = static_cast<std::size_t>(std::abs(k));
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    return wedge_index(a, b, c);
}

/// How many places i, j, k the wedge's entry stands for: 1 to 48.
[[nodiscard]] constexpr int wedge_multiplicity(std::size_t i, std::size_t j, std::size_t k) {
    const int orders = i == j && j == k ? 1 : i == j || j == k ? 3 : 6;
    return orders * (i > 0 ? 2 : 1) * (j > 0 ? 2 : 1) * (k > 0 ? 2 : 1);
}

/// Calls visit(i, j, k) for every entry in the wedge's order.
template <class Visit>
void each_in_wedge(std::size_t last, const Visit& visit) {
    for (std::size_t i = 0; i <= last; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            for (std::size_t k = 0; k <= j; ++k) visit(i, j, k);
        }
    }
}

/// What one control vertex of a regular mesh adds to the field: the limit of the scheme from 1 at one vertex and 0 at all
/// others, at the places (i, j, k)/2^level of the lattice.
///
/// half_width: of the support, in sample intervals of the control mesh: 3 for MCQ, 2 for Catmull-Clark and BSXW, 1 for linear
/// values:     its wedge, at wedge_index
struct BasisFunction {
    Scheme scheme = Scheme::Mcq;
    int level = 0;
    int half_width = 0;
    std::vector<double> values;

    /// The last index of the support along an axis.
    [[nodiscard]] int last() const { return half_width << level; }

    /// 0 outside the support; any signs, any order.
    [[nodiscard]] double at(int i, int j, int k) const {
        const bool inside = std::max({std::abs(i), std::abs(j), std::abs(k)}) <= last();
        return inside ? values[wedge_index_of(i, j, k)] : 0;
    }
};

/// Samples the basis function of a scheme: MCQ by its masks, without rounding at ω = 1/16 (no value needs more than 53 bits);
/// Catmull-Clark and BSXW are the tricubic B-spline, linear the trilinear hat.
///
/// level:   0 to 7
/// tension: ω of MCQ
/// throws:  Error(InvalidInput) if the level is out of range or the tension not finite
/// cost:    O(8^level): 20 ms at level 5
[[nodiscard]] BasisFunction sample_basis_function(Scheme scheme, int level, double tension = 1.0 / 16.0);

}  // namespace subvol
