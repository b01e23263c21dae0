// SPDX-License-Identifier: Apache-2.0
// The approximating schemes: tricubic B-splines where the mesh is regular, their own averages elsewhere.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "lib/stencil_rows.h"
#include "lib/test_meshes.h"
#include "subvol/refine.h"

namespace subvol {
namespace schemes_test {

constexpr double kRounding = 1e-13;  // a few hundred double operations on coordinates of size one

using test::irregular;

/// Two hexahedra that share two faces: the edge between the faces is interior but has no ring.
HexMesh two_about_an_edge() {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.points.emplace_back(-.5, -.5, 0);
    mesh.points.emplace_back(-.5, -.5, 1);
    auto second = mesh.cells[0];
    second[2] = 8;
    second[6] = 9;
    mesh.cells.push_back(second);
    return mesh;
}

/// Two cubes that share an edge only.
HexMesh edge_contact() {
    HexMesh mesh = test::make_box(2, 2, 1);
    mesh.cells = {mesh.cells[0], mesh.cells[3]};
    return without_unused_points(mesh);
}

using test::mean;
using test::mean_at;

class Approximating : public testing::TestWithParam<Scheme> {};

/// The two-scale relation of the cubic B-spline: the weights for the point at half step h of a line of n segments with fixed
/// ends.
std::map<Index, double> spline_weights(Index h, Index n) {
    if (h == 0 || h == 2 * n) return {{h / 2, 1.0}};
    if (h % 2 == 1) return {{h / 2, .5}, {h / 2 + 1, .5}};
    return {{h / 2 - 1, .125}, {h / 2, .75}, {h / 2 + 1, .125}};
}

TEST_P(Approximating, InABoxIsTheTensorProductOfCubicSplines) {
    const Index n = 4;
    const HexMesh mesh = test::make_box(n, n, n);
    const auto rows = test::stencils(build_topology(mesh), {GetParam()});
    const HexMesh split = refine(mesh, {.scheme = {Scheme::Linear}});
    ASSERT_EQ(rows.size(), split.points.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Vec3& x = split.points[i];
        const auto half_step = [](double coordinate) { return static_cast<Index>(std::lround(2 * coordinate)); };
        std::map<Index, double> difference;
        for (const auto& [a, u] : spline_weights(half_step(x.x), n)) {
            for (const auto& [b, v] : spline_weights(half_step(x.y), n)) {
                for (const auto& [c, w] : spline_weights(half_step(x.z), n)) difference[a + 5 * (b + 5 * c)] += u * v * w;
            }
        }
        for (const auto& [p, w] : rows[i]) difference[p] -= w;
        for (const auto& [p, d] : difference) EXPECT_EQ(d, 0) << "point " << i << " from " << p;  // powers of two: exact
    }
}

TEST_P(Approximating, WeightsSumToOneOnAnyMesh) {
    HexMesh creased = test::make_box(2, 2, 2);
    creased.creases = {{0, 1}, {22, 25}};
    for (const HexMesh& mesh : {irregular(), two_about_an_edge(), edge_contact(), creased}) {
        for (const auto& row : test::stencils(build_topology(mesh), {GetParam()})) {
            double sum = 0;
            for (const auto& [p, w] : row) sum += w;
            EXPECT_NEAR(sum, 1, 1e-14);  // some hundred additions of numbers below one
        }
    }
}

TEST_P(Approximating, CommutesWithAffineMaps) {
    const Mat3 a(Vec3(.6, .15, -.2), Vec3(-.1, .45, .25), Vec3(.05, -.3, .7));
    const Vec3 b(.3, -.2, .5);
    const HexMesh mesh = irregular();
    HexMesh moved = mesh;
    for (auto& p : moved.points) p = a * p + b;
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    const HexMesh fine = refine(mesh, options), fine_moved = refine(moved, options);
    for (std::size_t p = 0; p < fine.points.size(); ++p) {
        EXPECT_LT(glm::distance(a * fine.points[p] + b, fine_moved.points[p]), kRounding);
    }
}

TEST_P(Approximating, DoesNotDependOnTheOrderOrTurnOfCells) {
    const HexMesh mesh = irregular();
    HexMesh shuffled = mesh;
    std::reverse(shuffled.cells.begin(), shuffled.cells.end());
    for (auto& cell : shuffled.cells) cell = {cell[1], cell[2], cell[3], cell[0], cell[5], cell[6], cell[7], cell[4]};
    EXPECT_EQ(refine(mesh, {.scheme = {GetParam()}}).points, refine(shuffled, {.scheme = {GetParam()}}).points);  // bitwise
    const auto sorted_points = [](const HexMesh& fine) {
        std::vector<std::array<double, 3>> points;
        for (const auto& p : fine.points) points.push_back({p.x, p.y, p.z});
        std::sort(points.begin(), points.end());
        return points;
    };
    const RefineOptions twice{.scheme = {GetParam()}, .levels = 2};
    EXPECT_EQ(sorted_points(refine(mesh, twice)), sorted_points(refine(shuffled, twice)));
}

TEST_P(Approximating, DoesNotDependOnTheNumberOfThreads) {
    const HexMesh mesh = irregular();
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return refine(mesh, {.scheme = {GetParam()}, .levels = 3});
    };
    const HexMesh one = run(1), four = run(4);
    EXPECT_EQ(one.points, four.points);
    EXPECT_EQ(one.cells, four.cells);
}

// A tricubic spline with the control values x² is x² + 1/3: on every level the limit mask must give that, and the linear terms
// as they are.
TEST_P(Approximating, ConvergesToTheTricubicSpline) {
    const Index n = 6;
    HexMesh mesh = test::make_box(n, n, n);
    const auto quadratic = [](const Vec3& p) { return p.x * p.x + 2 * p.y * p.y - p.z * p.z + p.x * p.y - 3 * p.z; };
    const double shift = (1 + 2 - 1) / 3.0;
    test::add_field(mesh, "f", quadratic);
    for (int level = 0; level <= 2; ++level) {
        const HexMesh fine = refine(mesh, {.scheme = {GetParam()}, .levels = level});
        const double per_unit = 1 << level;
        using Key = std::array<long, 3>;
        std::map<Key, double> values;
        for (std::size_t p = 0; p < fine.points.size(); ++p) {
            const Vec3 x = per_unit * fine.points[p];
            values[{std::lround(x.x), std::lround(x.y), std::lround(x.z)}] = fine.attributes[0].values[p];
            EXPECT_LT(glm::distance(x, glm::round(x)), 1e-12);  // linear precision: the lattice stays a lattice
        }
        const auto inside = [&](long i) { return i >= std::lround(per_unit) && i <= std::lround((n - 1) * per_unit); };
        constexpr std::array<double, 3> kLimit{1.0 / 6, 4.0 / 6, 1.0 / 6};
        for (const auto& [key, value] : values) {
            // One cell away from the boundary, where the spline has fixed ends.
            if (!std::all_of(key.begin(), key.end(), inside)) continue;
            double limit = 0;
            for (long t = 0; t < 27; ++t) {
                const long i = t % 3, j = t / 3 % 3, k = t / 9;
                limit += kLimit[std::size_t(i)] * kLimit[std::size_t(j)] * kLimit[std::size_t(k)] *
                         values.at({key[0] + i - 1, key[1] + j - 1, key[2] + k - 1});
            }
            const Vec3 x = Vec3(key[0], key[1], key[2]) / per_unit;
            EXPECT_NEAR(limit, quadratic(x) + shift, 1e-12);  // values up to 100
        }
    }
}

TEST_P(Approximating, KeepsTheFacesCreasesAndCornersOfABox) {
    const Index n = 3;
    HexMesh mesh = test::make_box(n, n, n);
    HexMesh moved = mesh;
    test::jitter(moved, .2, 3);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        for (int a = 0; a < 3; ++a) {
            const double x = mesh.points[p][a];
            if (x > 0 && x < n) mesh.points[p][a] = moved.points[p][a];
        }
    }
    const HexMesh fine = refine(mesh, {.scheme = {GetParam()}, .levels = 2});
    const Topology topology = build_topology(fine);
    const auto on_side = [&](const Vec3& p, int a) { return p[a] == 0 || std::abs(p[a] - n) < kRounding; };
    const auto sides = [&](const Vec3& p) { return on_side(p, 0) + on_side(p, 1) + on_side(p, 2); };
    for (std::size_t p = 0; p < fine.points.size(); ++p) {
        EXPECT_EQ(topology.point_on_boundary[p] != 0, sides(fine.points[p]) > 0);
    }
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        if (!topology.edge_is_crease[e]) continue;
        for (const Index p : topology.edges[e]) EXPECT_GE(sides(fine.points[p]), 2);
    }
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        if (sides(mesh.points[p]) < 3) continue;
        EXPECT_EQ(fine.points[p], mesh.points[p]);
    }
}

