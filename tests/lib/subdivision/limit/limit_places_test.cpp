// SPDX-License-Identifier: Apache-2.0
// Places of the limit are found from class to class. The vertices of a fine refined mesh are the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <thread>

#include "lib/subdivision/mixed/mixed_meshes.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/probe.h"
#include "subvol/refine.h"

namespace subvol {
namespace limit_places_test {

constexpr int kLevels = 4;

/// The lowest corner of the level-4 descendant of a cell that begins at uvw, in sixteenths.
Index vertex_at(const HexMesh& fine, Index cell, const std::array<Index, 3>& uvw) {
    constexpr std::array<Index, 8> kChild{0, 1, 3, 2, 4, 5, 7, 6};
    for (int level = kLevels - 1; level >= 0; --level) {
        const std::size_t octant = (uvw[0] >> level & 1) + 2 * (uvw[1] >> level & 1) + 4 * (uvw[2] >> level & 1);
        cell = 8 * cell + kChild[octant];
    }
    return fine.cells[cell][0];
}

/// Asserts that places at vertices of level 4 are those of the refined mesh on the limit.
void expect_fine_vertices(HexMesh mesh, const SchemeOptions& scheme, double tolerance) {
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x) * p.y + p.z; });
    mesh.attributes.push_back({"v", 3, {}});  // more channels than fit into one vector
    for (const Vec3& p : mesh.points)
        mesh.attributes.back().values.insert(mesh.attributes.back().values.end(), {p.z, p.x * p.y, 1});
    const HexMesh fine = on_limit(refine(mesh, {.scheme = scheme, .levels = kLevels}), scheme.kind);
    std::mt19937 random(4);
    std::vector<LimitQuery> queries;
    std::vector<Index> vertices;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (int i = 0; i < 3; ++i) {
            const auto sixteenth = [&] { return static_cast<Index>(random() % 16); };
            const std::array<Index, 3> at{sixteenth(), sixteenth(), sixteenth()};
            queries.push_back({c, Vec3(at[0], at[1], at[2]) / 16.0});
            vertices.push_back(vertex_at(fine, c, at));
        }
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = scheme, .tolerance = 1e-9, .max_levels = 14});
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_NEAR(glm::distance(samples.positions[q], fine.points[vertices[q]]), 0, tolerance) << q;
        EXPECT_NEAR(samples.attributes[0].values[q], fine.attributes[0].values[vertices[q]], tolerance);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(samples.attributes[1].values[3 * q + c], fine.attributes[1].values[3 * vertices[q] + c], tolerance);
        }
    }
}

// A dyadic place is a vertex of MCQ, which stays where it is. Splines converge to their limit, to 1e-9 of the diagonal and a
// few times that where neither a spline nor a class of regular children is near.
double tolerance_of(Scheme scheme) {
    return interpolates(scheme) ? 1e-13 : 1e-7;
}

class LimitPlaces : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, LimitPlaces,
                         testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(LimitPlaces, AreFineVerticesAboutIrregularEdges) {
    expect_fine_vertices(test::irregular(), {GetParam()}, tolerance_of(GetParam()));
}

TEST_P(LimitPlaces, AreFineVerticesWhateverTheAxesOfTheCells) {
    // Each cell turned by one of the 24 rotations: neighbours' axes do not agree.
    constexpr std::array<std::array<std::size_t, 8>, 3> kTurns{
        {{1, 2, 3, 0, 5, 6, 7, 4}, {4, 5, 1, 0, 7, 6, 2, 3}, {1, 5, 6, 2, 0, 4, 7, 3}}};  // about w, u, v
    HexMesh mesh = test::make_box(5, 5, 5);
    test::jitter(mesh, .15, 8);
    std::mt19937 random(2);
    for (auto& cell : mesh.cells) {
        for (int i = 0; i < 4; ++i) {
            const auto& turn = kTurns[random() % 3];
            const auto before = cell;
            for (std::size_t k = 0; k < 8; ++k) cell[k] = before[turn[k]];
        }
    }
    expect_fine_vertices(mesh, {GetParam()}, tolerance_of(GetParam()));
}

