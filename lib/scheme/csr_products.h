// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/stencil_table.h"
#include "subvol/vec.h"

namespace subvol::detail {

[[nodiscard]] CsrMatrix transpose_of(const CsrMatrix& matrix, std::size_t columns);

/// The sum of a row.
[[nodiscard]] inline Vec3 row_times(const CsrMatrix& matrix, std::size_t row, std::span<const Vec3> values) {
    Vec3 sum(0.0);
    for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
        sum += matrix.weights[k] * values[matrix.columns[k]];
    }
    return sum;
}

/// A vector for each row. cost: parallel; bitwise the same for any number of threads
[[nodiscard]] std::vector<Vec3> product_with(const CsrMatrix& matrix, std::span<const Vec3> values);

}  // namespace subvol::detail
