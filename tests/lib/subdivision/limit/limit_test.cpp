// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/random_vector.h"
#include "lib/test_meshes.h"
#include "subvol/limit_level.h"

namespace subvol {
namespace limit_test {

/// A box of n³ cells from the origin with 1 at one point and 0 elsewhere.
HexMesh impulse(Index n, const Vec3& where) {
    HexMesh mesh = test::make_box(n, n, n);
    test::add_field(mesh, "phi", [&](const Vec3& p) { return p == where ? 1.0 : 0.0; });
    return mesh;
}

/// The query for a point of such a box.
LimitQuery in_box(Index n, const Vec3& p) {
    const auto cell = [&](double x) { return std::min(static_cast<Index>(x), n - 1); };
    const Index i = cell(p.x), j = cell(p.y), k = cell(p.z);
    return {i + n * (j + n * k), p - Vec3(i, j, k)};
}

std::vector<LimitQuery> random_queries(const HexMesh& mesh, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> t(0, 1);
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < count; ++i) {
        queries.push_back({static_cast<Index>(random() % mesh.cells.size()), {t(random), t(random), t(random)}});
    }
    return queries;
}

HexMesh irregular() {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .04, 11);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x + p.y) + p.z; });
    return mesh;
}

TEST(LimitMcq, TakesTheExactValuesOfTheBasisFunction) {
    const Vec3 center(4, 4, 4);
    const std::vector<std::pair<Vec3, double>> known{
        {{0, 0, 0}, 1},
        {{.5, 0, 0}, 1. / 2},
        {{.5, .5, 0}, 9. / 32},
        {{.5, .5, .5}, 11. / 64},
        {{.25, 0, 0}, .7802734375},
        {{1.5, 0, 0}, 0},
        {{.5, 1, 0}, 1. / 64},
        {{1.5, 1, 0}, -1. / 64},
        {{1.5, .5, 0}, -1. / 64},
        {{1.5, .5, .5}, -1. / 64},
        {{1.5, .5, 1}, -1. / 128},
        {{.5, 1, 1}, 0},
        {{.75, 0, 0}, 61. / 256},
        {{1.25, 0, 0}, -9. / 512},
        {{.25, .25, 0}, 1311. / 2048},
        {{.25, .25, .25}, 2229. / 4096},
        {{37. / 32, 0, 0}, -.02150755375623703},
    };
    std::vector<LimitQuery> queries;
    for (const auto& [offset, value] : known) queries.push_back(in_box(8, center + offset));
    const LimitSamples samples = evaluate_limit(impulse(8, center), queries);
    for (std::size_t i = 0; i < known.size(); ++i) {
        // Dyadic places are vertices of some level: nothing is interpolated there.
        EXPECT_NEAR(samples.attributes[0].values[i], known[i].second, 1e-15) << i;
        EXPECT_NEAR(glm::distance(samples.positions[i], center + known[i].first), 0, 1e-14);
    }
}

TEST(LimitMcq, ReproducesCubicsWithTheirGradients) {
    const Index n = 6;
    HexMesh mesh = test::make_box(n, n, n);
    const auto f = [](const Vec3& p) { return p.x * p.x * p.x - 2 * p.x * p.y * p.z + p.y * p.y * p.z - p.z + 1; };
    test::add_field(mesh, "f", f);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> inside(2, n - 2);  // at every level the boundary affects a cell of that level
    std::vector<LimitQuery> queries;
    std::vector<Vec3> places;
    for (int i = 0; i < 200; ++i) {
        places.push_back(test::random_vector(inside, random));
        queries.push_back(in_box(n, places.back()));
    }
    const LimitSamples samples = evaluate_limit(mesh, queries);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3& p = places[i];
        const Vec3 gradient(3 * p.x * p.x - 2 * p.y * p.z, -2 * p.x * p.z + 2 * p.y * p.z, -2 * p.x * p.y + p.y * p.y - 1);
        EXPECT_NEAR(samples.attributes[0].values[i], f(p), 1e-11);  // values to 200
        EXPECT_NEAR(glm::distance(samples.attributes[0].derivatives[i], gradient), 0, 1e-10);
    }
    EXPECT_EQ(samples.report.unconverged, 0u);
}