TEST_P(Approximating, TheBoundaryDoesNotDependOnTheInterior) {
    const HexMesh mesh = irregular();
    const Topology topology = build_topology(mesh);
    HexMesh other = mesh;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        if (!topology.point_on_boundary[p]) other.points[p] += Vec3(.05, -.1, .2);
    }
    const HexMesh a = refine(mesh, {.scheme = {GetParam()}}), b = refine(other, {.scheme = {GetParam()}});
    const Topology fine = build_topology(a);
    for (std::size_t p = 0; p < a.points.size(); ++p) {
        EXPECT_EQ(a.points[p] == b.points[p], fine.point_on_boundary[p] != 0);
    }
}

TEST_P(Approximating, TaggedCreasesStaySharp) {
    // A ridge of two columns, smooth by default. If it is tagged, its ends have three creases and are corners.
    HexMesh mesh = test::make_box(2, 1, 3);
    for (auto& p : mesh.points) p.y += p.x == 1 ? .8 : 0;
    const auto ridge_points = [](const HexMesh& m) {
        return std::count_if(m.points.begin(), m.points.end(), [](const Vec3& p) { return std::abs(p.y - 1.8) < kRounding; });
    };
    const RefineOptions smooth{.scheme = {GetParam()}, .levels = 2};
    RefineOptions sharp = smooth;
    sharp.scheme.crease_angle_deg = 40;
    EXPECT_EQ(ridge_points(refine(mesh, smooth)), 0);
    EXPECT_EQ(ridge_points(refine(mesh, sharp)), 4 * 3 + 1);
}

