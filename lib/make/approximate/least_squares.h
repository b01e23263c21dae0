// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "limit_matrix.h"
#include "subvol/progress.h"
#include "subvol/stencil_table.h"

namespace subvol::detail {

// Least squares, min |A x − b|² + |D x|², with the limit's matrix A and rows D of differences between control values (see
// differences.h). The search is that of conjugate gradients for least squares (CGLS), which works with the residual itself and
// not with that of the normal equations, so that a field that can be met is met to rounding. Each value is scaled by how much
// the samples and the differences decide it, since steps are many where some values have a hundred times as many samples near
// them as others.
//
// When to stop: it is known how much each step takes off the sum of squares, and |A (x − x*)|², which is still missing at a
// step, is the sum of what all steps after it take off [strakos2002]. The search ends when the last ten steps took off less
// than 1e-10 of the sum: at the samples the fit is then nearer to the best one than a hundred-thousandth of its error. A field
// that can be met has no error, and the search goes on until rounding.
//
// Weak differences should not keep a field from being met that can be. The search therefore begins without them, for as long as
// ten steps halve the sum of squares. The first steps find what samples decide; what they hardly decide comes last, and it is
// what the errors of samples are blown up in. A field that can be met is met in this way, to rounding.

/// A over D.
class LeastSquares {
public:
    /// differences: the rows D, the roots of their weights included; may be none
    /// first:       the differences count from the first step: somebody asked for them, or the samples leave values open
    /// support:     of each value, about the square of its column of A; may be 0
    LeastSquares(const LimitMatrix& limit, const CsrMatrix& differences, bool first, std::vector<double> support);

    /// Steps of CGLS from x, until the gradient is 1e-14 of the first one, or the sum of squares no longer falls.
    ///
    /// wanted:  b
    /// returns: the number of steps, `most` at most
    [[nodiscard]] int solve(const std::vector<double>& wanted, std::vector<double>& x, int most, Progress* progress) const;

private:
    struct Search;
    struct Found;
    [[nodiscard]] std::vector<double> apply(const std::vector<double>& x, bool with_differences) const;
    [[nodiscard]] std::vector<double> transposed(const std::vector<double>& values, bool with_differences) const;
    [[nodiscard]] Found search(const Search& how, const std::vector<double>& wanted, std::vector<double>& x,
                               Progress* progress) const;

    const LimitMatrix& limit_;
    const CsrMatrix& differences_;
    CsrMatrix transposed_;
    bool first_;
    std::vector<double> scales_;  // of the gradient's values
};

}  // namespace subvol::detail