TEST_P(LimitPlaces, AreFineVerticesAtCreasesAndSharpFaces) {
    HexMesh mesh = test::make_box(4, 3, 3);
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 4 * k); };
    for (Index i = 0; i < 4; ++i) mesh.creases.push_back({id(i, 1, 3), id(i + 1, 1, 3)});  // along the top
    for (Index j = 0; j < 3; ++j) {
        for (Index k = 0; k < 3; ++k)
            mesh.sharp_faces.push_back({id(2, j, k), id(2, j + 1, k), id(2, j + 1, k + 1), id(2, j, k + 1)});
    }
    test::jitter(mesh, .1, 6);
    expect_fine_vertices(mesh, {GetParam()}, tolerance_of(GetParam()));
}

TEST_P(LimitPlaces, AreFineVerticesInTheCornersThatSharpFacesMake) {
    // On either side of the sharp faces is the corner of a box, in which no new point of a spline leaves the trilinear cell.
    HexMesh mesh = test::make_box(2, 2, 2);
    for (const Index j : {0U, 1U}) mesh.sharp_faces.push_back({1 + 3 * j, 4 + 3 * j, 13 + 3 * j, 10 + 3 * j});
    test::jitter(mesh, .1, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y - p.z * p.z; });
    const HexMesh fine = on_limit(refine(mesh, {.scheme = {GetParam()}, .levels = kLevels}), GetParam());
    std::vector<LimitQuery> queries;
    std::vector<Index> vertices;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (Index n = 0; n < 64; ++n) {  // about every corner, a sixteenth or two from it
            const auto near = [&](Index k) { return std::array<Index, 4>{1, 2, 14, 15}[n >> 2 * k & 3]; };
            const std::array<Index, 3> at{near(0), near(1), near(2)};
            queries.push_back({c, Vec3(at[0], at[1], at[2]) / 16.0});
            vertices.push_back(vertex_at(fine, c, at));
        }
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {GetParam()}, .tolerance = 1e-9, .max_levels = 14});
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_NEAR(glm::distance(samples.positions[q], fine.points[vertices[q]]), 0, tolerance_of(GetParam())) << q;
    }
}

TEST_P(LimitPlaces, AreFineVerticesWhereCellsMeetAtAPointOnly) {
    HexMesh mesh = test::make_box(4, 4, 4);
    std::erase_if(mesh.cells, [&](const std::array<Index, 8>& cell) {
        const Vec3 p = mesh.points[cell[0]];
        return !(p.x < 2 && p.y < 2 && p.z < 2) && !(p.x >= 2 && p.y >= 2 && p.z >= 2);
    });
    mesh = without_unused_points(std::move(mesh));
    test::jitter(mesh, .1, 5);
    expect_fine_vertices(mesh, {GetParam()}, tolerance_of(GetParam()));
}

/// Two layers of so many cells around an axis that no neighbourhood has a class before it has left the axis.
HexMesh axis_of(Index around) {
    HexMesh mesh;
    for (const double z : {0.0, 1.0, 2.0}) {
        mesh.points.emplace_back(0, 0, z);
        for (Index k = 0; k < 2 * around; ++k) {
            const double angle = std::numbers::pi * k / around;
            mesh.points.emplace_back(std::cos(angle), std::sin(angle), z);
        }
    }
    const Index layer = 1 + 2 * around;
    for (const Index low : {Index{0}, layer}) {
        for (Index k = 0; k < around; ++k) {
            const std::array<Index, 4> quad{low, low + 1 + 2 * k, low + 2 + 2 * k, low + 1 + (2 * k + 2) % (2 * around)};
            auto& cell = mesh.cells.emplace_back();
            for (std::size_t i = 0; i < 4; ++i) {
                cell[i] = quad[i];
                cell[i + 4] = quad[i] + layer;
            }
        }
    }
    return mesh;
}

