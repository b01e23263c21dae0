// SPDX-License-Identifier: Apache-2.0
// Sparse rows against dense ones. All numbers are small whole ones, so that sums are exact in any order.
#include "subvol/detail/sparse_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdint>

#include "subvol/vec.h"

namespace subvol::detail {
namespace sparse_rows_test {

using Matrix = SparseRows<float, std::uint16_t, std::uint32_t>;

constexpr std::size_t kRows = 700, kColumns = 90;  // more rows than a thread takes at once

/// A row in seven has no entries, and the last column none.
Eigen::MatrixXd dense() {
    Eigen::MatrixXd made = Eigen::MatrixXd::Zero(kRows, kColumns);
    for (int r = 0; r < made.rows(); ++r) {
        if (r % 7 == 3) continue;
        for (int c = 0; c + 1 < made.cols(); ++c) made(r, c) = (r * r + 5 * c * r + c) % 11 == 0 ? (r + 3 * c) % 17 - 8 : 0;
    }
    return made;
}

void add_rows(const Eigen::MatrixXd& from, int first, int last, Matrix& to) {
    for (int r = first; r < last; ++r) {
        for (int c = 0; c < from.cols(); ++c) {
            if (from(r, c) == 0) continue;
            to.columns.push_back(static_cast<std::uint16_t>(c));
            to.weights.push_back(static_cast<float>(from(r, c)));
        }
        to.offsets.push_back(static_cast<std::uint32_t>(to.columns.size()));
    }
}

Matrix sparse(const Eigen::MatrixXd& from) {
    Matrix made;
    add_rows(from, 0, static_cast<int>(from.rows()), made);
    return made;
}

void expect_same(const Matrix& a, const Matrix& b) {
    EXPECT_EQ(a.offsets, b.offsets);
    EXPECT_EQ(a.columns, b.columns);
    EXPECT_EQ(a.weights, b.weights);
}

TEST(SparseRows, TimesVectorsAreThoseOfADenseMatrix) {
    const Eigen::MatrixXd matrix = dense();
    Eigen::MatrixXd values(kColumns, 3);
    std::vector<Vec3> vectors(kColumns);
    std::vector<std::array<double, 2>> pairs(kColumns);
    std::vector<double> numbers(kColumns);
    for (int c = 0; c < values.rows(); ++c) {
        for (int a = 0; a < 3; ++a) values(c, a) = (c * (a + 2)) % 13 - 6;
        const auto at = static_cast<std::size_t>(c);
        vectors[at] = {values(c, 0), values(c, 1), values(c, 2)};
        pairs[at] = {values(c, 0), values(c, 1)};
        numbers[at] = values(c, 2);
    }
    const Eigen::MatrixXd exact = matrix * values;
    const Matrix rows = sparse(matrix);
    ASSERT_EQ(row_count(rows), kRows);
    const auto of_vectors = product_with(rows, vectors);
    const auto of_pairs = product_with(rows, pairs);
    const auto of_numbers = product_with(rows, numbers);
    for (std::size_t r = 0; r < kRows; ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        EXPECT_EQ(of_vectors[r], Vec3(exact(row, 0), exact(row, 1), exact(row, 2)));
        EXPECT_EQ(of_pairs[r], (std::array<double, 2>{exact(row, 0), exact(row, 1)}));
        EXPECT_EQ(of_numbers[r], exact(row, 2));
    }
}

TEST(SparseRows, TheTransposeIsThatOfADenseMatrix) {
    const Eigen::MatrixXd matrix = dense();
    const Matrix rows = sparse(matrix);
    expect_same(transpose_of(rows, kColumns), sparse(matrix.transpose()));
    expect_same(transpose_of(transpose_of(rows, kColumns), kRows), rows);
}

TEST(SparseRows, PartsAreJoinedInTheirOrder) {
    const Eigen::MatrixXd matrix = dense();
    std::vector<Matrix> parts(4);
    add_rows(matrix, 0, 100, parts[0]);
    add_rows(matrix, 100, 101, parts[1]);
    add_rows(matrix, 101, kRows, parts[3]);
    expect_same(joined_rows(std::move(parts)), sparse(matrix));
}

}  // namespace sparse_rows_test
}  // namespace subvol::detail
