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
    static constexpr std::size_t kRowsTogether = 8;

    DenseRows() = default;
    explicit DenseRows(const Eigen::MatrixXd& matrix);

    [[nodiscard]] std::size_t rows() const { return rows_; }

    /// A sum of `vectors` for each row. The order of the sums is that of the columns.
    void multiply(std::span<const Vec3> vectors, std::span<Vec3> products) const;

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<double> blocks_;  // of eight rows, column by column
};

/// The largest |a − b| of as many vectors, component by component.
[[nodiscard]] Vec3 largest_difference(std::span<const Vec3> a, std::span<const Vec3> b);

}  // namespace subvol::detail