TEST(LimitOfMcq, HasTheVerticesAroundAnAxisOfManyCells) {
    expect_fine_vertices(axis_of(80), {Scheme::Mcq}, 1e-12);
}

TEST(LimitOfMcq, IsTheSameAroundAnAxisWhateverHasBeenRefinedBefore) {
    HexMesh mesh = axis_of(50);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y + p.z; });
    std::mt19937 random(8);
    std::uniform_real_distribution<double> part(0, 1);
    std::vector<LimitQuery> queries;
    for (Index n = 0; n < 60; ++n) {
        const double near = std::pow(part(random), 6);  // most of them next to the axis
        queries.push_back({n * 7 % 100, {near, near * part(random), part(random)}});
    }
    const LimitSamples together = evaluate_limit(mesh, queries);
    const LimitEvaluator limit(mesh);
    const LimitEvaluator alone(mesh);
    const LimitSamples all = limit.at(queries);
    for (std::size_t q = queries.size(); q-- > 0;) {  // the last first: other patches than those of all places
        const LimitSamples one = alone.at(std::span(queries).subspan(q, 1));
        ASSERT_EQ(one.positions[0], all.positions[q]) << q;
        ASSERT_EQ(one.jacobians[0], all.jacobians[q]) << q;
        ASSERT_EQ(one.attributes[0].values[0], all.attributes[0].values[q]) << q;
        ASSERT_EQ(together.positions[q], all.positions[q]) << q;
    }
    const LimitSamples again = limit.at(queries);
    EXPECT_EQ(again.positions, all.positions);
    EXPECT_EQ(again.attributes[0].values, all.attributes[0].values);
}

// The boxes of thin wedges overlap: a place lies in those of a quarter of all, but it is found in the one that has it.
TEST(LimitOfMcq, IsFoundInThinWedgesAroundAnAxis) {
    HexMesh mesh = axis_of(120);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.z + 2 * p.x; });
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); c += 3) queries.push_back({c, {0.7, 0.4, 0.3}});
    const LimitSamples samples = evaluate_limit(mesh, queries);
    const ProbeResult found = LimitProbe(mesh).at(samples.positions);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_EQ(found.cells[q], queries[q].cell) << q;
        EXPECT_NEAR(glm::distance(found.parameters[q], queries[q].uvw), 0, 2e-3)
            << q;  // 1e-6 of the size across a wedge of 1/20
        EXPECT_NEAR(found.fields[0].values[q], samples.attributes[0].values[q], 1e-5) << q;
    }
    const ProbeResult outside = LimitProbe(mesh).at(std::vector<Vec3>{{0.75, 0.75, 1}, {0, 0, 2.1}, {-0.9, 0.5, 0.5}});
    for (std::size_t p = 0; p < 3; ++p) EXPECT_FALSE(outside.inside(p)) << p;
}

TEST_P(LimitPlaces, AreFineVerticesWhereCellsMeetAtAnEdgeOnly) {
    // No walk across faces comes from one cell to the other: no class.
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.cells = {mesh.cells[0], mesh.cells[3], mesh.cells[4]};
    mesh = without_unused_points(std::move(mesh));
    test::jitter(mesh, .1, 3);
    expect_fine_vertices(mesh, {GetParam()}, tolerance_of(GetParam()));
}

