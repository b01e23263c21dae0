// SPDX-License-Identifier: Apache-2.0
// Systems that are small enough to be solved by elimination.
#include "subvol/detail/conjugate_gradients.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {
namespace conjugate_gradients_test {

using Matrix = Eigen::MatrixXd;

constexpr double kTolerance = 1e-9;  // the systems' conditions are below 1e4: an error of the rest of 1e-14 times that

/// Numbers without a pattern.
Matrix numbers(Eigen::Index rows, Eigen::Index columns) {
    Matrix made(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index j = 0; j < columns; ++j) made(i, j) = std::sin(double(13 * i * i + 7 * j + 3 * i * j + 1));
    }
    return made;
}

Matrix positive(Eigen::Index size) {
    const Matrix a = numbers(size, size);
    return a.transpose() * a + Matrix::Identity(size, size);
}

TEST(ConjugateGradients, SolveASystemOfVectors) {
    constexpr Eigen::Index kSize = 12;
    const Matrix a = positive(kSize), b = numbers(kSize, 3), exact = a.ldlt().solve(b);
    std::vector<Vec3> x(kSize, Vec3(0.0)), rest(kSize);
    for (Eigen::Index i = 0; i < kSize; ++i) rest[std::size_t(i)] = {b(i, 0), b(i, 1), b(i, 2)};
    const auto dot = [](const std::vector<Vec3>& u, const std::vector<Vec3>& v) {
        double sum = 0;
        for (std::size_t i = 0; i < u.size(); ++i) sum += glm::dot(u[i], v[i]);
        return sum;
    };
    const int steps = conjugate_gradients(
        x, rest,
        [&](std::vector<Vec3>& scaled) {
            for (std::size_t i = 0; i < rest.size(); ++i) scaled[i] = rest[i] / a(Eigen::Index(i), Eigen::Index(i));
            return dot(rest, scaled);
        },
        [&](const std::vector<Vec3>& direction, std::vector<Vec3>& image) {
            for (Eigen::Index i = 0; i < kSize; ++i) {
                image[std::size_t(i)] = Vec3(0.0);
                for (Eigen::Index j = 0; j < kSize; ++j) image[std::size_t(i)] += a(i, j) * direction[std::size_t(j)];
            }
        },
        dot, [](int step, double product) { return step < 200 && product > 1e-28; });
    EXPECT_LT(steps, 200);
    for (Eigen::Index i = 0; i < kSize; ++i) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(x[std::size_t(i)][k], exact(i, k), kTolerance);
    }
}

// The second of two systems begins at its solution, and stays there while the first goes on.
TEST(ConjugateGradients, SolveLeastSquaresSideBySide) {
    using Pair = std::array<double, 2>;
    constexpr Eigen::Index kRows = 20, kSize = 7;
    const Matrix a = numbers(kRows, kSize), b = numbers(kRows, 2);
    const Matrix exact = a.colPivHouseholderQr().solve(b);
    std::vector<Pair> x(kSize), rest(kRows);
    for (Eigen::Index j = 0; j < kSize; ++j) x[std::size_t(j)] = {0, exact(j, 1)};
    const Matrix left = b.col(1) - a * exact.col(1);
    for (Eigen::Index i = 0; i < kRows; ++i) rest[std::size_t(i)] = {b(i, 0), left(i)};
    const auto dot = [](const std::vector<Pair>& u, const std::vector<Pair>& v) {
        Pair sum{};
        for (std::size_t i = 0; i < u.size(); ++i) sum[0] += u[i][0] * v[i][0], sum[1] += u[i][1] * v[i][1];
        return sum;
    };
    Pair product{};
    conjugate_gradients(
        x, rest,
        [&](std::vector<Pair>& gradient) {
            for (Eigen::Index j = 0; j < kSize; ++j) {
                gradient[std::size_t(j)] = {};
                for (Eigen::Index i = 0; i < kRows; ++i) add_times(gradient[std::size_t(j)], a(i, j), rest[std::size_t(i)]);
            }
            return dot(gradient, gradient);
        },
        [&](const std::vector<Pair>& direction, std::vector<Pair>& image) {
            for (Eigen::Index i = 0; i < kRows; ++i) {
                image[std::size_t(i)] = {};
                for (Eigen::Index j = 0; j < kSize; ++j) add_times(image[std::size_t(i)], a(i, j), direction[std::size_t(j)]);
            }
        },
        [&](const std::vector<Pair>&, const std::vector<Pair>& image) {
            Pair curvature = dot(image, image);
            for (std::size_t l = 0; l < 2; ++l) curvature[l] = product[l] > 1e-26 ? curvature[l] : 0;
            return curvature;
        },
        [&](int step, const Pair& now) {
            product = now;
            return step < 100;
        });
    for (Eigen::Index j = 0; j < kSize; ++j) {
        EXPECT_NEAR(x[std::size_t(j)][0], exact(j, 0), kTolerance);
        EXPECT_EQ(x[std::size_t(j)][1], exact(j, 1));
    }
}

}  // namespace conjugate_gradients_test
}  // namespace subvol::detail
