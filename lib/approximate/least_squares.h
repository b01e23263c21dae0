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
// met is met to rounding.

/// weights: the roots of w_ij
struct WeightedDifferences {
    std::vector<std::array<Index, 2>> edges;
    std::vector<double> weights;
};

/// A over the weighted differences.
class LeastSquares {
public:
    LeastSquares(const LimitMatrix& limit, const WeightedDifferences& smoothing) : limit_(limit), smoothing_(smoothing) {}

    /// Steps of CGLS from x, until the gradient is 1e-14 of the first one, or no longer falls.
    ///
    /// wanted:  b
    /// returns: the number of steps, `most` at most
    [[nodiscard]] int solve(const std::vector<double>& wanted, std::vector<double>& x, int most, Progress* progress) const;

private:
    [[nodiscard]] std::vector<double> apply(const std::vector<double>& x) const;
    [[nodiscard]] std::vector<double> transposed(const std::vector<double>& values) const;

    const LimitMatrix& limit_;
    const WeightedDifferences& smoothing_;
};

}  // namespace subvol::detail
