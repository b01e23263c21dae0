// SPDX-License-Identifier: Apache-2.0
#include "subvol/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lib/expect_error.h"
#include "lib/random_vector.h"
#include "subvol/detail/solid_field.h"
#include "subvol/mesh_report.h"

namespace subvol {

using detail::PawnField;

namespace model_test {

const std::vector<double>& density(const HexMesh& mesh) {
    return mesh.attributes.at(0).values;
}

TEST(Model, EachIsSoundAndCarriesADensity) {
    for (const ModelInfo& info : list_models()) {
        for (const int resolution : {2, 3, 8}) {
            const HexMesh mesh = make_model(info.name, resolution);
            EXPECT_NO_THROW(validate(mesh)) << info.name;
            ASSERT_EQ(mesh.attributes.size(), 1u);
            EXPECT_EQ(mesh.attributes[0].name, "density");
            const auto [low, high] = std::minmax_element(density(mesh).begin(), density(mesh).end());
            EXPECT_GE(*low, -1);
            EXPECT_LE(*high, 1);
            const MeshReport report = inspect(mesh);
            EXPECT_EQ(report.points, report.points_used) << info.name;
            EXPECT_EQ(report.inverted_cells, 0u) << info.name;
            EXPECT_EQ(report.degenerate_cells, 0u) << info.name;
            EXPECT_EQ(report.nonmanifold_edges, 0u) << info.name;
            EXPECT_GT(report.min_scaled_jacobian, 0.5) << info.name << " " << resolution;
        }
    }
}

TEST(Model, RefusesUnknownNamesAndResolutions) {
    const auto invalid = ErrorCode::InvalidInput;
    test::expect_error(invalid, "pawn, ball, twist", [] { (void)make_model("torus"); });
    for (const int n : {-1, 1, 513}) test::expect_error(invalid, "2..512", [=] { (void)make_model("twist", n); });
}

// The benchmark's formulas, written out again as published.
Vec3 published_position(const Vec3& p) {
    const double a = std::numbers::pi / 4 * (p.z + 1), t = 0.35 * std::numbers::pi * p.z, radius = 1.6;
    const double x = 0.6 * (std::cos(a) * p.x - std::sin(a) * p.y), y = 0.6 * (std::sin(a) * p.x + std::cos(a) * p.y);
    return {(radius + x) * std::cos(t) - radius, y, (radius + x) * std::sin(t)};
}

double published_density(const Vec3& p) {
    const double f = std::sin(3.1 * p.x + .3) * std::cos(2.7 * p.y) * std::sin(2.3 * p.z + .5) +
                     .25 * std::cos(4 * (p.x * p.x + p.y * p.y + p.z * p.z));
    return f < -1 ? -1 : f > 1 ? 1 : f;
}

TEST(Twist, IsThePublishedBenchmark) {
    const HexMesh mesh = make_model("twist");
    ASSERT_EQ(mesh.points.size(), 41u * 41 * 41);
    ASSERT_EQ(mesh.cells.size(), 64000u);
    for (std::size_t id = 0; id < mesh.points.size(); ++id) {
        const Vec3 p(-1 + double(id % 41) / 20, -1 + double(id / 41 % 41) / 20, -1 + double(id / 1681) / 20);
        const Vec3 x = published_position(p);
        for (int c = 0; c < 3; ++c) {
            ASSERT_EQ(mesh.points[id][c], static_cast<float>(mesh.points[id][c])) << "float32";
            ASSERT_NEAR(mesh.points[id][c], x[c], 1.3e-7);  // half a unit in the last place of float32 below 2
        }
        ASSERT_NEAR(density(mesh)[id], published_density(p), 1e-14);
    }
}

template <class BlockField>
void expect_round_trip() {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> inside(-1, 1);
    const BlockField field;
    for (int i = 0; i < 10'000; ++i) {
        const Vec3 p = test::random_vector(inside, random);
        ASSERT_NEAR(glm::distance(BlockField::parameter(BlockField::position(p)), p), 0, 1e-12);
        const auto value = field.value(BlockField::position(p));
        ASSERT_TRUE(value);
        // The parameter is off by a few roundings; the pawn's density changes by up to 35 per unit.
        ASSERT_NEAR(*value, BlockField::density(p), 1e-12);
    }
}

TEST(Twist, InvertsInClosedForm) {
    expect_round_trip<TwistField>();
}

TEST(Pawn, InvertsInClosedForm) {
    expect_round_trip<PawnField>();
}

TEST(Twist, IsNothingOutsideTheBlock) {
    const TwistField field;
    constexpr double kJustOutside = 1 + 1e-9;
    for (const Vec3 p :
         {Vec3(kJustOutside, 0, 0), Vec3(0, -kJustOutside, 0.5), Vec3(0, 0, kJustOutside), Vec3(0, 0, -kJustOutside)}) {
        EXPECT_FALSE(field.value(TwistField::position(p)));
        EXPECT_TRUE(field.value(TwistField::position(p / kJustOutside * 0.999)));
    }
    // The cut of the angle lies behind the arc's centre: there is no value on either side of it.
    for (const double z : {-1e-12, 0.0, 1e-12}) EXPECT_FALSE(field.value(Vec3(-3.2, 0, z)));
    EXPECT_FALSE(field.value(Vec3(-1.6, 0, 0)));
    EXPECT_FALSE(field.value(Vec3(100, 100, 100)));
}

TEST(Pawn, HasThePapersNumberOfPointsAfterOneLevel) {
    const MeshReport report = inspect(make_model("pawn"));
    EXPECT_EQ(report.points, 33u * 33 * 65);
    EXPECT_EQ(report.cells, 32u * 32 * 64);
    // A level of a lattice of n × n × 2n cells has this many points. The paper's pawn has 543,599: no other n comes as near.
    const auto points_of_level = [](int n) { return std::pow(2 * n + 1, 2) * (4 * n + 1); };
    const auto off = [&](int n) { return std::abs(points_of_level(n) - 543'599); };
    const std::size_t refined = report.points + report.edges + report.faces + report.cells;
    EXPECT_EQ(static_cast<double>(refined), points_of_level(32));
    EXPECT_TRUE(off(32) < off(31) && off(32) < off(33)) << off(32);
    EXPECT_EQ(report.inverted_cells, 0u);
    EXPECT_EQ(report.interior_edge_valence.size(), 1u);
    // At the edges of the block, √.5 from its axis, the twist tilts lines along the axis by .6545 · √.5, and the bend shortens
    // those on its inner side to 1 − .4363 · √.5. Cells are smaller than that by a 32nd, so they are off by its square.
    const double edge = std::sqrt(0.5), tilt = 0.6545 * edge / (1 - 0.4363 * edge);
    EXPECT_NEAR(report.min_scaled_jacobian, 1 / std::sqrt(1 + tilt * tilt), 1e-3);
}

/// Where a horizontal ray in the straight pawn leaves it, in units of the block's half width (.5).
double radius_at(double z) {
    double inside = 0, outside = 1;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + outside);
        (PawnField::density({middle, 0, z}) > 0 ? inside : outside) = middle;
    }
    return 0.5 * inside;
}

TEST(Pawn, HasBaseStepConcaveBodyCollarAndHead) {
    const double base = radius_at(-0.8), step = radius_at(-0.62), low = radius_at(-0.4), middle = radius_at(-0.1),
                 neck = radius_at(0.22), collar = radius_at(0.35), head = radius_at(0.62);
    EXPECT_NEAR(base, 0.42, 0.01);
    EXPECT_NEAR(head, 0.25, 0.01);
    EXPECT_GT(base, step + 0.05);
    EXPECT_GT(step, low + 0.05);
    EXPECT_GT(low - middle, middle - neck) << "the body is concave";
    EXPECT_GT(collar, neck + 0.1);
    EXPECT_GT(collar, radius_at(0.44) + 0.03);
    EXPECT_LT(PawnField::density({0, 0, 0.95}), -0.9);
    EXPECT_LT(PawnField::density({0, 0, -0.98}), -0.9);
}

/// |gradient| of the pawn's density at distance r from the axis of the straight block, per world unit.
double steepness(double r, double z) {
    const auto at = [](double r_at, double z_at) { return PawnField::density({2 * r_at, 0, z_at}); };
    constexpr double h = 1e-5;
    return std::hypot(at(r + h, z) - at(r - h, z), at(r, z + h) - at(r, z - h)) / (2 * h);
}

TEST(Pawn, IsSolidAndItsLatticeResolvesTheSurface) {
    constexpr double kCell = 1.0 / 32;  // at the default resolution
    for (double z = -0.99; z < 1; z += 0.01) {
        if (z > -0.85 && z < 0.82) {
            EXPECT_GT(PawnField::density({0, 0, z}), 0.5) << z;  // a cell inside
        }
        // From -1 to 1 at the steepest slope takes at least three cells.
        for (double r = 0; r < 0.5; r += 0.01) ASSERT_LT(steepness(r, z) * kCell, 2. / 3) << r << " " << z;
    }
    const auto mesh = make_model("pawn");
    const auto [low, high] = std::minmax_element(density(mesh).begin(), density(mesh).end());
    EXPECT_LT(*low, -0.999);
    EXPECT_GT(*high, 0.95);  // four cells inside the base
}

TEST(Ball, IsACubeWithSixSectors) {
    for (const std::size_t n : {2u, 5u, 8u}) {
        const std::size_t shells = (n + 1) / 2;
        const HexMesh mesh = make_model("ball", static_cast<int>(n));
        EXPECT_EQ(mesh.points.size(), (n + 1) * (n + 1) * (n + 1) + shells * (6 * n * n + 2));
        EXPECT_EQ(mesh.cells.size(), n * n * n + 6 * n * n * shells);
        const MeshReport report = inspect(mesh);
        EXPECT_EQ(report.boundary_faces, 6 * n * n);
        EXPECT_EQ(report.singular_nodes, 8u);
        // 12 edges of the cube and 8 lines from its corners to the sphere have three cells about them, all others four.
        ASSERT_EQ(report.interior_edge_valence.size(), 2u);
        EXPECT_EQ(report.interior_edge_valence.at(3), 12 * n + 8 * shells);
        EXPECT_EQ(report.interior_edge_valence.at(4), report.interior_edges - 12 * n - 8 * shells);
        // Three cells about an edge can have sin 120° = .87 at best; the tetrahedral corners .77.
        EXPECT_GT(report.min_scaled_jacobian, n < 8 ? 0.66 : 0.73);
    }
}

TEST(Ball, HasItsBoundaryOnTheUnitSphere) {
    const HexMesh mesh = make_model("ball", 8);
    const std::size_t boundary = 6 * 8 * 8 + 2, first = mesh.points.size() - boundary;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double r = glm::length(mesh.points[p]);
        ASSERT_TRUE(p < first ? r < 0.99 : std::abs(r - 1) < 4e-16) << p << " " << r;  // two rounding errors
    }
    // The polyhedron's volume goes to the ball's with the square of the cell size.
    const double exact = 4 * std::numbers::pi / 3;
    const double coarse = exact - inspect(mesh).volume, fine = exact - inspect(make_model("ball", 16)).volume;
    EXPECT_NEAR(coarse / fine, 4, 0.2);
}

TEST(Ball, DensityIsOfThePosition) {
    const HexMesh mesh = make_model("ball", 6);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) ASSERT_EQ(density(mesh)[p], BallField::density(mesh.points[p]));
    const auto [low, high] = std::minmax_element(density(mesh).begin(), density(mesh).end());
    EXPECT_GT(*high - *low, 0.8) << "the field is not flat";
    EXPECT_TRUE(BallField().value({0, 0, 1}));
    EXPECT_FALSE(BallField().value({0, 0, 1 + 1e-12}));
    EXPECT_FALSE(BallField().value({0.6, 0.6, 0.6}));
}

}  // namespace model_test
}  // namespace subvol
