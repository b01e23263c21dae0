// SPDX-License-Identifier: Apache-2.0
// Places in the volumes of meshes of tetrahedra.
#include "subvol/mixed_probe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "lib/expect_error.h"
#include "lib/subdivision/mixed/mixed_meshes.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/refine_mixed.h"

namespace subvol {
namespace {

/// f has an exact gradient; v has three channels.
MixedMesh with_fields(MixedMesh mesh, const std::function<double(const Vec3&)>& f) {
    mesh.attributes.clear();
    Attribute scalar{"f", 1, {}}, vector{"v", 3, {}};
    for (const Vec3& p : mesh.points) {
        scalar.values.push_back(f(p));
        vector.values.insert(vector.values.end(), {p.y, -p.x, f(p)});
    }
    mesh.attributes = {std::move(scalar), std::move(vector)};
    return mesh;
}

double linear(const Vec3& p) {
    return 2 * p.x - p.y + 3 * p.z + 1;
}

std::vector<MixedMesh> measured_meshes(TetScheme scheme) {
    std::vector<MixedMesh> meshes{test::make_kuhn_box(2), test::make_tet_ball(3)};
    if (scheme == TetScheme::Tetoct) meshes.push_back(test::make_mixed());
    return meshes;
}

class MixedPlaces : public testing::TestWithParam<TetScheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, MixedPlaces, testing::Values(TetScheme::Tetoct, TetScheme::Boxspline));

TEST_P(MixedPlaces, HaveLinearFieldsAndTheirGradients) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> t(0, 1);
    for (const MixedMesh& given : measured_meshes(GetParam())) {
        const MixedMesh mesh = volume_through(with_fields(given, linear), {.scheme = GetParam(), .crease_angle_deg = 60}).mesh;
        std::vector<Vec3> places;
        for (int i = 0; i < 200; ++i) {  // between corners of cells of every kind
            detail::each_kind_of(mesh, [&](auto, const auto& cells) {
                if (cells.empty()) return;
                const auto& cell = cells[random() % cells.size()];
                double sum = 0;
                Vec3 place(0);
                for (const Index p : cell) {
                    const double w = t(random) + 1e-3;
                    place += w * mesh.points[p];
                    sum += w;
                }
                places.push_back(place / sum);
            });
        }
        const ProbeResult found = MixedProbe(mesh).at(places);
        EXPECT_TRUE(found.parameters.empty());
        for (std::size_t p = 0; p < places.size(); ++p) {
            ASSERT_TRUE(found.inside(p)) << p;
            EXPECT_NEAR(found.fields[0].values[p], linear(places[p]), 1e-7);  // places are found to 1e-6 of the size
            EXPECT_NEAR(glm::distance(found.fields[0].gradients[p], Vec3(2, -1, 3)), 0, 1e-7);
            EXPECT_NEAR(found.fields[1].values[3 * p + 1], -places[p].x, 1e-7);
            EXPECT_NEAR(glm::distance(found.fields[1].gradients[3 * p + 1], Vec3(-1, 0, 0)), 0, 1e-7);
            EXPECT_NEAR(glm::distance(found.fields[1].gradients[3 * p + 2], Vec3(2, -1, 3)), 0, 1e-7);
        }
    }
}

TEST_P(MixedPlaces, AreTheVerticesOfAFinerLevelWhereThatHasThem) {
    // The points of a level lie on the limit, and are points of the next one too.
    const auto f = [](const Vec3& p) { return std::sin(2 * p.x) * p.y + p.z * p.z; };
    const MixedMesh control = with_fields(test::make_tet_ball(2), f);
    const MixedMesh coarse = volume_through(control, {.scheme = GetParam(), .levels = 1}).mesh;
    const MixedMesh fine = volume_through(control, {.scheme = GetParam(), .levels = 2}).mesh;
    const MixedProbe probe(fine, control_cells(control, 2));
    const ProbeResult found = probe.at(coarse.points);
    for (std::size_t p = 0; p < coarse.points.size(); ++p) {
        ASSERT_TRUE(found.inside(p)) << p;
        EXPECT_LT(found.cells[p], control.cells());
        EXPECT_NEAR(found.fields[0].values[p], coarse.attributes[0].values[p], 1e-6);
    }
}

