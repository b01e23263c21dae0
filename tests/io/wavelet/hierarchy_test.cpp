// SPDX-License-Identifier: Apache-2.0
#include "subvol/hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol {
namespace hierarchy_test {

using test::expect_error;

std::vector<Index> ascending(std::size_t count) {
    std::vector<Index> numbers(count);
    std::iota(numbers.begin(), numbers.end(), Index{0});
    return numbers;
}

TEST(Hierarchy, OfARefinedMeshIsTheMeshThatWasRefined) {
    for (const HexMesh& mesh : {test::make_box(3, 1, 5), test::irregular(), make_model("ball", 3)}) {
        const HexMesh fine = refine(mesh, {.levels = 2});
        const MeshHierarchy found = find_hierarchy(fine, {.levels = 2});
        EXPECT_EQ(found.levels, 2);
        EXPECT_EQ(found.coarse.cells, mesh.cells);
        EXPECT_EQ(found.coarse.points, mesh.points);
        EXPECT_EQ(found.points, ascending(fine.points.size()));
        EXPECT_EQ(found.cells, ascending(fine.cells.size()));
        EXPECT_TRUE(found.padded.empty());
    }
}

/// Cells and points in any order, cells in any orientation: the hierarchy is found by the connections alone.
HexMesh shuffled(const HexMesh& mesh, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Index> to = ascending(mesh.points.size());
    std::shuffle(to.begin(), to.end(), random);
    HexMesh result;
    result.points.resize(mesh.points.size());
    for (std::size_t p = 0; p < to.size(); ++p) result.points[to[p]] = mesh.points[p];
    for (auto cell : mesh.cells) {
        for (auto turns = random() % 4; turns > 0; --turns) {  // about w
            cell = {cell[1], cell[2], cell[3], cell[0], cell[5], cell[6], cell[7], cell[4]};
        }
        for (auto turns = random() % 3; turns > 0; --turns) {  // about the diagonal from corner 0
            cell = {cell[0], cell[3], cell[7], cell[4], cell[1], cell[2], cell[6], cell[5]};
        }
        for (Index& p : cell) p = to[p];
        result.cells.push_back(cell);
    }
    std::shuffle(result.cells.begin(), result.cells.end(), random);
    return result;
}

TEST(Hierarchy, OfAShuffledMeshHasTheSamePlaces) {
    for (const HexMesh& mesh : {test::make_box(3, 2, 3), test::irregular(), make_model("ball", 3)}) {
        const HexMesh fine = refine(mesh, {.levels = 2}), mixed = shuffled(fine, 17);
        const MeshHierarchy found = find_hierarchy(mixed, {.levels = 2});
        ASSERT_EQ(found.levels, 2);
        const HexMesh again = refine(found.coarse, {.levels = 2});
        ASSERT_EQ(again.points.size(), found.points.size());
        for (std::size_t p = 0; p < again.points.size(); ++p) {
            const Vec3 off = again.points[p] - mixed.points[found.points[p]];
            EXPECT_LT(std::abs(off.x) + std::abs(off.y) + std::abs(off.z), 1e-12);  // the scheme is the same for any order
        }
        ASSERT_EQ(again.cells.size(), found.cells.size());
        for (std::size_t c = 0; c < again.cells.size(); ++c) {
            std::vector<Index> own, other(mixed.cells[found.cells[c]].begin(), mixed.cells[found.cells[c]].end());
            for (const Index p : again.cells[c]) own.push_back(found.points[p]);
            std::sort(own.begin(), own.end());
            std::sort(other.begin(), other.end());
            EXPECT_EQ(own, other);
        }
        const double volume = cell_volume([&] {
            std::array<Vec3, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = again.points[again.cells[0][k]];
            return corners;
        }());
        EXPECT_GT(volume, 0);  // right-handed cells stay so
    }
}

TEST(Hierarchy, FindsTheLevelsOfAGrid) {
    const MeshHierarchy found = find_hierarchy(test::make_box(8, 16, 12));
    EXPECT_EQ(found.levels, 2);  // 12 = 4 · 3
    EXPECT_EQ(found.coarse.cells.size(), 2u * 4u * 3u);
    EXPECT_EQ(find_hierarchy(test::make_box(8, 16, 12), {.levels = 1}).levels, 1);
}

TEST(Hierarchy, KeepsCreasesAndSharpFaces) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.creases = {{1, 4}, {4, 7}};
    mesh.sharp_faces = {{4, 5, 14, 13}};
    const MeshHierarchy found = find_hierarchy(refine(mesh, {.levels = 2}), {.levels = 2});
    EXPECT_EQ(found.coarse.creases, mesh.creases);
    ASSERT_EQ(found.coarse.sharp_faces.size(), 1u);
    std::array<Index, 4> face = found.coarse.sharp_faces[0];
    std::sort(face.begin(), face.end());
    EXPECT_EQ(face, (std::array<Index, 4>{4, 5, 13, 14}));
    // Half a crease is none of a coarser edge.
    HexMesh half = refine(test::make_box(2, 2, 2), {.levels = 1});
    const Topology topology = build_topology(half);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        if (topology.edge_on_boundary[e] && !topology.edge_is_crease[e]) {
            half.creases.push_back(topology.edges[e]);
            break;
        }
    }
    expect_error(ErrorCode::InvalidInput, "creases", [&] { (void)find_hierarchy(half); });
}

