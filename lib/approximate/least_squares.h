// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "limit_matrix.h"
#include "subvol/progress.h"

namespace subvol::detail {

// Least squares, min |A x − b|² + Σ w_ij (x_i − x_j)², with the limit's matrix A and differences along edges, which have a
// weight where smoothing is asked for or a sample hardly decides a value. The search is that of conjugate gradients for least
// squares (CGLS), which works with the residual itself and not with that of the normal equations, so that a field that can be
// met is met to rounding. Each value is scaled by how much the samples and the differences decide it, since steps are many
// where some values have a hundred times as many samples near them as others.
//
// When to stop: it is known how much each step takes off the sum of squares, and |A (x − x*)|², which is still missing at a
// step, is the sum of what all steps after it take off [strakos2002]. The search ends when the last ten steps took off less
// than 1e-10 of the sum: at the samples the fit is then nearer to the best one than a hundred-thousandth of its error. A field
// that can be met has no error, and the search goes on until rounding.

/// weights: the roots of w_ij
struct WeightedDifferences {
    std::vector<std::array<Index, 2>> edges;
    std::vector<double> weights;
};

/// A over the weighted differences.
class LeastSquares {
public:
    /// support: of each value, about the square of its column of A; may be 0
    LeastSquares(const LimitMatrix& limit, const WeightedDifferences& smoothing, std::vector<double> support);

    /// Steps of CGLS from x, until the gradient is 1e-14 of the first one, or the sum of squares no longer falls.
    ///
    /// wanted:  b
    /// returns: the number of steps, `most` at most
    [[nodiscard]] int solve(const std::vector<double>& wanted, std::vector<double>& x, int most, Progress* progress) const;

private:
    [[nodiscard]] std::vector<double> apply(const std::vector<double>& x) const;
    [[nodiscard]] std::vector<double> transposed(const std::vector<double>& values) const;

    const LimitMatrix& limit_;
    const WeightedDifferences& smoothing_;
    std::vector<double> scales_;  // of the gradient's values
};

}  // namespace subvol::detail
