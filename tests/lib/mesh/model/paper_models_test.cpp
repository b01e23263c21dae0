// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lib/random_vector.h"
#include "subvol/detail/solid_field.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol {

using namespace detail;

namespace paper_models_test {

/// A type for each model: its name, its number of points after one level in table 2 of [mnmq2007], its field.
struct Pawn : PawnField {
    static constexpr const char* kName = "pawn";
    static constexpr double kRefinedPoints = 543'599;
};
struct Alien : AlienField {
    static constexpr const char* kName = "alien";
    static constexpr double kRefinedPoints = 487'071;
};
struct Train1 : Train1Field {
    static constexpr const char* kName = "train1";
    static constexpr double kRefinedPoints = 1'898'312;
};
struct Car : CarField {
    static constexpr const char* kName = "car";
    static constexpr double kRefinedPoints = 1'406'847;
};
struct Fan : FanField {
    static constexpr const char* kName = "fan";
    static constexpr double kRefinedPoints = 517'153;
};
struct Nozzle : NozzleField {
    static constexpr const char* kName = "nozzle";
    static constexpr double kRefinedPoints = 155'808;
};
struct Train2 : Train2Field {
    static constexpr const char* kName = "train2";
    static constexpr double kRefinedPoints = 1'636'349;
};

template <class Model>
std::vector<Vec3> random_parameters(std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec3> parameters;
    while (parameters.size() < count) {
        const Vec3 p = test::random_vector(uniform, random);
        if (std::is_same_v<Model, Nozzle> && p.y * p.y + p.z * p.z > 1) continue;  // a disk, not a square
        parameters.push_back(p);
    }
    return parameters;
}

template <class Model>
class PaperModel : public testing::Test {};
using Models = testing::Types<Pawn, Alien, Train1, Car, Fan, Nozzle, Train2>;
TYPED_TEST_SUITE(PaperModel, Models);

TYPED_TEST(PaperModel, HasThePapersNumberOfPointsAfterOneLevel) {
    const MeshReport report = inspect(make_model(TypeParam::kName));
    const auto refined = static_cast<double>(report.points + report.edges + report.faces + report.cells);
    EXPECT_NEAR(refined, TypeParam::kRefinedPoints, 0.05 * TypeParam::kRefinedPoints);
}

TYPED_TEST(PaperModel, HasNoInvertedCellBeforeAndAfterOneLevel) {
    const HexMesh mesh = make_model(TypeParam::kName);
    for (const ShapeReport& shapes : {measure_cells(mesh), measure_cells(refine(mesh))}) {
        EXPECT_EQ(shapes.inverted_cells, 0u);
        EXPECT_EQ(shapes.degenerate_cells, 0u);
        EXPECT_GT(shapes.min_scaled_jacobian, 0.5);
    }
}

TYPED_TEST(PaperModel, IsDeformedWithAPositiveJacobianEverywhere) {
    constexpr double h = 1e-5;
    double least = 1e300, most = 0;
    for (const Vec3& p : random_parameters<TypeParam>(10'000)) {
        Mat3 jacobian;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 step(0.0);
            step[axis] = h;
            jacobian[axis] = (TypeParam::position(p + step) - TypeParam::position(p - step)) / (2 * h);
        }
        const double volume = glm::dot(jacobian[0], glm::cross(jacobian[1], jacobian[2]));
        least = std::min(least, volume);
        most = std::max(most, volume);
    }
    EXPECT_GT(least, 0.1 * most);  // a stronger deformation would make cells too thin
    EXPECT_LT(least, 0.9 * most);  // more than a rotation
}

TYPED_TEST(PaperModel, InvertsInClosedForm) {
    for (const Vec3& p : random_parameters<TypeParam>(10'000)) {
        const Vec3 x = TypeParam::position(p);
        ASSERT_NEAR(glm::distance(TypeParam::parameter(x), p), 0, 1e-12);
        const auto value = TypeParam().value(x);
        ASSERT_TRUE(value);
        // The parameter is off by a few roundings; the densities change by up to 80 per unit.
        ASSERT_NEAR(*value, TypeParam::density(p), 1e-12);
        // One and a half times as far as the block's side, or the nozzle's end or wall.
        ASSERT_FALSE(TypeParam().value(TypeParam::position(p / std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) * 1.5)));
    }
}

TYPED_TEST(PaperModel, IsSampledFromOneFieldAtEveryResolution) {
    for (const int resolution : {5, 16}) {
        const HexMesh mesh = make_model(TypeParam::kName, resolution);
        for (std::size_t k = 0; k < mesh.points.size(); ++k) {
            // Points through the inverse: off by a few roundings, times a slope of up to 80.
            ASSERT_NEAR(mesh.attributes[0].values[k], TypeParam::density(TypeParam::parameter(mesh.points[k])), 1e-11) << k;
        }
    }
}

TYPED_TEST(PaperModel, FillsAPartOfItsBlockWithBothSigns) {
    const HexMesh mesh = make_model(TypeParam::kName);
    const std::vector<double>& density = mesh.attributes[0].values;
    const auto [low, high] = std::ranges::minmax(density);
    EXPECT_GE(low, -1);
    EXPECT_LE(high, 1);
    EXPECT_LT(low, -0.99);
    EXPECT_GT(high, 0.7);  // a part two cells inside: tanh(2/1.9) is .78
    const auto positive = static_cast<double>(std::ranges::count_if(density, [](double d) { return d > 0; }));
    EXPECT_GT(positive, 0.1 * static_cast<double>(density.size()));
    EXPECT_LT(positive, 0.4 * static_cast<double>(density.size()));
}

template <class Model>
class PaperSolid : public testing::Test {};
using Solids = testing::Types<Pawn, Alien, Train1, Car, Fan, Train2>;
TYPED_TEST_SUITE(PaperSolid, Solids);

TYPED_TEST(PaperSolid, IsNotCutByItsBlock) {
    for (const Vec3& p : random_parameters<TypeParam>(10'000)) {
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 on_side = p;
            on_side[axis] = p[axis] < 0 ? -1 : 1;
            ASSERT_LT(TypeParam::density(on_side), -0.48);  // tanh(1/1.9): the surface is a cell away at least
        }
    }
}

/// Mean square of the difference between the refined density and the exact one at the new points.
template <class Model>
double squared_error(int resolution) {
    HexMesh mesh = make_model(Model::kName, resolution);
    for (Vec3& p : mesh.points) p = Model::parameter(p);
    const HexMesh fine = refine(mesh);
    double sum = 0;
    for (std::size_t k = mesh.points.size(); k < fine.points.size(); ++k) {
        const double error = fine.attributes[0].values[k] - Model::density(fine.points[k]);
        sum += error * error;
    }
    return sum / static_cast<double>(fine.points.size() - mesh.points.size());
}

TYPED_TEST(PaperSolid, IsResolvedByItsLattice) {
    // The range is 2 wide. The pawn, made of polynomials, has .0096; edges rounded by less than a cell have more.
    EXPECT_LT(std::sqrt(squared_error<TypeParam>(0)), 0.02);
}

TEST(PaperSolids, AreAlikeLeftAndRight) {
    for (const Vec3& p : random_parameters<Alien>(2000)) {
        ASSERT_EQ(AlienField::density(p), AlienField::density({-p.x, p.y, p.z}));
        const Vec3 other(p.x, -p.y, p.z);
        ASSERT_EQ(Train1Field::density(p), Train1Field::density(other));
        ASSERT_EQ(CarField::density(p), CarField::density(other));
        ASSERT_EQ(Train2Field::density(p), Train2Field::density(other));
    }
}

TEST(Fan, HasFiveAlikeBlades) {
    const double c = std::cos(0.4 * std::numbers::pi), s = std::sin(0.4 * std::numbers::pi);
    for (const Vec3& p : random_parameters<Fan>(2000)) {
        const Vec3 turned = Vec3(c * p.x - s * p.z, p.y, s * p.x + c * p.z);
        ASSERT_NEAR(FanField::density(p), FanField::density(turned), 1e-12);  // roundings, times a slope of 30
    }
}

/// Expects that a solid fills places of its straight block, and that others are empty. half: the block's, in cells of the
/// default lattice, as the places are
template <class SolidModel>
void expect_parts(const Vec3& half, const std::vector<Vec3>& filled, const std::vector<Vec3>& empty) {
    for (const Vec3& q : filled) EXPECT_GT(SolidModel::density(q / half), 0.4) << q.x << " " << q.y << " " << q.z;
    for (const Vec3& q : empty) EXPECT_LT(SolidModel::density(q / half), -0.4) << q.x << " " << q.y << " " << q.z;
}

TEST(Alien, HasAntennaeEyesInSocketsArmsAndFeet) {
    constexpr Vec3 kHalf{18, 12.5, 32};
    const Vec3 brow(0, -2, 14), antenna(8.5, -1, 27), elbow(11, -1, -10), eye(5, -7.5, 10.5), foot(6, -3, -27.6);
    const Vec3 between_antennae(0, 0, 27), between_feet(0, -2, -27), socket(7.3, -7, 15.4);
    expect_parts<AlienField>(kHalf, {brow, antenna, elbow, eye, foot}, {between_antennae, between_feet});
    EXPECT_LT(AlienField::density(socket / kHalf), 0) << "a narrow gap";
}

TEST(Train1, HasBoilerChimneyDomeCabWheelsAndCowCatcher) {
    const Vec3 boiler(10, 0, 3), chimney(38, 4.3, 19), dome(5, 0, 17), cab_roof(-33, 0, 20), driver(-10, 14, -19.5),
        catcher(48, 0, -18);
    const Vec3 flue(38, 0, 20.5), between_domes(15, 0, 18), window(-32, 13.5, 8), in_the_cab(-38, 0, 6),
        beside_catcher(50, 13, -16);
    expect_parts<Train1Field>({56, 22, 23.5}, {boiler, chimney, dome, cab_roof, driver, catcher},
                              {flue, between_domes, window, in_the_cab, beside_catcher});
}

TEST(Car, HasRoofWindowsWheelsAndLamps) {
    constexpr Vec3 kHalf{44, 25, 19.5};
    const Vec3 roof(-5, 0, 15), tub(0, 0, -5), tyre(24, 17.5, -16.5), lamp(38, 11, -1.5);
    const Vec3 rear_window(-13, 13, 8), front_window(4, 13, 8), screen(14, 0, 8), inside(0, 0, 8), arch(15.2, 20, -6.2);
    expect_parts<CarField>(kHalf, {roof, tub, tyre, lamp}, {rear_window, front_window, screen, inside});
    EXPECT_LT(CarField::density(arch / kHalf), 0) << "a narrow gap";
}

TEST(Fan, HasARingAndABoredHub) {
    const Vec3 ring(0, 0, 24.6), hub(4.5, 0, 0), bore(0, 0, 0), before_the_hub(0, -10, 0);
    expect_parts<FanField>({28, 10, 28}, {ring, hub}, {bore, before_the_hub});
}

TEST(Train2, HasANoseAWagonWheelsAndWindows) {
    const Vec3 nose(69, 0, -4), engine(30, 0, -2), wagon(-40, 0, -2), bellows(0.5, 0, 0), wheel(-64.5, 11, -12);
    const Vec3 last_window(-62, 13, 4.5), first_window(16, 13, 4.5), above_the_nose(70, 0, 8), beside_the_bellows(0, 13, 0);
    expect_parts<Train2Field>({76, 20, 16.5}, {nose, engine, wagon, bellows, wheel},
                              {last_window, first_window, above_the_nose, beside_the_bellows});
}

TEST(Nozzle, IsAnOGridWithFourIrregularLines) {
    const MeshReport report = inspect(make_model("nozzle"));
    ASSERT_EQ(report.interior_edge_valence.size(), 2u);
    EXPECT_EQ(report.interior_edge_valence.at(3), 4u * 48);
    EXPECT_EQ(report.cells, 48u * (12 * 12 + 4 * 12 * 5));
    EXPECT_EQ(report.nonmanifold_edges, 0u);
    EXPECT_EQ(report.singular_nodes, 0u);
}

/// Half the width of the straight nozzle at s, from the arc's middle to its wall across the bend.
double wall_radius(double s) {
    return glm::distance(NozzleField::position({s, 1, 0}), NozzleField::position({s, -1, 0})) / 2;
}

TEST(Nozzle, ConvergesAndDivergesWhileTheGasGetsFaster) {
    double throat = 1, throat_at = 0, before = -1;
    for (double s = -1; s <= 1; s += 0.01) {
        if (wall_radius(s) < throat) throat = wall_radius(s), throat_at = s;
        const double speed = NozzleField::density({s, 0, 0});
        ASSERT_GT(speed, before);
        before = speed;
        for (const double angle : {0.0, 1.0, 4.0}) {
            // The gas is at rest at the wall, and its speed is the same all around the axis.
            ASSERT_NEAR(NozzleField::density({s, std::cos(angle), std::sin(angle)}), -1, 1e-14);
            ASSERT_NEAR(NozzleField::density({s, 0.5 * std::cos(angle), 0.5 * std::sin(angle)}),
                        NozzleField::density({s, 0.5, 0}), 1e-14);
        }
    }
    EXPECT_GT(wall_radius(-1), 1.8 * throat);
    EXPECT_GT(wall_radius(1), 1.8 * throat);
    EXPECT_NEAR(throat_at, 0.27, 0.02);
    // At the throat the speed is that of sound, √(1/6) of the gas's greatest possible speed; at the outlet (Mach 3) it is
    // √(1.8/2.8).
    EXPECT_NEAR((NozzleField::density({throat_at, 0, 0}) + 1) / 2, std::sqrt(1 / 6.0) / std::sqrt(1.8 / 2.8), 0.01);
}

}  // namespace paper_models_test
}  // namespace subvol