/// A box of 4³ unit cells with random values in [-1, 1] at its points.
HexMesh random_values() {
    HexMesh mesh = test::make_box(4, 4, 4);
    std::mt19937 random(66);
    std::uniform_real_distribution<double> value(-1, 1);
    test::add_field(mesh, "f", [&](const Vec3&) { return value(random); });
    return mesh;
}

/// A place in all cells around it, moved into each by a part of the cell.
std::vector<LimitQuery> from_all_cells(const Vec3& place, double inwards) {
    std::vector<LimitQuery> queries;
    for (Index cell = 0; cell < 64; ++cell) {
        const Vec3 uvw = place - Vec3(cell % 4, cell / 4 % 4, cell / 16);
        if (uvw != glm::clamp(uvw, Vec3(0.0), Vec3(1.0))) continue;
        queries.push_back({cell, uvw + inwards * (Vec3(0.5) - uvw)});
    }
    return queries;
}

// The limit is C1: one gradient at a point, on an edge and on a face, that of the fine vertices around it.
TEST(LimitMcq, HasOneGradientOnAllSidesOfAPlace) {
    const HexMesh mesh = random_values(), fine = refine(mesh, {.levels = 4});
    constexpr int kSide = 65;
    std::vector<double> values(kSide * kSide * kSide);
    const auto at = [&](const Vec3& p) -> double& {
        const auto n = [](double x) { return static_cast<std::size_t>(std::lround(16 * x)); };
        return values[n(p.x) + kSide * (n(p.y) + kSide * n(p.z))];
    };
    for (std::size_t i = 0; i < fine.points.size(); ++i) at(fine.points[i]) = fine.attributes[0].values[i];
    // Central differences are of second order, so that those of levels 3 and 4 together leave some 1e-4.
    const auto exact = [&](const Vec3& p) {
        Vec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            const auto central = [&](double h) {
                Vec3 step(0.0);
                step[axis] = h;
                return (at(p + step) - at(p - step)) / (2 * h);
            };
            gradient[axis] = (4 * central(1. / 16) - central(1. / 8)) / 3;
        }
        return gradient;
    };
    // Two levels differ by 1e-3 of the range, 2, at most; what is left is less than that. With the small tolerance it is what
    // the differences leave.
    for (const auto& [tolerance, inwards, off] :
         std::vector<std::array<double, 3>>{{1e-6, 0, 1e-3}, {1e-6, 2e-6, 1e-3}, {1e-9, 0, 3e-4}}) {
        std::vector<LimitQuery> queries;
        std::vector<Vec3> gradients;
        for (int n = 0; n < 5 * 5 * 5; ++n) {
            const Vec3 place = 0.5 * Vec3(2 + n % 5, 2 + n / 5 % 5, 2 + n / 25);
            for (const LimitQuery& query : from_all_cells(place, inwards)) {
                queries.push_back(query);
                gradients.push_back(exact(place));
            }
        }
        const LimitSamples found = evaluate_limit(mesh, queries, {.tolerance = tolerance, .max_levels = 12});
        for (std::size_t q = 0; q < queries.size(); ++q) {
            EXPECT_NEAR(glm::distance(found.attributes[0].derivatives[q], gradients[q]), 0, off)
                << q << ' ' << tolerance << ' ' << inwards;
        }
    }
}

TEST(LimitMcq, HasOneGradientAnywhereOnASideOfACell) {
    const HexMesh mesh = random_values();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(0, 4);
    std::vector<LimitQuery> queries;
    std::vector<std::size_t> firsts;  // of the queries of the same place
    for (int n = 0; n < 60; ++n) {
        Vec3 place = test::random_vector(anywhere, random);
        for (int axis = 0; axis <= n % 2; ++axis) place[(n + axis) % 3] = n / 2 % 5;  // some of them on the boundary
        const auto of_place = from_all_cells(place, 0);
        firsts.insert(firsts.end(), of_place.size(), queries.size());
        queries.insert(queries.end(), of_place.begin(), of_place.end());
    }
    const LimitSamples found = evaluate_limit(mesh, queries);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        const auto& gradients = found.attributes[0].derivatives;
        // Cells may end at different levels, whose derivatives are within the tolerance of each other.
        EXPECT_NEAR(glm::distance(gradients[q], gradients[firsts[q]]), 0, 2e-3) << q;
    }
}

