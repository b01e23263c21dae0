// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/model.h"

namespace subvol {
namespace limit_field_test {

HexMesh ball_with_waves(int cells) {
    HexMesh mesh = make_model("ball", cells);
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) * std::cos(p.y) + .3 * p.z; });
    return mesh;
}

LimitSamples random_samples(const HexMesh& mesh, std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> t(.02, .98);
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < count; ++i)
        queries.push_back({static_cast<Index>(random() % mesh.cells.size()), {t(random), t(random), t(random)}});
    return evaluate_limit(mesh, queries, {.tolerance = 1e-9, .max_levels = 14});
}

TEST(LimitField, HasTheValuesOfTheLimitWithinWhatItSays) {
    const HexMesh mesh = ball_with_waves(4);
    const LimitSamples limit = random_samples(mesh, 1000);
    double before = 1;
    for (const double tolerance : {1e-2, 1e-3}) {
        const LimitField field(mesh, "f", {}, LimitCellsOptions{.position_world = tolerance, .value_of_range = tolerance});
        EXPECT_LE(field.limit().value_of_range, tolerance);
        const double range = 3;  // at least that of the values; a place that is off by the position's tolerance adds its slope
        double largest = 0;
        for (std::size_t i = 0; i < limit.positions.size(); ++i) {
            const auto value = field.value(limit.positions[i]);
            ASSERT_TRUE(value) << i;
            largest = std::max(largest, std::abs(*value - limit.attributes[0].values[i]));
        }
        EXPECT_LT(largest, tolerance * range);
        EXPECT_LT(largest, before);
        before = largest;
    }
}

TEST(LimitField, GradientsAreThoseOfItsValues) {
    const HexMesh mesh = ball_with_waves(4);
    const LimitField field(mesh, "f", {}, LimitCellsOptions{.position_world = 1e-4, .value_of_range = 1e-4});
    const double h = 1e-5;
    int compared = 0;
    for (const Vec3& x : {Vec3(.1, .2, .3), Vec3(-.3, .1, .2), Vec3(.05, -.4, .1)}) {
        const auto gradient = field.gradient(x);
        ASSERT_TRUE(gradient);
        for (int k = 0; k < 3; ++k) {
            Vec3 d(0.0);
            d[k] = h;
            EXPECT_NEAR((*gradient)[k], (*field.value(x + d) - *field.value(x - d)) / (2 * h), 1e-3);
            ++compared;
        }
    }
    EXPECT_EQ(compared, 9);
}

TEST(LimitField, HasNoValueOutsideAndBoundedMemory) {
    const HexMesh mesh = ball_with_waves(4);
    const LimitField field(mesh, "f", {});
    EXPECT_FALSE(field.value({3, 0, 0}));
    EXPECT_FALSE(field.gradient({3, 0, 0}));
    const LimitField small(mesh, "f", {},
                           LimitCellsOptions{.position_world = .1, .value_of_range = 1e-3, .max_bytes = 250'000});
    EXPECT_LT(small.limit().piece_count * LimitPieces::kNodes * 4 * sizeof(float), 250'000u);
    EXPECT_GT(small.limit().value_of_range, 1e-3);
    EXPECT_TRUE(small.value({0, 0, 0}));
    test::expect_error(ErrorCode::InvalidInput, "g", [&] { LimitField(mesh, "g", {}); });
}

}  // namespace limit_field_test
}  // namespace subvol
