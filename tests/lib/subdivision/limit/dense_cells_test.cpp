// SPDX-License-Identifier: Apache-2.0
#include "subvol/dense_cells.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol {
namespace dense_cells_test {

struct Grids {
    std::vector<std::vector<Vec3>> points;
    std::vector<std::vector<double>> values;
};

Grids dense(const HexMesh& mesh, const RefineOptions& options) {
    Grids grids{std::vector<std::vector<Vec3>>(mesh.cells.size()), std::vector<std::vector<double>>(mesh.cells.size())};
    for_each_dense_cell(mesh, options, [&](const DenseCell& cell) {  // every cell writes its own entry
        grids.points[cell.cell].assign(cell.points.begin(), cell.points.end());
        grids.values[cell.cell].assign(cell.values[0].begin(), cell.values[0].end());
    });
    return grids;
}

HexMesh irregular() {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .04, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y + std::sin(2 * p.z); });
    return mesh;
}

TEST(DenseCells, AreTheVerticesOfTheRefinedMesh) {
    const HexMesh mesh = irregular();
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const RefineOptions options{.scheme = {scheme}, .levels = 3};
        const HexMesh fine = refine(mesh, options);
        const Grids grids = dense(mesh, options);
        const auto node = [](std::size_t i, std::size_t j, std::size_t k) { return i + 9 * (j + 9 * k); };
        std::size_t differing = 0;
        for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
            ASSERT_EQ(grids.points[c].size(), 729u);
            // The lowest and the highest descendant: octal 000 and 666 (corner 6 is u = v = w = 1).
            const auto& low = fine.cells[512 * c];
            const auto& high = fine.cells[512 * c + 0666];
            differing += grids.points[c][node(0, 0, 0)] != fine.points[low[0]];
            differing += grids.points[c][node(1, 0, 0)] != fine.points[low[1]];
            differing += grids.points[c][node(0, 1, 0)] != fine.points[low[3]];
            differing += grids.points[c][node(8, 8, 8)] != fine.points[high[6]];
            differing += grids.points[c][node(7, 8, 8)] != fine.points[high[7]];
            differing += grids.values[c][node(8, 8, 7)] != fine.attributes[0].values[high[2]];
            // Child 1 (u = 1, v = w = 0) of child 3 (v = 1) of child 4 (w = 1): u 1, v 2, w 4.
            differing += grids.points[c][node(1, 2, 4)] != fine.points[fine.cells[512 * c + 0431][0]];
        }
        EXPECT_EQ(differing, 0u);
    }
}

TEST(DenseCells, OfASelectionAreThoseOfAll) {
    const HexMesh mesh = irregular();
    const RefineOptions options{.levels = 2};
    const Grids all = dense(mesh, options);
    const std::vector<Index> cells{5, 0, static_cast<Index>(mesh.cells.size() - 1)};
    std::vector<std::vector<Vec3>> points(mesh.cells.size());
    for_each_dense_cell(mesh, options, {.cells = cells},
                        [&](const DenseCell& cell) { points[cell.cell].assign(cell.points.begin(), cell.points.end()); });
    for (std::size_t c = 0; c < points.size(); ++c) {
        const bool named = std::find(cells.begin(), cells.end(), c) != cells.end();
        EXPECT_TRUE(named ? points[c] == all.points[c] : points[c].empty()) << c;
    }
    const DenseSelection none{.cells = std::vector<Index>{static_cast<Index>(mesh.cells.size())}};
    EXPECT_THROW(for_each_dense_cell(mesh, options, none, [](const DenseCell&) {}), Error);
}

TEST(DenseCells, InSeveralSelectionsAreThoseOfAll) {
    const HexMesh mesh = irregular();
    const RefineOptions options{.levels = 2};
    const Grids all = dense(mesh, options);
    const DenseCells lots(mesh, options, false);
    std::size_t visited = 0;
    for (Index first = 0; first < mesh.cells.size(); first += 3) {
        std::vector<Index> cells;
        for (Index c = first; c < std::min<std::size_t>(first + 3, mesh.cells.size()); ++c) cells.push_back(c);
        std::vector<std::vector<Vec3>> points(mesh.cells.size());
        lots.for_each(cells, [&](const DenseCell& cell) { points[cell.cell].assign(cell.points.begin(), cell.points.end()); });
        for (const Index c : cells) visited += points[c] == all.points[c];
    }
    EXPECT_EQ(visited, mesh.cells.size());
}