/// Errors against a much deeper refinement, from level 2 on.
std::vector<double> errors_by_level(const HexMesh& mesh, Scheme scheme, int deepest) {
    const auto queries = random_queries(mesh, 300, 3);
    const auto at = [&](int levels) {
        return evaluate_limit(mesh, queries, {.scheme = {scheme}, .tolerance = 0, .max_levels = levels});
    };
    const LimitSamples truth = at(deepest + 4);
    std::vector<double> errors;
    for (int level = 2; level <= deepest; ++level) {
        const LimitSamples samples = at(level);
        double sum = 0;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            sum += std::pow(glm::distance(samples.positions[i], truth.positions[i]), 2);
        }
        errors.push_back(std::sqrt(sum / static_cast<double>(queries.size())));
    }
    return errors;
}

TEST(LimitMcq, ConvergesWithTheSecondOrder) {
    const auto errors = errors_by_level(irregular(), Scheme::Mcq, 5);
    const double order = std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
    RecordProperty("order", std::to_string(order));
    EXPECT_GT(order, 1.8) << "the limit is C1, its second derivatives diverge logarithmically";
}

TEST(LimitMcq, AgreesWithTheVerticesOfFineLevels) {
    // In a grid the evaluation refines without topology: compared with the refined mesh, in a bent box with another tension.
    HexMesh mesh = test::make_box(6, 6, 6);
    test::jitter(mesh, .2, 6);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x * p.y) + p.z; });
    for (const double tension : {1. / 16, 1. / 25}) {
        const HexMesh fine = refine(mesh, {.scheme = {.tension = tension}, .levels = 3});
        std::vector<LimitQuery> queries;
        for (Index c = 0; c < mesh.cells.size(); ++c) queries.push_back({c, {1. / 8, 5. / 8, 3. / 8}});
        const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {.tension = tension}, .tolerance = 1e-9});
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            // u 001, v 101, w 011 in binary: children by level 3 (v), 4 (w), 6 (u, v, w).
            const Index vertex = fine.cells[512 * c + 0346][0];
            EXPECT_NEAR(glm::distance(samples.positions[c], fine.points[vertex]), 0, 1e-14);
            EXPECT_NEAR(samples.attributes[0].values[c], fine.attributes[0].values[vertex], 1e-14);
        }
    }
}

TEST(LimitMcq, InterpolatesTheControlPoints) {
    const HexMesh mesh = irregular();
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) queries.push_back({c, {1, 1, 0}});
    const LimitSamples samples = evaluate_limit(mesh, queries);
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        EXPECT_EQ(samples.positions[c], mesh.points[mesh.cells[c][2]]);
        EXPECT_EQ(samples.attributes[0].values[c], mesh.attributes[0].values[mesh.cells[c][2]]);
    }
}

class MovingSchemes : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, MovingSchemes, testing::Values(Scheme::CatmullClark, Scheme::Bsxw));

TEST_P(MovingSchemes, RegularCellsAreTricubicSplines) {
    const Index n = 4;
    HexMesh mesh = test::make_box(n, n, n);
    test::add_field(mesh, "square", [](const Vec3& p) { return p.x * p.x; });
    const auto queries = random_queries(mesh, 200, 9);
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {GetParam()}});
    EXPECT_EQ(samples.report.exact, queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Vec3 p = mesh.points[mesh.cells[queries[i].cell][0]] + queries[i].uvw;
        EXPECT_NEAR(glm::distance(samples.positions[i], p), 0, 1e-14);  // linear precision, the boundary included
        EXPECT_NEAR(glm::distance(samples.jacobians[i][1], Vec3(0, 1, 0)), 0, 1e-14);
        if (p.x > 1 && p.x < n - 1) {
            EXPECT_NEAR(samples.attributes[0].values[i], p.x * p.x + 1. / 3, 1e-13);
            EXPECT_NEAR(samples.attributes[0].derivatives[i].x, 2 * p.x, 1e-13);
        }
    }
}