/// Asserts that places at vertices of level 4 of MCQ are those of some refined cells, relative to the size of the mesh.
void expect_vertices_of_cells(HexMesh mesh, std::size_t count) {
    mesh.attributes.clear();
    const double size = bounds(mesh).diagonal();
    test::add_field(mesh, "f", [&](const Vec3& p) { return std::sin(9 * p.x / size) * p.y / size + p.z / size; });
    std::vector<Index> cells;
    for (std::size_t i = 0; i < count; ++i) cells.push_back(static_cast<Index>(i * mesh.cells.size() / count));
    const HexMesh fine = refine_cells(mesh, cells, {.levels = kLevels});
    std::mt19937 random(6);
    std::vector<LimitQuery> queries;
    std::vector<Index> vertices;
    for (Index c = 0; c < cells.size(); ++c) {
        for (int i = 0; i < 20; ++i) {
            const auto sixteenth = [&] { return static_cast<Index>(random() % 16); };
            const std::array<Index, 3> at{sixteenth(), sixteenth(), sixteenth()};
            queries.push_back({cells[c], Vec3(at[0], at[1], at[2]) / 16.0});
            vertices.push_back(vertex_at(fine, c, at));
        }
    }
    // Two levels beyond that of the vertices in any case: nothing is left to the tolerance.
    const LimitSamples samples = evaluate_limit(mesh, queries, {.tolerance = 0, .max_levels = 6});
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_NEAR(glm::distance(samples.positions[q], fine.points[vertices[q]]), 0, 1e-13 * size) << q;
        EXPECT_NEAR(samples.attributes[0].values[q], fine.attributes[0].values[vertices[q]], 1e-13) << q;
    }
}

TEST(LimitOfMcq, HasTheVerticesOfRefinedModels) {
    expect_vertices_of_cells(make_model("ball", 4), 60);
    expect_vertices_of_cells(make_model("pawn", 12), 60);
    expect_vertices_of_cells(make_model("twist", 6), 60);
}

TEST(LimitOfMcq, HasTheVerticesOfRefinedIrregularMeshes) {
    expect_vertices_of_cells(make_model("nozzle", 12), 60);
    // A ball of tetrahedra, each in four hexahedra: lines of three, four and six cells, which meet in every middle of a face.
    expect_vertices_of_cells(in_hexahedra(test::make_tet_ball(4)), 80);
}

TEST(LimitOfMcq, HasTheVerticesOfARefinedRealMesh) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    expect_vertices_of_cells(read_mesh(*data / "sibl_bunny_conforming.mesh").mesh, 80);
}

/// Places in all cells of a mesh.
std::vector<LimitQuery> scattered(const HexMesh& mesh, unsigned seed, std::size_t count = 2000) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> t(0, 1);
    std::vector<LimitQuery> queries(count);
    for (LimitQuery& query : queries)
        query = {static_cast<Index>(random() % mesh.cells.size()), {t(random), t(random), t(random)}};
    return queries;
}

TEST_P(LimitPlaces, OfAnEvaluatorAreTheSameInEveryCall) {
    // The first call meets classes, and refines parts of cells, that the second finds there; several threads call at once.
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y - p.z; });
    const LimitOptions options{.scheme = {GetParam()}, .tolerance = 1e-5};
    const LimitEvaluator evaluator(mesh, options);
    const auto expect_same = [&](unsigned seed, std::size_t count) {
        const auto queries = scattered(mesh, seed, count);
        const LimitSamples kept = evaluator.at(queries), anew = evaluate_limit(mesh, queries, options);
        EXPECT_EQ(kept.positions, anew.positions);
        EXPECT_EQ(kept.jacobians, anew.jacobians);
        EXPECT_EQ(kept.attributes[0].values, anew.attributes[0].values);
        EXPECT_EQ(kept.report.refined, anew.report.refined);
    };
    for (const unsigned seed : {4U, 5U}) expect_same(seed, 30);
    {
        std::vector<std::jthread> threads;
        for (const unsigned seed : {1U, 2U, 3U}) threads.emplace_back(expect_same, seed, 500 * seed);
    }
    expect_same(1, 2000);
    EXPECT_EQ(evaluator.at({}).positions.size(), 0U);
}

