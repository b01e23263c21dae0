// SPDX-License-Identifier: Apache-2.0
#include "subvol/refine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/stencil_rows.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"

namespace subvol {
namespace refine_test {

constexpr double kRounding = 1e-13;  // a few hundred double operations on coordinates of size one

using test::irregular;

TEST(Refine, WeightsSumToOneOnAnyMesh) {
    for (const auto& row : test::stencils(build_topology(irregular()))) {
        double sum = 0;
        for (const auto& [p, w] : row) sum += w;
        EXPECT_NEAR(sum, 1, kRounding);
    }
}

TEST(Refine, CommutesWithAffineMaps) {
    const Mat3 a(Vec3(1.2, .3, -.4), Vec3(-.2, .9, .5), Vec3(.1, -.6, 1.4));
    const Vec3 b(3, -2, 5);
    HexMesh mesh = irregular();
    test::add_field(mesh, "linear", [](const Vec3& p) { return 2 * p.x - 3 * p.y + .5 * p.z + 1; });
    HexMesh moved = mesh;
    for (auto& p : moved.points) p = a * p + b;
    const HexMesh fine = refine(mesh, {.levels = 2}), fine_moved = refine(moved, {.levels = 2});
    for (std::size_t p = 0; p < fine.points.size(); ++p) {
        EXPECT_LT(glm::distance(a * fine.points[p] + b, fine_moved.points[p]), 1e-12);  // coordinates of size 5
        const Vec3& x = fine.points[p];
        EXPECT_NEAR(fine.attributes[0].values[p], 2 * x.x - 3 * x.y + .5 * x.z + 1, 1e-12);
    }
}

TEST(Refine, ReproducesCubicsInsideAndQuadraticsEverywhereInABox) {
    const Index n = 6;
    HexMesh mesh = test::make_box(n, n, n);
    const auto cubic = [](const Vec3& p) {
        return p.x * p.x * p.x - 2 * p.x * p.y * p.z + p.y * p.z * p.z + p.z * p.z * p.z - p.x;
    };
    const auto quadratic = [](const Vec3& p) { return p.x * p.x - 3 * p.y * p.z + p.z * p.z + p.x * p.y - p.y; };
    const auto quartic = [](const Vec3& p) { return p.x * p.x * p.x * p.x; };
    test::add_field(mesh, "cubic", cubic);
    test::add_field(mesh, "quadratic", quadratic);
    test::add_field(mesh, "quartic", quartic);
    const HexMesh fine = refine(mesh);
    double worst_quartic = 0;
    for (std::size_t i = 0; i < fine.points.size(); ++i) {
        const Vec3& p = fine.points[i];
        EXPECT_NEAR(fine.attributes[1].values[i], quadratic(p), 1e-11);  // values up to 200
        const bool inside = glm::all(glm::greaterThanEqual(p, Vec3(1))) && glm::all(glm::lessThanEqual(p, Vec3(n - 1)));
        if (inside) {
            EXPECT_NEAR(fine.attributes[0].values[i], cubic(p), 1e-11);
            worst_quartic = std::max(worst_quartic, std::abs(fine.attributes[2].values[i] - quartic(p)));
        }
    }
    EXPECT_GT(worst_quartic, .1) << "degree 4 is beyond the scheme: 9/16 at an edge's middle";
}

TEST(Refine, LeavesParentsUntouched) {
    HexMesh mesh = irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x + 2 * p.y) * p.z; });
    const HexMesh fine = refine(mesh, {.levels = 2});
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_EQ(fine.points[p], mesh.points[p]);
        EXPECT_EQ(fine.attributes[0].values[p], mesh.attributes[0].values[p]);
    }
}

TEST(Refine, SplitsCellsAsCounted) {
    const HexMesh mesh = irregular();
    const auto report = inspect(mesh);
    const HexMesh once = refine(mesh), twice = refine(mesh, {.levels = 2});
    EXPECT_EQ(once.points.size(), report.points + report.edges + report.faces + report.cells);
    EXPECT_EQ(twice.cells.size(), 64 * report.cells);
    const auto fine = inspect(once);
    EXPECT_EQ(fine.edges, 2 * report.edges + 4 * report.faces + 6 * report.cells);
    EXPECT_EQ(fine.faces, 4 * report.faces + 12 * report.cells);
    EXPECT_EQ(fine.inverted_cells, 0u);
}