TEST_P(MovingSchemes, ABoxIsExactUpToItsBoundary) {
    // Vertices of the third level, moved to the limit by their stencils, are values of the splines.
    HexMesh mesh = test::make_box(3, 3, 3);
    test::jitter(mesh, .2, 4);
    const RefineOptions options{.scheme = {GetParam()}, .levels = 3};
    const HexMesh fine = on_limit(refine(mesh, options), GetParam());
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) queries.push_back({c, {1. / 8, 0, 0}});
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {GetParam()}});
    EXPECT_EQ(samples.report.exact, queries.size());
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        EXPECT_NEAR(glm::distance(samples.positions[c], fine.points[fine.cells[512 * c][1]]), 0, 1e-14) << c;
    }
}

TEST_P(MovingSchemes, CornersOfIrregularCellsMeetTheLimitStencils) {
    const HexMesh mesh = irregular(), limit = on_limit(mesh, GetParam());
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) queries.push_back({c, {0, 0, 1}});
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {GetParam()}, .tolerance = 1e-9, .max_levels = 16});
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        EXPECT_NEAR(glm::distance(samples.positions[c], limit.points[mesh.cells[c][4]]), 0, 1e-7) << c;
    }
}

TEST_P(MovingSchemes, LimitPointsStayWhereTheyAreUnderRefinement) {
    const HexMesh mesh = irregular();
    const HexMesh coarse = on_limit(mesh, GetParam()), fine = on_limit(refine(mesh, {.scheme = {GetParam()}}), GetParam());
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(glm::distance(coarse.points[p], fine.points[p]), 0, 1e-13);
        EXPECT_NEAR(coarse.attributes[0].values[p], fine.attributes[0].values[p], 1e-13);
    }
}

TEST_P(MovingSchemes, ConvergeWhereTheFirstEstimatesAgree) {
    // In an L of cells the trilinear estimate at odd quarters is the same on the first levels: a cell point is the mean of
    // corners.
    HexMesh mesh = test::make_box(2, 2, 1);
    mesh.cells.pop_back();
    test::jitter(mesh, .05, 1);
    const std::vector<LimitQuery> queries{{0, {.75, .75, .75}}, {1, {.25, .75, .25}}, {2, {.75, .25, .5}}};
    const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {GetParam()}});
    const HexMesh fine = on_limit(refine(mesh, {.scheme = {GetParam()}, .levels = 5}), GetParam());
    const auto at = [&](std::size_t query) {  // the vertex of the fifth level at the same parameters
        std::size_t cell = queries[query].cell;
        Vec3 uvw = queries[query].uvw;
        constexpr std::array<std::size_t, 8> kChild{0, 1, 3, 2, 4, 5, 7, 6};
        for (int level = 0; level < 5; ++level) {
            std::size_t octant = 0;
            for (int a = 0; a < 3; ++a) {
                const bool upper = uvw[a] >= .5;
                octant |= std::size_t{upper} << a;
                uvw[a] = 2 * uvw[a] - (upper ? 1 : 0);
            }
            cell = 8 * cell + kChild[octant];
        }
        return fine.points[fine.cells[cell][0]];
    };
    for (std::size_t q = 0; q < queries.size(); ++q) EXPECT_NEAR(glm::distance(samples.positions[q], at(q)), 0, 2e-5) << q;
}

