// SPDX-License-Identifier: Apache-2.0
// Folds that integrations see on their way, against the proofs of check_folds.

#include <gtest/gtest.h>

#include <random>

#include "lib/test_meshes.h"
#include "subvol/certificate.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/region.h"

namespace subvol {
namespace seen_folds_test {

/// A box whose inner points are moved by up to so much of an edge.
HexMesh rough_box(Index side, double amount, unsigned seed) {
    HexMesh mesh = test::make_box(side, side, side);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> move(-amount, amount);
    for (Vec3& x : mesh.points) {
        const Vec3 by(move(random), move(random), move(random));
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) inside = inside && x[axis] > 0 && x[axis] < side;
        if (inside) x += by;
    }
    return mesh;
}

/// Cells that are boxes, and change their width at once: the cells are sound, and the limit overshoots.
HexMesh jumping_box() {
    constexpr std::array<double, 8> kPlaces{0, 1, 2, 3, 3.05, 3.1, 4, 5};
    HexMesh mesh = test::make_box(7, 3, 3);
    for (Vec3& x : mesh.points) x.x = kPlaces[static_cast<std::size_t>(x.x)];
    return mesh;
}

TEST(SeenFolds, AreFoldsAndAreSeen) {
    for (const HexMesh& mesh : {rough_box(4, .6, 1), rough_box(4, .7, 2), jumping_box()}) {
        const FoldCheck check = check_folds(mesh);
        ASSERT_GT(check.report.folded, 3U);
        const SeenFolds seen = measure_limit(mesh).folds;
        EXPECT_GT(seen.cells, 0U);
        EXPECT_LE(seen.cells, check.report.folded);
        ASSERT_LT(seen.first, mesh.cells.size());
        EXPECT_EQ(check.verdicts[seen.first], FoldVerdict::Folded);
        Box cell;
        for (const Index p : mesh.cells[seen.first]) cell.add(mesh.points[p]);
        for (int axis = 0; axis < 3; ++axis) {  // the limit of a cell goes beyond its box by a part of it
            EXPECT_GE(seen.place[axis], cell.lower[axis] - .5 * cell.size()[axis] - .5);
            EXPECT_LE(seen.place[axis], cell.upper[axis] + .5 * cell.size()[axis] + .5);
        }
        // In a part of space, and in the cells of a part: those there.
        const std::vector<Region> half = parse_regions(std::vector<std::string>{"half:1000,0,0,-1,0,0"});
        EXPECT_GT(measure_limit_in(mesh, half).folds.cells, 0U);
        std::vector<std::uint8_t> one(mesh.cells.size(), 0);
        one[seen.first] = 1;
        MeasureOptions options;
        options.cells = one;
        const SeenFolds alone = measure_limit(mesh, options).folds;
        EXPECT_EQ(alone.cells, 1U);
        EXPECT_EQ(alone.first, seen.first);
    }
}

TEST(SeenFolds, AreNoneInSoundMeshes) {
    HexMesh prism = test::make_box(1, 1, 1);  // one of its edges has no length
    HexMesh rounded = test::make_box(3, 3, 3);
    for (HexMesh* mesh : {&prism, &rounded}) {
        for (Vec3& x : mesh->points) {
            if (x.x == 0 && x.y == 0) x.x = 1;
        }
    }
    // A limit that rounds such an edge folds there.
    const FoldCheck check = check_folds(rounded);
    EXPECT_GT(check.report.folded, 0U);
    EXPECT_EQ(measure_limit(rounded).folds.cells, check.report.folded);
    for (const HexMesh& mesh :
         {make_model("ball", 3), make_model("twist", 4), rough_box(5, .2, 3), test::make_box(3, 3, 3), prism})
        EXPECT_EQ(measure_limit(mesh).folds.cells, 0U) << mesh.cells.size();
    // Mirrored cells are inverted as a whole, which is said of the mesh: their limit folds no more than they do.
    HexMesh mirrored = rough_box(3, .1, 4);
    for (auto& c : mirrored.cells) c = {c[3], c[2], c[1], c[0], c[7], c[6], c[5], c[4]};
    EXPECT_EQ(measure_limit(mirrored).folds.cells, 0U);
    EXPECT_EQ(measure_limit(rough_box(4, .6, 1), {.scheme = {.kind = Scheme::Linear}}).folds.cells, 0U)
        << "those are the cells";
}

}  // namespace seen_folds_test
}  // namespace subvol
