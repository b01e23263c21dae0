// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// A matrix that vectors are multiplied by, faster than by a general product, which is made for more columns than three.
class DenseRows {
public:
    DenseRows() = default;
    explicit DenseRows(const Eigen::MatrixXd& matrix);

    /// A sum of `vectors` for each row. The order of the sums is that of the columns.
    [[nodiscard]] std::vector<Vec3> times(std::span<const Vec3> vectors) const;

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<double> blocks_;  // of eight rows, column by column
};

}  // namespace subvol::detail
