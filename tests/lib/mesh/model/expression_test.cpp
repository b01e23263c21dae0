// SPDX-License-Identifier: Apache-2.0
#include "subvol/expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"

namespace subvol {
namespace expression_test {

std::vector<Vec3> random_points(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> coordinate(-2, 2);
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
    return points;
}

TEST(Expression, IsEvaluatedAtEveryPoint) {
    const auto points = random_points(100'000);  // several parsers' worth
    const auto values = evaluate_expression("sin(3*x)*cos(2*y)+z^2-pi", points);
    ASSERT_EQ(values.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        // The parser may order operations differently: a few roundings of numbers up to 5
        ASSERT_NEAR(values[i], std::sin(3 * p.x) * std::cos(2 * p.y) + p.z * p.z - M_PI, 1e-14);
    }
}

TEST(Expression, KnowsConditions) {
    const std::vector<Vec3> points{{-1, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(evaluate_expression("x > 0 ? 2 : 3", points), (std::vector<double>{3, 2}));
    EXPECT_EQ(evaluate_expression("max(x, y)", points), (std::vector<double>{0, 1}));
}

TEST(Expression, SaysWhereItIsWrong) {
    const auto points = random_points(3);
    const auto refused = [&](const std::string& part, const std::string& expression) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)evaluate_expression(expression, points); });
    };
    refused("position 2", "x+foo");
    refused("position 2", "x+*y");
    refused("arenthesis", "sin(3*x");
    refused("empty", "");
    refused("several values", "x,y");
    refused("==", "x=3");
    test::expect_error(ErrorCode::InvalidInput, "position 2", [] { (void)evaluate_expression("x+foo", {}); });
}

TEST(Expression, NamesTheFirstPointWithoutAFiniteValue) {
    auto points = random_points(50'000);
    for (auto& p : points) p.x = std::abs(p.x) + 1;
    points[20'000] = points[40'000] = {0, 2, 3};
    test::expect_error(ErrorCode::InvalidInput, "point 20000 (0, 2, 3)", [&] { (void)evaluate_expression("1/x", points); });
    test::expect_error(ErrorCode::InvalidInput, "point 0", [&] { (void)evaluate_expression("log(-x)", points); });
}

}  // namespace expression_test
}  // namespace subvol