TEST_P(Approximating, SharpFacesSeparateTheirTwoSides) {
    const HexMesh box = test::make_box(4, 3, 3), split = refine(box, {.scheme = {Scheme::Linear}});
    HexMesh mesh = box;
    test::jitter(mesh, .1, 11);
    for (Index k = 0; k < 3; ++k) {
        for (Index j = 0; j < 3; ++j) {
            const Index a = 2 + 5 * (j + 4 * k);  // in the plane x = 2
            mesh.sharp_faces.push_back({a, a + 5, a + 25, a + 20});
        }
    }
    HexMesh other = mesh;
    for (std::size_t p = 0; p < box.points.size(); ++p) {
        if (box.points[p].x < 2) other.points[p] += Vec3(-.3, .1, .2);
    }
    const HexMesh a = refine(mesh, {.scheme = {GetParam()}}), b = refine(other, {.scheme = {GetParam()}});
    for (std::size_t p = 0; p < a.points.size(); ++p) EXPECT_EQ(a.points[p] == b.points[p], split.points[p].x >= 2);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Approximating, testing::Values(Scheme::CatmullClark, Scheme::Bsxw),
                         [](const auto& each) { return each.param == Scheme::CatmullClark ? "CatmullClark" : "Bsxw"; });

// The scheme as published: a trilinear split, then means of centroids; on the boundary and on creases of theirs alone.
TEST(Bsxw, IsASplitAndAnAverage) {
    HexMesh creased = test::make_box(3, 2, 2);
    test::jitter(creased, .1, 5);
    creased.creases = {{1, 5}, {5, 9}};
    for (const HexMesh& mesh : {irregular(), creased, two_about_an_edge()}) {
        const HexMesh fine = refine(mesh, {.scheme = {Scheme::Bsxw}}), split = refine(mesh, {.scheme = {Scheme::Linear}});
        const Topology topology = build_topology(split);
        std::vector<std::vector<Vec3>> hexes(split.points.size()), quads(hexes), segments(hexes);
        for (const auto& cell : split.cells) {
            for (const Index p : cell) hexes[p].push_back(mean_at(split.points, cell));
        }
        for (std::size_t f = 0; f < topology.faces.size(); ++f) {
            if (!topology.face_on_boundary(static_cast<Index>(f))) continue;
            for (const Index p : topology.faces[f]) quads[p].push_back(mean_at(split.points, topology.faces[f]));
        }
        for (std::size_t e = 0; e < topology.edges.size(); ++e) {
            if (!topology.edge_is_crease[e]) continue;
            for (const Index p : topology.edges[e]) segments[p].push_back(mean_at(split.points, topology.edges[e]));
        }
        for (std::size_t p = 0; p < split.points.size(); ++p) {
            const bool corner = segments[p].size() != 0 && segments[p].size() != 2;
            const auto& stratum = !segments[p].empty() ? segments[p] : !quads[p].empty() ? quads[p] : hexes[p];
            EXPECT_LT(glm::distance(fine.points[p], corner ? split.points[p] : mean(stratum)), kRounding) << p;
        }
    }
}

}  // namespace schemes_test
}  // namespace subvol
