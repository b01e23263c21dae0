// SPDX-License-Identifier: Apache-2.0
#include "dense_rows.h"

#include <gtest/gtest.h>

#include <random>

namespace subvol::detail {
namespace dense_rows_test {

std::vector<Vec3> random_vectors(std::mt19937& dice, std::size_t count) {
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<Vec3> vectors;
    for (std::size_t k = 0; k < count; ++k) vectors.emplace_back(number(dice), number(dice), number(dice));
    return vectors;
}

// Numbers of rows that fill no block of eight, too.
TEST(DenseRows, ProductsAreThoseOfTheMatrix) {
    std::mt19937 dice(1);
    for (const Eigen::Index rows : {1, 8, 37}) {
        const Eigen::MatrixXd matrix =
            Eigen::MatrixXd::NullaryExpr(rows, 11, [&]() { return std::uniform_real_distribution<double>(-1, 1)(dice); });
        const std::vector<Vec3> vectors = random_vectors(dice, 11);
        const DenseRows dense(matrix);
        ASSERT_EQ(dense.rows(), static_cast<std::size_t>(rows));
        std::vector<Vec3> products(dense.rows());
        dense.multiply(vectors, products);
        for (Eigen::Index r = 0; r < rows; ++r) {
            Vec3 sum(0.0);
            for (Eigen::Index c = 0; c < 11; ++c) sum += matrix(r, c) * vectors[static_cast<std::size_t>(c)];
            EXPECT_LT(glm::distance(products[static_cast<std::size_t>(r)], sum), 1e-14);
        }
    }
}

// The largest one may be the last of a number that fills no register.
TEST(DenseRows, LargestDifferencesAreFoundWhereverTheyAre) {
    std::mt19937 dice(2);
    for (std::size_t count = 0; count < 14; ++count) {
        const std::vector<Vec3> a = random_vectors(dice, count), b = random_vectors(dice, count);
        Vec3 most(0.0);
        for (std::size_t k = 0; k < count; ++k) most = glm::max(most, glm::abs(a[k] - b[k]));
        EXPECT_EQ(largest_difference(a, b), most) << count;
    }
}

}  // namespace dense_rows_test
}  // namespace subvol::detail