TEST(LimitMcq, JacobiansConvergeWhereValuesAreExactAtOnce) {
    const HexMesh mesh = irregular();
    std::vector<LimitQuery> dyadic, beside;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        dyadic.push_back({c, {.5, .25, .5}});
        beside.push_back({c, {.5 + 1e-7, .25 + 1e-7, .5 + 1e-7}});
    }
    const LimitSamples a = evaluate_limit(mesh, dyadic),
                       b = evaluate_limit(mesh, beside, {.tolerance = 1e-10, .max_levels = 12});
    for (std::size_t i = 0; i < dyadic.size(); ++i) {
        for (int d = 0; d < 3; ++d) {  // the square root of the tolerance, times the diagonal 3.5, times a few levels
            EXPECT_NEAR(glm::distance(a.jacobians[i][d], b.jacobians[i][d]), 0, .015);
        }
    }
}

TEST_P(MovingSchemes, LimitStencilsAreRightWherePointsOccurTwiceAboutAVertex) {
    HexMesh mesh;  // two cells that share two faces, about an edge with no more cells
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},   {0, 0, 1},
                   {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {-1, -1, 0}, {-1, -1, 1}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 3, 8, 1, 4, 7, 9, 5}};
    const HexMesh coarse = on_limit(mesh, GetParam());
    const HexMesh fine = on_limit(refine(mesh, {.scheme = {GetParam()}, .levels = 2}), GetParam());
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(glm::distance(coarse.points[p], fine.points[p]), 0, 1e-12) << p;
    }
}

TEST(LimitStencils, AreOneFourOneInsideAndSumToOne) {
    const Topology topology = build_topology(test::make_box(4, 4, 4));
    const CsrMatrix rows = limit_stencils(topology, Scheme::CatmullClark).csr();
    const std::size_t center = 2 + 5 * (2 + 5 * 2);
    ASSERT_EQ(rows.offsets[center + 1] - rows.offsets[center], 27u);
    for (std::size_t i = rows.offsets[center], n = 0; i < rows.offsets[center + 1]; ++i, ++n) {
        const auto w = [](std::size_t k) { return k == 1 ? 4. / 6 : 1. / 6; };
        EXPECT_NEAR(rows.weights[i], w(n % 3) * w(n / 3 % 3) * w(n / 9), 1e-15);
    }
    EXPECT_EQ(limit_stencils(topology, Scheme::Mcq).kept(), topology.point_count);
    const CsrMatrix irregular_rows = limit_stencils(build_topology(irregular()), Scheme::Bsxw).csr();
    for (std::size_t r = 0; r + 1 < irregular_rows.offsets.size(); ++r) {
        double sum = 0;
        for (std::size_t i = irregular_rows.offsets[r]; i < irregular_rows.offsets[r + 1]; ++i)
            sum += irregular_rows.weights[i];
        EXPECT_NEAR(sum, 1, 1e-14);
    }
}

class EveryLimit : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, EveryLimit, testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(EveryLimit, JacobiansAreDerivatives) {
    const HexMesh mesh = irregular();
    auto queries = random_queries(mesh, 100, 21);
    for (auto& q : queries) q.uvw = glm::clamp(q.uvw, .02, .98);
    const LimitOptions options{.scheme = {GetParam()}, .tolerance = 1e-8};
    const LimitSamples here = evaluate_limit(mesh, queries, options);
    constexpr double kStep = 1e-3;
    for (int axis = 0; axis < 3; ++axis) {
        auto ahead = queries, behind = queries;
        for (auto& q : ahead) q.uvw[axis] += kStep;
        for (auto& q : behind) q.uvw[axis] -= kStep;
        const LimitSamples a = evaluate_limit(mesh, ahead, options), b = evaluate_limit(mesh, behind, options);
        for (std::size_t i = 0; i < queries.size(); ++i) {
            // Second derivatives are bounded but for logarithms, so the difference quotient errs by a few steps.
            const Vec3 slope = (a.positions[i] - b.positions[i]) / (2 * kStep);
            EXPECT_NEAR(glm::distance(here.jacobians[i][axis], slope), 0, 5e-3);
            const double f_slope = (a.attributes[0].values[i] - b.attributes[0].values[i]) / (2 * kStep);
            EXPECT_NEAR(here.attributes[0].derivatives[i][axis], f_slope, 1e-2);
        }
    }
}