TEST_P(LimitPlaces, ApproachAPosition) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y - p.z; });
    const LimitEvaluator evaluator(mesh, {.scheme = {GetParam()}, .tolerance = 1e-8, .max_levels = 14});
    const auto places = scattered(mesh, 3);
    const std::vector<Vec3> targets = evaluator.at(places).positions;
    std::vector<LimitQuery> queries = places;
    for (LimitQuery& query : queries) query.uvw = glm::clamp(query.uvw + Vec3(.01, -.02, .015), Vec3(0), Vec3(1));
    const std::vector<Vec3> before = evaluator.at(queries).positions;
    const LimitSamples samples = evaluator.approach(queries, targets);
    const LimitSamples there = evaluator.at(queries);
    double far_before = 0, far = 0;
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_EQ(queries[q].cell, places[q].cell);
        // Both are of the limit at the same place, to about the tolerance.
        EXPECT_NEAR(glm::distance(samples.positions[q], there.positions[q]), 0, 1e-6);
        EXPECT_NEAR(samples.attributes[0].values[q], there.attributes[0].values[q], 1e-6);
        far_before += glm::distance(before[q], targets[q]);
        far += glm::distance(samples.positions[q], targets[q]);
    }
    EXPECT_LT(far, .1 * far_before);  // a place near the side of an octant stops there
    // A place that is there stays, and so does one whose target is nowhere.
    std::vector<LimitQuery> two{places[0], places[1]};
    (void)evaluator.approach(two, std::vector<Vec3>{targets[0], {NAN, 0, 0}});
    EXPECT_NEAR(glm::distance(two[0].uvw, places[0].uvw), 0, 1e-3);
    EXPECT_EQ(two[1].uvw, places[1].uvw);
    EXPECT_THROW((void)evaluator.approach(two, std::span(targets).first(1)), Error);
}

TEST(LimitInOneCell, IsTheSameForManyPlaces) {
    // More places than one batch takes, all in one irregular cell: each is the same as alone.
    HexMesh mesh = test::irregular();
    std::vector<LimitQuery> queries;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> t(0, 1);
    for (int i = 0; i < 270000; ++i) queries.push_back({3, {t(random), t(random), t(random)}});
    const LimitOptions options{.tolerance = 1e-4, .max_levels = 4};
    const LimitSamples samples = evaluate_limit(mesh, queries, options);
    for (const std::size_t q : {std::size_t{0}, std::size_t{150000}, std::size_t{269999}}) {
        const LimitSamples alone = evaluate_limit(mesh, std::span(queries).subspan(q, 1), options);
        EXPECT_EQ(alone.positions[0], samples.positions[q]);
        EXPECT_EQ(alone.jacobians[0], samples.jacobians[q]);
    }
    EXPECT_EQ(samples.report.refined, queries.size());
}

/// Asserts that the first of many places in a cell are the same as alone, to the bit.
void expect_the_same_alone(const HexMesh& mesh, Index cell, const LimitOptions& options) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> t(0, 1);
    std::vector<LimitQuery> queries;
    for (int i = 0; i < 300; ++i) queries.push_back({cell, {t(random), t(random), t(random)}});
    const LimitSamples samples = evaluate_limit(mesh, queries, options);
    for (std::size_t q = 0; q < 40; ++q) {
        const LimitSamples alone = evaluate_limit(mesh, std::span(queries).subspan(q, 1), options);
        EXPECT_EQ(alone.positions[0], samples.positions[q]);
        EXPECT_EQ(alone.jacobians[0], samples.jacobians[q]);
        EXPECT_EQ(alone.attributes[0].values[0], samples.attributes[0].values[q]);
    }
}

TEST(LimitInOneCellOfAGrid, IsTheSameForManyPlaces) {
    // Many places share two levels of the cell's refinement; a single one has only those points made that it needs.
    HexMesh mesh = test::make_box(5, 5, 5);
    test::jitter(mesh, .2, 5);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) * p.y + p.z; });
    expect_the_same_alone(mesh, 62, {.tolerance = 1e-9, .max_levels = 8});  // in the middle
    expect_the_same_alone(mesh, 0, {.tolerance = 1e-9, .max_levels = 8});   // at the boundary
}

TEST(LimitInAGrid, IsTheSameByBlocksAsByRefinement) {
    // The regular masks in blocks against the rows of the scheme, with more channels than a vector has and another tension.
    HexMesh mesh = test::make_box(5, 5, 5);
    test::jitter(mesh, .2, 5);
    expect_fine_vertices(mesh, {.tension = 1. / 20}, tolerance_of(Scheme::Mcq));
}

}  // namespace limit_places_test
}  // namespace subvol
