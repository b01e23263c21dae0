// SPDX-License-Identifier: Apache-2.0
#include "subvol/refine_mixed.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "lib/expect_error.h"
#include "mixed_meshes.h"

namespace subvol {
namespace refine_mixed_test {

using namespace test;

constexpr std::array<TetScheme, 3> kSchemes{TetScheme::Tetoct, TetScheme::Boxspline, TetScheme::Linear};

std::vector<MixedMesh> meshes_for(TetScheme scheme) {
    std::vector<MixedMesh> meshes{make_kuhn_box(3), make_tet_ball(4), make_octahedron()};
    if (scheme != TetScheme::Boxspline) meshes.push_back(make_mixed());
    return meshes;
}

// A tetrahedron becomes 4 and an octahedron, an octahedron 6 and 8 tetrahedra: the volume stays, and nothing is turned.
TEST(RefineMixed, LinearSplitKeepsTheVolumeAndTheOrientation) {
    for (const MixedMesh& mesh : meshes_for(TetScheme::Linear)) {
        const MixedShape before = measure_cells(mesh);
        ASSERT_EQ(before.inverted, 0u);
        const MixedMesh fine = refine(mesh, {.scheme = TetScheme::Linear, .levels = 2});
        const MixedShape after = measure_cells(fine);
        EXPECT_EQ(after.inverted, 0u);
        EXPECT_NEAR(after.volume, before.volume, 1e-12 * before.volume);
    }
    const MixedMesh one = refine(make_octahedron(), {.levels = 1});
    EXPECT_EQ(one.octahedra.size(), 6u);
    EXPECT_EQ(one.tets.size(), 8u);
    EXPECT_EQ(one.points.size(), 19u);
}

TEST(RefineMixed, EveryFaceOfTheNextLevelHasAtMostTwoCells) {
    for (const MixedMesh& mesh : meshes_for(TetScheme::Linear)) {
        const MixedMesh fine = refine(mesh, {.scheme = TetScheme::Linear, .levels = 1});
        const HexMesh hexes = in_hexahedra(fine);
        double volume = 0;
        for (const auto& cell : hexes.cells) {
            std::array<Vec3, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = hexes.points[cell[k]];
            const double of_cell = cell_volume(corners);
            EXPECT_GT(of_cell, 0);
            volume += of_cell;
        }
        EXPECT_NEAR(volume, measure_cells(mesh).volume, 1e-12 * volume);
        EXPECT_NO_THROW(static_cast<void>(refinement_tables(fine, {.levels = 0})));
    }
}

TEST(RefineMixed, WeightsAddUpToOne) {
    for (const TetScheme scheme : kSchemes) {
        for (const MixedMesh& mesh : meshes_for(scheme)) {
            const MixedTables tables = refinement_tables(mesh, {.scheme = scheme, .levels = 2});
            const std::vector<double> ones(mesh.points.size(), 1.0);
            for (const double sum : tables.apply(ones, 1)) EXPECT_NEAR(sum, 1, 1e-13);
        }
    }
}

TEST(RefineMixed, FollowsAffineMaps) {
    const Mat3 map(Vec3(1.3, 0.2, -0.4), Vec3(0.1, 0.6, 0.3), Vec3(-0.2, 0.5, 1.9));
    for (const TetScheme scheme : kSchemes) {
        for (MixedMesh mesh : meshes_for(scheme)) {
            mesh.attributes = {sampled(mesh, [](const Vec3& p) { return 2 * p.x - p.y + 3 * p.z + 0.5; })};
            const MixedMesh fine = refine(mesh, {.scheme = scheme, .levels = 2});
            MixedMesh moved = mesh;
            for (Vec3& p : moved.points) p = map * p + Vec3(1, 2, 3);
            const MixedMesh fine_moved = refine(moved, {.scheme = scheme, .levels = 2});
            for (std::size_t i = 0; i < fine.points.size(); ++i) {
                const Vec3& p = fine.points[i];
                EXPECT_LT(glm::length(fine_moved.points[i] - (map * p + Vec3(1, 2, 3))), 1e-12);
                EXPECT_NEAR(fine.attributes[0].values[i], 2 * p.x - p.y + 3 * p.z + 0.5, 1e-12);
            }
        }
    }
}

// The points do not depend on the order of the cells, or of the corners that make the same cell.
TEST(RefineMixed, IsIndependentOfTheOrderOfTheCells) {
    const MixedMesh mesh = make_tet_ball(3);
    MixedCells cells;
    cells.tets = mesh.tets;
    std::mt19937 random(3);
    std::shuffle(cells.tets.begin(), cells.tets.end(), random);
    for (auto& tet : cells.tets) std::shuffle(tet.begin(), tet.end(), random);
    const MixedMesh shuffled = make_mixed_mesh({mesh.points, {}, {}, {}, {}}, cells);
    for (const TetScheme scheme : kSchemes) {
        const MixedMesh a = refine(mesh, {.scheme = scheme, .levels = 3}),
                        b = refine(shuffled, {.scheme = scheme, .levels = 3});
        EXPECT_EQ(a.points, b.points);
    }
    MixedMesh mixed = refine(make_mixed(), {.levels = 1});
    const MixedMesh first = refine(mixed, {.levels = 2});
    std::shuffle(mixed.tets.begin(), mixed.tets.end(), random);
    std::shuffle(mixed.octahedra.begin(), mixed.octahedra.end(), random);
    std::shuffle(mixed.prisms.begin(), mixed.prisms.end(), random);
    std::shuffle(mixed.hexes.begin(), mixed.hexes.end(), random);
    EXPECT_EQ(first.points, refine(mixed, {.levels = 2}).points);
}

TEST(RefineMixed, TwoLevelsAndOneAreThree) {
    for (const TetScheme scheme : kSchemes) {
        for (const MixedMesh& mesh : meshes_for(scheme)) {
            const MixedRefineOptions three{.scheme = scheme, .levels = 3, .crease_angle_deg = 50};
            const MixedMesh at_once = refine(mesh, three);
            const MixedMesh twice = refine(mesh, {.scheme = scheme, .levels = 2, .crease_angle_deg = 50});
            const MixedMesh in_steps = refine(twice, {.scheme = scheme, .levels = 1});
            EXPECT_EQ(at_once.points, in_steps.points);
            EXPECT_EQ(at_once.tets, in_steps.tets);
            EXPECT_EQ(at_once.creases, in_steps.creases);
        }
    }
}

TEST(RefineMixed, IsTheSameForAnyNumberOfThreads) {
    const MixedMesh mesh = make_tet_ball(5);
    const MixedMesh many = on_limit(refine(mesh, {.levels = 2}), TetScheme::Tetoct);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(many.points, on_limit(refine(mesh, {.levels = 2}), TetScheme::Tetoct).points);
}

// [cmq2002] on its lattice: 2⁻⁵ [(1+x)(1+y)(1+z)(1+xyz)]², whose coefficients are multiples of 1/32.
TEST(RefineMixed, BoxSplineHasTheMasksOfItsSymbol) {
    std::array<std::array<std::array<int, 5>, 5>, 5> symbol{};
    symbol[0][0][0] = 1;
    const auto times = [&](std::size_t dx, std::size_t dy, std::size_t dz) {
        auto product = symbol;
        for (std::size_t i = dx; i < 5; ++i) {
            for (std::size_t j = dy; j < 5; ++j) {
                for (std::size_t k = dz; k < 5; ++k) product[i][j][k] += symbol[i - dx][j - dy][k - dz];
            }
        }
        symbol = product;
    };
    for (int twice = 0; twice < 2; ++twice) {
        times(1, 0, 0);
        times(0, 1, 0);
        times(0, 0, 1);
        times(1, 1, 1);
    }
    constexpr Index kCells = 6;
    MixedMesh mesh = make_kuhn_box(kCells);
    mesh.attributes = {sampled(mesh, [](const Vec3& p) { return p == Vec3(3, 3, 3) ? 1.0 : 0.0; })};
    const MixedMesh linear = refine(mesh, {.scheme = TetScheme::Linear, .levels = 1});
    const MixedMesh fine = refine(mesh, {.scheme = TetScheme::Boxspline, .levels = 1});
    std::size_t inside = 0;
    for (std::size_t i = 0; i < linear.points.size(); ++i) {
        const Vec3 at = 2.0 * (linear.points[i] - Vec3(3, 3, 3)) + Vec3(2, 2, 2);
        const bool in = glm::all(glm::greaterThanEqual(at, Vec3(0))) && glm::all(glm::lessThanEqual(at, Vec3(4)));
        const int expected =
            in ? symbol[static_cast<std::size_t>(std::lround(at.x))][static_cast<std::size_t>(std::lround(at.y))]
                       [static_cast<std::size_t>(std::lround(at.z))]
               : 0;
        EXPECT_NEAR(fine.attributes[0].values[i], expected / 32.0, 1e-14) << at.x << " " << at.y << " " << at.z;
        inside += in ? 1 : 0;
    }
    EXPECT_EQ(inside, 125u);
    EXPECT_EQ(symbol[2][2][2], 18);
}

/// The largest |limit(f) − g(limit point)| over the vertices of the level that are farther than `margin` from the boundary.
double error_inside(MixedMesh mesh, TetScheme scheme, double margin, double size, const std::function<double(const Vec3&)>& f,
                    const std::function<double(const Vec3&)>& g) {
    mesh.attributes = {sampled(mesh, f)};
    const MixedMesh fine = on_limit(refine(mesh, {.scheme = scheme, .levels = 1}), scheme);
    double largest = 0;
    std::size_t inside = 0;
    for (std::size_t i = 0; i < fine.points.size(); ++i) {
        const Vec3& p = fine.points[i];
        if (glm::any(glm::lessThan(p, Vec3(margin))) || glm::any(glm::greaterThan(p, Vec3(size - margin)))) continue;
        largest = std::max(largest, std::abs(fine.attributes[0].values[i] - g(p)));
        ++inside;
    }
    EXPECT_GT(inside, 20u);
    return largest;
}

// The box spline's limit of control values that are a cubic is a cubic, with the same leading part: x² becomes x² + a constant,
// x³ becomes x³ + a multiple of x. Its second moment about a point is ½ E (each direction twice, 2·2/12 each direction) in the
// lattice: Σ d dᵀ / 6 over the four directions.
TEST(RefineMixed, BoxSplineMakesCubicsOfCubics) {
    const auto limit_of = [](const std::function<double(const Vec3&)>& f, const std::function<double(const Vec3&)>& g) {
        return error_inside(make_kuhn_box(7), TetScheme::Boxspline, 2, 7, f, g);
    };
    EXPECT_LT(limit_of([](const Vec3& p) { return p.x * p.x; }, [](const Vec3& p) { return p.x * p.x + 1.0 / 3; }), 1e-11);
    EXPECT_LT(limit_of([](const Vec3& p) { return p.x * p.y; }, [](const Vec3& p) { return p.x * p.y + 1.0 / 6; }), 1e-11);
    EXPECT_LT(limit_of([](const Vec3& p) { return p.x * p.x * p.x; }, [](const Vec3& p) { return p.x * p.x * p.x + p.x; }),
              1e-10);
    EXPECT_GT(limit_of([](const Vec3& p) { return p.x * p.x * p.x * p.x; },
                       [](const Vec3& p) { return p.x * p.x * p.x * p.x + 2 * p.x * p.x; }),
              0.1);
}

TEST(RefineMixed, InterpolatedVerticesLieOnTheLimit) {
    for (const TetScheme scheme : kSchemes) {
        MixedMesh mesh = make_tet_ball(4);
        mesh.attributes = {sampled(mesh, [](const Vec3& p) { return std::sin(3 * p.x) * p.y; })};
        const MixedInterpolation found = interpolate_vertices(mesh, scheme, 1e-9, 300);
        EXPECT_LT(found.left, 1e-8) << found.steps;
        const MixedMesh limit = on_limit(found.mesh, scheme);
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            EXPECT_LT(glm::length(limit.points[i] - mesh.points[i]), 1e-7);
            EXPECT_NEAR(limit.attributes[0].values[i], mesh.attributes[0].values[i], 1e-7);
        }
    }
}

// A vertex of a level converges to the same place, whichever level it is moved from.
TEST(RefineMixed, LimitsAgreeBetweenLevels) {
    for (const TetScheme scheme : {TetScheme::Tetoct, TetScheme::Boxspline}) {
        for (const MixedMesh& mesh : meshes_for(scheme)) {
            const MixedMesh limit = on_limit(mesh, scheme);
            const MixedMesh finer = on_limit(refine(mesh, {.scheme = scheme, .levels = 2}), scheme);
            const MixedMesh level = refine(mesh, {.scheme = scheme, .levels = 3});
            double by_level = 0;
            for (std::size_t i = 0; i < mesh.points.size(); ++i) {
                EXPECT_LT(glm::length(limit.points[i] - finer.points[i]), 1e-12);
                by_level = std::max(by_level, glm::length(limit.points[i] - level.points[i]));
            }
            EXPECT_LT(by_level, 0.05 * glm::length(Vec3(1)));
        }
    }
}

TEST(RefineMixed, ABallStaysSound) {
    for (const TetScheme scheme : {TetScheme::Tetoct, TetScheme::Boxspline}) {
        MixedMesh mesh = make_tet_ball(3);
        ASSERT_EQ(measure_cells(mesh).inverted, 0u);
        for (int level = 1; level <= 4; ++level) {
            mesh = refine(mesh, {.scheme = scheme, .levels = 1});
            EXPECT_EQ(measure_cells(mesh).inverted, 0u) << level;
        }
    }
}

TEST(RefineMixed, CreasesStaySharpAndCornersStay) {
    const MixedMesh box = make_kuhn_box(2);
    const MixedMesh fine = refine(box, {.scheme = TetScheme::Tetoct, .levels = 2, .crease_angle_deg = 45});
    EXPECT_NEAR(measure_cells(fine).volume, 8, 1e-12);
    const MixedMesh round = refine(box, {.scheme = TetScheme::Tetoct, .levels = 2});
    EXPECT_LT(measure_cells(round).volume, 7.9);
}

TEST(RefineMixed, SplitCellsCanBeJoined) {
    const MixedMesh mesh = make_tet_ball(3);
    MixedMesh joined = join_split_cells(in_hexahedra(mesh));
    EXPECT_EQ(joined.points, mesh.points);
    EXPECT_EQ(joined.tets, mesh.tets);
    MixedMesh mixed = make_mixed();
    mixed.tets.clear();
    mixed.pyramids.clear();
    joined = join_split_cells(in_hexahedra(mixed));
    EXPECT_EQ(joined.prisms, mixed.prisms);
    EXPECT_EQ(joined.hexes, mixed.hexes);
    EXPECT_EQ(join_split_cells(make_box(2, 3, 1)).hexes, make_box(2, 3, 1).cells);
}

TEST(RefineMixed, RefusesWhatItCannotRefine) {
    const MixedMesh box = make_kuhn_box(1);
    expect_error(ErrorCode::InvalidInput, "levels", [&] { static_cast<void>(refine(box, {.levels = 9})); });
    expect_error(ErrorCode::InvalidInput, "box spline",
                 [&] { static_cast<void>(refine(make_mixed(), {.scheme = TetScheme::Boxspline})); });
    expect_error(ErrorCode::InvalidInput, "no cells", [] { static_cast<void>(refine(MixedMesh{})); });
    MixedMesh bad = box;
    bad.tets[3][1] = 99;
    expect_error(ErrorCode::InvalidInput, "tetrahedron 3", [&] { static_cast<void>(refine(bad)); });
    bad = box;
    bad.creases = {{0, 7}};
    expect_error(ErrorCode::InvalidInput, "crease", [&] { static_cast<void>(refine(bad)); });
    bad = box;
    bad.tets.push_back(bad.tets[0]);
    bad.tets.push_back(bad.tets[0]);
    expect_error(ErrorCode::InvalidInput, "share the face", [&] { static_cast<void>(refine(bad)); });
    bad = box;
    bad.points[2].y = std::nan("");
    expect_error(ErrorCode::InvalidInput, "point 2", [&] { static_cast<void>(refine(bad)); });
    EXPECT_NO_THROW(static_cast<void>(refine(in_tetrahedra(make_mixed()), {.scheme = TetScheme::Boxspline})));
}

}  // namespace refine_mixed_test
}  // namespace subvol
