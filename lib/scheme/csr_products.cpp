// SPDX-License-Identifier: Apache-2.0
#include "csr_products.h"

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

CsrMatrix transpose_of(const CsrMatrix& matrix, std::size_t columns) {
    CsrMatrix made;
    made.offsets.assign(columns + 1, 0);
    for (const Index column : matrix.columns) ++made.offsets[column + 1];
    for (std::size_t c = 0; c < columns; ++c) made.offsets[c + 1] += made.offsets[c];
    made.columns.resize(matrix.columns.size());
    made.weights.resize(matrix.columns.size());
    std::vector<std::size_t> next(made.offsets.begin(), made.offsets.end() - 1);
    for (std::size_t row = 0; row + 1 < matrix.offsets.size(); ++row) {
        for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
            const std::size_t at = next[matrix.columns[k]]++;
            made.columns[at] = static_cast<Index>(row);
            made.weights[at] = matrix.weights[k];
        }
    }
    return made;
}

std::vector<Vec3> product_with(const CsrMatrix& matrix, std::span<const Vec3> values) {
    std::vector<Vec3> sums(matrix.offsets.size() - 1);
    parallel_each(sums.size(), [&](std::size_t row) { sums[row] = row_times(matrix, row, values); });
    return sums;
}

}  // namespace subvol::detail