TEST(Refine, TwoLevelsAreOneLevelTwice) {
    HexMesh mesh = irregular();
    mesh.attributes.push_back({"v", 2, std::vector<double>(2 * mesh.points.size(), .25)});
    const HexMesh direct = refine(mesh, {.levels = 2}), stepwise = refine(refine(mesh));
    EXPECT_EQ(direct.points, stepwise.points);
    EXPECT_EQ(direct.cells, stepwise.cells);
    for (const double v : direct.attributes[0].values) EXPECT_NEAR(v, .25, 1e-15);
}

TEST(Refine, DoesNotDependOnTheOrderOrTurnOfCells) {
    const HexMesh mesh = irregular();
    HexMesh shuffled = mesh;
    std::reverse(shuffled.cells.begin(), shuffled.cells.end());
    for (auto& cell : shuffled.cells) cell = {cell[1], cell[2], cell[3], cell[0], cell[5], cell[6], cell[7], cell[4]};
    EXPECT_EQ(refine(mesh, {.levels = 2}).points.size(), refine(shuffled, {.levels = 2}).points.size());
    EXPECT_EQ(refine(mesh).points, refine(shuffled).points);  // bitwise, in the same numbering
    std::vector<std::array<double, 3>> a, b;
    for (const auto& p : refine(mesh, {.levels = 2}).points) a.push_back({p.x, p.y, p.z});
    for (const auto& p : refine(shuffled, {.levels = 2}).points) b.push_back({p.x, p.y, p.z});
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    EXPECT_EQ(a, b);
}

TEST(Refine, DoesNotDependOnTheNumberOfThreads) {
    const HexMesh mesh = irregular();
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return refine(mesh, {.levels = 3});
    };
    const HexMesh one = run(1), four = run(4);
    EXPECT_EQ(one.points, four.points);
    EXPECT_EQ(one.cells, four.cells);
}

TEST(Refine, KeepsABoxABox) {
    const HexMesh fine = refine(test::make_box(2, 3, 2), {.levels = 2});
    const auto report = inspect(fine);
    EXPECT_NEAR(report.volume, 12, 1e-12);
    EXPECT_NEAR(report.min_scaled_jacobian, 1, 1e-12);
}

TEST(Refine, AnExtrusionMovesNothingAlongItsAxis) {
    // The section of an extruded mesh does not depend on z, inside and on the boundary.
    HexMesh mesh = test::make_box(3, 3, 4);
    for (auto& p : mesh.points) p += Vec3(.1 * std::sin(p.y + .3 * p.x * p.y), .1 * std::cos(2 * p.x), 0);
    std::map<std::pair<long, long>, int> sections;
    for (const auto& p : refine(mesh).points) ++sections[{std::lround(p.x * 1e9), std::lround(p.y * 1e9)}];
    EXPECT_EQ(sections.size(), 7u * 7u);
    for (const auto& [xy, count] : sections) EXPECT_EQ(count, 9);
}

TEST(Refine, CreasesStaySharp) {
    // The edge of a wedge of two columns is smooth by default (two cells) and sharp if it is bent by more than the given angle.
    HexMesh mesh = test::make_box(2, 1, 2);
    for (auto& p : mesh.points) p.y += p.x == 1 ? .8 : 0;
    const HexMesh smooth = refine(mesh), sharp = refine(mesh, {.scheme = {.crease_angle_deg = 40}});
    const auto middle_height = [](const HexMesh& m) {
        double y = 0;  // of the points half way along the first column's top
        for (const auto& p : m.points) {
            if (std::abs(p.x - .5) < .15) y = std::max(y, p.y);
        }
        return y;
    };
    EXPECT_NEAR(middle_height(sharp), 1.4, 1e-12);  // straight to the ridge: quadratic extrapolation of two points is linear
    EXPECT_GT(middle_height(smooth), middle_height(sharp) + .05);
    EXPECT_EQ(refine(sharp).creases.size(),
              4 * refine(mesh, {.scheme = {.crease_angle_deg = 40}, .levels = 0}).creases.size() + 2 * sharp.creases.size());
}

TEST(Refine, RefusesWhatIsNotAMesh) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.cells.push_back(mesh.cells[0]);
    EXPECT_THROW((void)refine(mesh), Error);
    EXPECT_THROW((void)refine(test::make_box(1, 1, 1), {.levels = -1}), Error);
    EXPECT_THROW((void)refine(test::make_box(1, 1, 1), {.scheme = {.crease_angle_deg = 200}}), Error);
}

}  // namespace refine_test
}  // namespace subvol