TEST(DenseCells, OnTheLimitAreTheRefinedMeshOnTheLimit) {
    const HexMesh mesh = irregular();
    for (const int levels : {0, 1, 3}) {
        const RefineOptions options{.scheme = {Scheme::CatmullClark}, .levels = levels};
        const HexMesh fine = on_limit(refine(mesh, options), options.scheme.kind);
        const std::size_t side = (std::size_t{1} << levels) + 1, children = std::size_t{1} << (3 * levels);
        const std::size_t last = 6 * (children - 1) / 7;  // octal 666: the highest descendant
        std::vector<int> equal(mesh.cells.size(), 0);
        for_each_dense_cell(mesh, options, {.on_limit = true}, [&](const DenseCell& cell) {
            const auto& low = fine.cells[children * cell.cell];
            const auto& high = fine.cells[children * cell.cell + last];
            equal[cell.cell] = cell.points[0] == fine.points[low[0]] && cell.points[side] == fine.points[low[3]] &&
                               cell.points.back() == fine.points[high[6]] &&
                               cell.values[0].back() == fine.attributes[0].values[high[6]];
        });
        EXPECT_EQ(std::count(equal.begin(), equal.end(), 1), std::ssize(equal)) << levels;
    }
}

TEST(DenseCells, DoNotDependOnTheNumberOfThreads) {
    const HexMesh mesh = irregular();
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return dense(mesh, {.levels = 2});
    };
    const Grids one = run(1), four = run(4);
    EXPECT_EQ(one.points, four.points);
    EXPECT_EQ(one.values, four.values);
}

TEST(DenseCells, FollowTheParametersOfTheCell) {
    // On a box the scheme reproduces linear functions, so the nodes of the grid lie at their parameters.
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x + 10 * p.y + 100 * p.z; });
    for_each_dense_cell(mesh, {.levels = 2}, [&](const DenseCell& cell) {
        const Vec3 origin = mesh.points[mesh.cells[cell.cell][0]];
        for (std::size_t k = 0, n = 0; k < 5; ++k) {
            for (std::size_t j = 0; j < 5; ++j) {
                for (std::size_t i = 0; i < 5; ++i, ++n) {
                    const Vec3 expected = origin + Vec3(double(i), double(j), double(k)) / 4.0;
                    EXPECT_NEAR(glm::distance(cell.points[n], expected), 0, 1e-14);
                    EXPECT_NEAR(cell.values[0][n], expected.x + 10 * expected.y + 100 * expected.z, 1e-12);
                }
            }
        }
    });
}

// Tables of weights change no more than the last bits: regular cells, cells on the boundary and at its edges, irregular ones.
TEST(DenseCells, ByTablesAreTheSameToRounding) {
    HexMesh mesh = test::make_nested_cubes(6);
    test::jitter(mesh, .02, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y + std::sin(2 * p.z); });
    std::vector<Index> cells(mesh.cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
        for (const int levels : scheme == Scheme::Mcq ? std::vector{1, 2, 3} : std::vector{1, 2}) {
            const RefineOptions options{.scheme = {scheme}, .levels = levels};
            std::vector<std::vector<Vec3>> points(cells.size());
            std::vector<std::vector<double>> values(cells.size());
            DenseCells(mesh, options, true).for_each(cells, [&](const DenseCell& cell) {
                points[cell.cell].assign(cell.points.begin(), cell.points.end());
                values[cell.cell].assign(cell.values[0].begin(), cell.values[0].end());
            });
            std::vector<double> most(cells.size());
            DenseCells(mesh, options, true, DenseBits::ToRounding).for_each(cells, [&](const DenseCell& cell) {
                double& of_cell = most[cell.cell];
                for (std::size_t n = 0; n < cell.points.size(); ++n) {
                    of_cell = std::max({of_cell, glm::length(cell.points[n] - points[cell.cell][n]),
                                        std::abs(cell.values[0][n] - values[cell.cell][n])});
                }
            });
            EXPECT_LT(std::ranges::max(most), 1e-14) << "scheme " << static_cast<int>(scheme) << ", level " << levels;
        }
    }
}

}  // namespace dense_cells_test
}  // namespace subvol