TEST_P(MixedPlaces, HaveGradientsThatConverge) {
    // The limit is smooth: values of a level are off by h², gradients too.
    const auto f = [](const Vec3& p) { return std::sin(2 * p.x) * p.y + p.z * p.z; };
    const MixedMesh control = with_fields(test::make_kuhn_box(2), [&](const Vec3& p) { return f(p / 2.0); });
    std::vector<Vec3> places;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> t(.4, 1.6);
    for (int i = 0; i < 300; ++i) places.push_back({t(random), t(random), t(random)});
    const auto at_level = [&](int level) {
        const MixedRefineOptions options{.scheme = GetParam(), .levels = level, .crease_angle_deg = 60};
        return MixedProbe(volume_through(control, options, 1e-9).mesh).at(places);
    };
    const ProbeResult fine = at_level(3);
    double error[2][2] = {};
    for (const int level : {1, 2}) {
        const ProbeResult found = at_level(level);
        for (std::size_t p = 0; p < places.size(); ++p) {
            auto& [value, gradient] = error[level - 1];
            value = std::max(value, std::abs(found.fields[0].values[p] - fine.fields[0].values[p]));
            gradient = std::max(gradient, glm::distance(found.fields[0].gradients[p], fine.fields[0].gradients[p]));
        }
    }
    EXPECT_LT(error[1][0], error[0][0] / 2.5);
    EXPECT_LT(error[1][1], error[0][1] / 2);
    EXPECT_LT(error[1][1], .1);  // of about 1 a unit
}

TEST(MixedPlacesOutside, HaveNothingUnlessTheyAreWithinReach) {
    const MixedMesh mesh = with_fields(test::make_kuhn_box(2), linear);
    const std::vector<Vec3> places{{1, 1, 1}, {2.05, 1, 1}, {9, 9, 9}};
    const ProbeResult found = MixedProbe(mesh).at(places);
    EXPECT_TRUE(found.inside(0));
    EXPECT_FALSE(found.inside(1));
    const ProbeResult near = MixedProbe(mesh, {}, .1).at(places);
    EXPECT_TRUE(near.inside(1));
    EXPECT_NEAR(near.distances[1], .05, 1e-9);
    EXPECT_NEAR(near.fields[0].values[1], linear({2, 1, 1}), 1e-9);
    EXPECT_FALSE(near.inside(2));
}

TEST(MixedPlacesInCells, AreNamedByControlCells) {
    // Middles of all children, of every kind, lie in their control cells where the split is linear.
    const MixedMesh control = with_fields(test::make_mixed(), linear);
    const MixedMesh fine = refine(control, {.scheme = TetScheme::Linear, .levels = 2});
    std::vector<Vec3> middles;
    detail::each_kind_of(fine, [&](auto, const auto& cells) {
        for (const auto& cell : cells) {
            Vec3 middle(0);
            for (const Index p : cell) middle += fine.points[p] / static_cast<double>(cell.size());
            middles.push_back(middle);
        }
    });
    const std::vector<Index> parents = control_cells(control, 2);
    ASSERT_EQ(parents.size(), fine.cells());
    const ProbeResult in_control = MixedProbe(control).at(middles), in_fine = MixedProbe(fine).at(middles);
    const ProbeResult named = MixedProbe(fine, parents).at(middles);
    for (std::size_t c = 0; c < middles.size(); ++c) {
        EXPECT_EQ(in_control.cells[c], parents[c]) << c;
        EXPECT_EQ(in_fine.cells[c], c);
        EXPECT_EQ(named.cells[c], parents[c]);
    }
    test::expect_error(ErrorCode::InvalidInput, "2 numbers", [&] { MixedProbe(fine, {1, 2}); });
}

TEST(MeasureOfMixedCells, IsThatOfTheVolume) {
    const MixedMesh ball = with_fields(test::make_tet_ball(3), linear);
    const MixedMesh fine = volume_through(ball, {.levels = 2}).mesh;
    const LimitMeasure found = measure_limit(fine, control_cells(ball, 2));
    EXPECT_EQ(found.whole.cells, ball.cells());
    EXPECT_NEAR(found.whole.volume, measure_cells(fine).volume, 1e-9);
    EXPECT_NEAR(found.whole.volume, 4 * std::numbers::pi / 3, .1);  // of a ball of some 100 points
    EXPECT_NEAR(found.whole.fields[0].mean, linear(Vec3(0)), .05);
    EXPECT_LT(found.whole.fields[0].min.cell, ball.cells());
    EXPECT_NEAR(found.whole.fields[0].max.value, linear(found.whole.fields[0].max.place), 1e-3);
}

}  // namespace
}  // namespace subvol
