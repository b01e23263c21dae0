// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/refine.h"

namespace subvol {
namespace value_rule_test {

double rmse_of(const HexMesh& mesh, ValueRule rule, const Kernel& kernel) {
    const auto values = values_at_new_points(mesh, "f", rule, kernel);
    const auto exact = values_at_new_points(mesh, "f", ValueRule::Scheme, {});
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += (values[i] - exact[i]) * (values[i] - exact[i]);
    return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(ValueRule, SchemeIsTheRefinement) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; });
    const auto values = values_at_new_points(mesh, "f", ValueRule::Scheme, {});
    const auto fine = refine(mesh).attributes[0].values;
    ASSERT_EQ(values.size(), fine.size() - mesh.points.size());
    EXPECT_TRUE(std::equal(values.begin(), values.end(), fine.begin() + static_cast<std::ptrdiff_t>(mesh.points.size())));
}

TEST(ValueRule, CubicReproducesQuadraticsOnABoxToItsSides) {
    // Catmull-Rom reproduces quadratics, and so does the extrapolation beyond the sides.
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.x - p.y * p.z + 2 * p.z * p.z - p.x; });
    const HexMesh fine = refine(mesh);
    const auto values = values_at_new_points(mesh, "f", ValueRule::Cubic, {});
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Vec3& p = fine.points[mesh.points.size() + i];
        EXPECT_NEAR(values[i], p.x * p.x - p.y * p.z + 2 * p.z * p.z - p.x, 1e-12);
    }
}

TEST(ValueRule, CubicReproducesFieldsLinearInTheParametersOnIrregularMeshes) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::add_field(mesh, "f", [](const Vec3&) { return 3.0; });
    for (const double v : values_at_new_points(mesh, "f", ValueRule::Cubic, {})) EXPECT_NEAR(v, 3, 1e-12);
    for (const double v : values_at_new_points(mesh, "f", ValueRule::Paper, named_kernel("bc"))) {
        EXPECT_NEAR(v, 3, 1e-12);
    }
}

TEST(ValueRule, PaperIsTheWeightedMeanOfTheControlPointsAbout) {
    HexMesh mesh = test::make_box(4, 4, 4);
    std::mt19937 random(7);
    test::add_field(mesh, "f", [&](const Vec3&) { return static_cast<double>(random()) * 0x1p-32; });
    const Kernel kernel = named_kernel("paper_bc");
    const HexMesh fine = refine(mesh);
    const auto values = values_at_new_points(mesh, "f", ValueRule::Paper, kernel);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Vec3& x = fine.points[mesh.points.size() + i];  // a box of unit cells: parameters are positions
        double weights = 0, sum = 0;
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            const double w = kernel_value(kernel, x - mesh.points[p]);
            weights += w;
            sum += w * mesh.attributes[0].values[p];
        }
        EXPECT_NEAR(values[i], sum / weights, 1e-12);
    }
}

/// Waves of about 14 cells.
HexMesh smooth_noise() {
    HexMesh mesh = test::make_box(16, 16, 16);
    test::add_field(mesh, "f", [](const Vec3& p) {
        return std::sin(.45 * p.x + .3) * std::cos(.35 * p.y) * std::sin(.4 * p.z + 1) + .2 * std::sin(.5 * (p.x + p.y - p.z));
    });
    return mesh;
}

TEST(ValueRule, BetterRulesErrLess) {
    const HexMesh mesh = smooth_noise();
    const double paper = rmse_of(mesh, ValueRule::Paper, named_kernel("paper_bc"));
    const double mended = rmse_of(mesh, ValueRule::Paper, named_kernel("bc"));
    const double two = rmse_of(mesh, ValueRule::Paper, named_kernel("two_gaussians"));
    const double cubic = rmse_of(mesh, ValueRule::Cubic, {});
    EXPECT_LT(mended, paper);      // the sign slip of the paper costs about a quarter
    EXPECT_LT(two, mended);        // as docs/science.md says
    EXPECT_LT(cubic, paper / 10);  // fourth order against second
    EXPECT_GT(cubic, 0);
}

TEST(ValueRule, PaperRefusesAKernelThatReachesNoControlPoint) {
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const auto values = [&](double radius) {
        return values_at_new_points(mesh, "f", ValueRule::Paper, WendlandC2Kernel{.radius = radius});
    };
    // The middle of a cell is √.75 = .866 from its corners.
    for (const double radius : {0.4, 0.6, 0.86}) {
        test::expect_error(ErrorCode::InvalidInput, "kernel for values", [&] { (void)values(radius); });
    }
    for (const double v : values(0.87)) EXPECT_TRUE(v >= 0 && v <= 2) << v;  // means of values from 0 to 2

    // Samples at control points need no more than these; samples between them do.
    SampleOptions options{.values = ValueRule::Paper, .value_kernel = WendlandC2Kernel{.radius = 0.4}};
    const SampleResult sampled = sample_rbf_points(mesh, options);
    for (const float v : sampled.volume.channels[0].values) EXPECT_TRUE(std::isfinite(v));
    options.per_edge = 2;
    test::expect_error(ErrorCode::InvalidInput, "0.87 cells", [&] { (void)sample_rbf_points(mesh, options); });
}

TEST(ValueRule, TheFieldIsNamedOrTheFirstOfOneChannel) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes.push_back({"v", 3, std::vector<double>(24, 0.0)});
    const auto values = [&](std::string_view field) { return values_at_new_points(mesh, field, ValueRule::Cubic, {}); };
    test::expect_error(ErrorCode::InvalidInput, "no field \"v\" of one channel", [&] { (void)values("v"); });
    test::expect_error(ErrorCode::InvalidInput, "no field of one channel", [&] { (void)values(""); });
    mesh.attributes.push_back({"one", 1, std::vector<double>(8, 1.0)});
    mesh.attributes.push_back({"two", 1, std::vector<double>(8, 2.0)});
    EXPECT_EQ(values(""), values("one"));
    EXPECT_EQ(values("two"), std::vector<double>(values("two").size(), 2.0));
    test::expect_error(ErrorCode::InvalidInput, "no field \"three\"", [&] { (void)values("three"); });
}

}  // namespace value_rule_test
}  // namespace subvol