TEST_P(EveryLimit, NeighboursAgreeOnTheirFace) {
    // The same place, evaluated in both cells of a face.
    const HexMesh mesh = irregular();
    const Topology topology = build_topology(mesh);
    std::vector<LimitQuery> from_first, from_second;
    const auto place_in = [&](Index cell, Index face) {  // a quarter from the face's first point to its second and its fourth
        constexpr std::array<Vec3, 8> kCorner{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0},
                                              Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{1, 1, 1}, Vec3{0, 1, 1}};
        const auto corner = [&](Index p) {
            return kCorner[static_cast<std::size_t>(std::find(mesh.cells[cell].begin(), mesh.cells[cell].end(), p) -
                                                    mesh.cells[cell].begin())];
        };
        const auto& q = topology.faces[face];
        return .45 * corner(q[0]) + .3 * corner(q[1]) + .25 * corner(q[3]);
    };
    for (Index f = 0; f < topology.faces.size(); ++f) {
        if (topology.face_on_hull(f)) continue;
        from_first.push_back({topology.face_cells[f][0], place_in(topology.face_cells[f][0], f)});
        from_second.push_back({topology.face_cells[f][1], place_in(topology.face_cells[f][1], f)});
    }
    const LimitOptions options{.scheme = {GetParam()}, .tolerance = 1e-7};
    const LimitSamples a = evaluate_limit(mesh, from_first, options), b = evaluate_limit(mesh, from_second, options);
    for (std::size_t i = 0; i < from_first.size(); ++i) {
        EXPECT_NEAR(glm::distance(a.positions[i], b.positions[i]), 0,
                    2e-6);  // the tolerance times the diagonal, times a few levels
    }
}

TEST(Limit, DoesNotDependOnTheNumberOfThreadsOrOnOtherQueries) {
    const HexMesh mesh = irregular();
    const auto queries = random_queries(mesh, 150, 2);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return evaluate_limit(mesh, queries);
    };
    const LimitSamples one = run(1), four = run(4);
    EXPECT_EQ(one.positions, four.positions);
    const LimitSamples alone = evaluate_limit(mesh, std::span(queries).subspan(77, 1));
    EXPECT_EQ(alone.positions[0], one.positions[77]);
    EXPECT_EQ(alone.attributes[0].values[0], one.attributes[0].values[77]);
}

TEST(LimitLevel, DoesNotLookAtUnusedPoints) {
    HexMesh mesh = test::make_box(3, 3, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; });
    HexMesh filled = mesh;
    for (const double fill : {1e30, -1e30, double{NAN}}) {
        filled.points.push_back(Vec3(fill));
        filled.attributes[0].values.push_back(fill);
    }
    const LimitLevelOptions options{.position_world = 1e-3};
    const LimitLevel level = find_limit_level(mesh, {}, options), with_unused = find_limit_level(filled, {}, options);
    EXPECT_GT(level.level, 1);
    EXPECT_EQ(with_unused.level, level.level);
    EXPECT_EQ(with_unused.value_of_range, level.value_of_range);
    const LimitCellsOptions of_cells{.position_world = 1e-3};
    const LimitCells cells = find_limit_cells(mesh, {}, of_cells), cells_with_unused = find_limit_cells(filled, {}, of_cells);
    EXPECT_GT(std::ranges::max(cells.cell_levels), 1);
    EXPECT_EQ(cells_with_unused.cell_levels, cells.cell_levels);
    EXPECT_EQ(cells_with_unused.value_of_range, cells.value_of_range);
}

TEST(Limit, RefusesPlacesThatDoNotExist) {
    const HexMesh mesh = test::make_box(1, 1, 1);
    test::expect_error(ErrorCode::InvalidInput, "there is no cell 1", [&] {
        (void)evaluate_limit(mesh, std::vector<LimitQuery>{{0, {.5, .5, .5}}, {1, {0, 0, 0}}});
    });
    test::expect_error(ErrorCode::InvalidInput, "outside [0,1]", [&] {
        (void)evaluate_limit(mesh, std::vector<LimitQuery>{{0, {.5, 1.1, .5}}});
    });
}

}  // namespace limit_test
}  // namespace subvol