TEST(Hierarchy, FillsUpAGridWithOddCounts) {
    const HexMesh mesh = shuffled(test::make_box(7, 13, 6), 4);
    const MeshHierarchy found = find_hierarchy(mesh);  // 8 × 14 × 6 or 8 × 16 × 8; 8 × 16 × 8 has more than half more cells
    ASSERT_EQ(found.levels, 1);
    EXPECT_EQ(found.coarse.cells.size(), 4u * 7u * 3u);
    std::vector<Index> own;
    for (const Index c : found.cells) {
        if (c != kNone) own.push_back(c);
    }
    std::sort(own.begin(), own.end());
    EXPECT_EQ(own, ascending(mesh.cells.size()));  // each cell of the mesh once
}

TEST(Hierarchy, AddedPointsAreExtrapolated) {
    HexMesh mesh = test::make_box(7, 15, 5);
    const MeshHierarchy found = find_hierarchy(mesh, {.levels = 1});
    ASSERT_EQ(found.levels, 1);
    EXPECT_EQ(found.cells.size(), 8u * 16u * 6u);
    EXPECT_EQ(std::count(found.cells.begin(), found.cells.end(), kNone),
              static_cast<std::ptrdiff_t>(8 * 16 * 6 - mesh.cells.size()));
    std::vector<double> linear;
    for (const Vec3& p : mesh.points) linear.push_back(2 * p.x - p.y + 3 * p.z);
    const std::vector<double> values = in_hierarchy(found, linear, 1);
    std::vector<double> places;
    for (const Vec3& p : mesh.points) places.insert(places.end(), {p.x, p.y, p.z});
    const std::vector<double> spread = in_hierarchy(found, places, 3);
    double most = 0;
    for (std::size_t p = 0; p < values.size(); ++p) {
        EXPECT_NEAR(values[p], 2 * spread[3 * p] - spread[3 * p + 1] + 3 * spread[3 * p + 2], 1e-12);
        most = std::max(most, spread[3 * p + 1]);
    }
    EXPECT_EQ(most, 16);
}

TEST(Hierarchy, SaysWhyThereIsNone) {
    expect_error(ErrorCode::InvalidInput, "odd number", [&] { (void)find_hierarchy(test::make_box(8, 8, 3), {.pad = false}); });
    expect_error(ErrorCode::InvalidInput, "multiple of 8", [&] { (void)find_hierarchy(test::make_nested_cubes(3)); });
    expect_error(ErrorCode::InvalidInput, "too few", [&] { (void)find_hierarchy(test::make_box(1, 1, 1)); });
    HexMesh eight = test::make_box(8, 1, 1);
    expect_error(ErrorCode::InvalidInput, "", [&] { (void)find_hierarchy(eight); });
    expect_error(ErrorCode::InvalidInput, "1 to 10", [&] { (void)find_hierarchy(eight, {.levels = 0}); });
    expect_error(ErrorCode::InvalidInput, "values",
                 [&] { (void)in_hierarchy(find_hierarchy(test::make_box(2, 2, 2)), std::vector<double>(5), 1); });
}

}  // namespace hierarchy_test
}  // namespace subvol
