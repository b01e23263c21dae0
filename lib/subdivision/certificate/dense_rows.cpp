// SPDX-License-Identifier: Apache-2.0
#include "dense_rows.h"

#include <algorithm>

namespace subvol::detail {

namespace {

constexpr std::size_t kRowsTogether = 8;

}  // namespace

DenseRows::DenseRows(const Eigen::MatrixXd& matrix)
    : rows_(static_cast<std::size_t>(matrix.rows())), columns_(static_cast<std::size_t>(matrix.cols())) {
    for (std::size_t first = 0; first < rows_; first += kRowsTogether) {
        for (std::size_t c = 0; c < columns_; ++c) {
            for (std::size_t r = first; r < first + kRowsTogether; ++r) {
                blocks_.push_back(r < rows_ ? matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) : 0);
            }
        }
    }
}

std::vector<Vec3> DenseRows::times(std::span<const Vec3> vectors) const {
    std::vector<Vec3> products(rows_);
    const double* weights = blocks_.data();
    for (std::size_t first = 0; first < rows_; first += kRowsTogether) {
        double x[kRowsTogether] = {}, y[kRowsTogether] = {}, z[kRowsTogether] = {};
        for (std::size_t c = 0; c < columns_; ++c, weights += kRowsTogether) {
            const Vec3 v = vectors[c];
            for (std::size_t r = 0; r < kRowsTogether; ++r) x[r] += weights[r] * v.x;
            for (std::size_t r = 0; r < kRowsTogether; ++r) y[r] += weights[r] * v.y;
            for (std::size_t r = 0; r < kRowsTogether; ++r) z[r] += weights[r] * v.z;
        }
        for (std::size_t r = first; r < std::min(rows_, first + kRowsTogether); ++r) {
            products[r] = {x[r - first], y[r - first], z[r - first]};
        }
    }
    return products;
}

}  // namespace subvol::detail
