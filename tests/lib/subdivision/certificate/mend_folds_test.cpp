// SPDX-License-Identifier: Apache-2.0
#include "subvol/mend_folds.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/topology.h"

namespace subvol {
namespace mend_folds_test {

using test::make_box;
using testing::HasSubstr;

std::vector<std::uint8_t> on_boundary(const HexMesh& mesh) {
    return build_topology(mesh).point_on_boundary;
}

// Cells that are sound, with a limit that overshoots between them.
HexMesh overshooting() {
    HexMesh mesh = make_box(7, 7, 7);
    for (Vec3& x : mesh.points) {
        const bool inside = x.y > 1.5 && x.y < 5.5 && x.z > 1.5 && x.z < 5.5;
        if (std::abs(x.x - 3) < 0.1 && inside) x.x += 0.85;
        if (std::abs(x.x - 5) < 0.1 && inside) x.x -= 0.85;
    }
    return mesh;
}

// A point pushed through the opposite face of a cell.
HexMesh pushed(const HexMesh& from, Index point, const Vec3& by) {
    HexMesh mesh = from;
    mesh.points[point] += by;
    return mesh;
}

Index point_at(const HexMesh& mesh, const Vec3& place) {
    return static_cast<Index>(
        std::ranges::min_element(mesh.points, {}, [&](const Vec3& x) { return glm::distance(x, place); }) -
        mesh.points.begin());
}

void expect_mended(const HexMesh& mesh, const Mended& mended, double farthest) {
    EXPECT_GT(mended.report.before.folded, 0u);
    EXPECT_EQ(mended.check.report.folded + mended.check.report.open, 0u);
    EXPECT_EQ(check_folds(mended.mesh).report.folded, 0u);
    EXPECT_TRUE(mended.report.left.empty());
    EXPECT_GT(mended.report.moved, 0u);
    EXPECT_LT(mended.report.farthest_edges, farthest);
    EXPECT_EQ(mended.mesh.cells, mesh.cells);
}

TEST(MendFolds, OvershootIsMendedByASmallWay) {
    const HexMesh mesh = overshooting();
    ASSERT_EQ(inspect(mesh).inverted_cells, 0u);
    const Mended mended = mend_folds(mesh, {.boundary_edges = 0});
    expect_mended(mesh, mended, 2);
    // The boundary stays, and so do points that are far from the folds.
    const auto boundary = on_boundary(mesh);
    for (Index p = 0; p < mesh.points.size(); ++p) {
        if (boundary[p] != 0) EXPECT_EQ(mended.mesh.points[p], mesh.points[p]);
    }
    EXPECT_LT(mended.report.moved, mesh.points.size() / 2);
    EXPECT_EQ(mended.report.boundary_edges, 0);
}

TEST(MendFolds, InvertedCellsAreMended) {
    const HexMesh box = make_box(7, 7, 7);
    const HexMesh mesh = pushed(box, point_at(box, {3, 3, 3}), {1.3, 0.2, 0.1});
    ASSERT_GT(inspect(mesh).inverted_cells, 0u);
    expect_mended(mesh, mend_folds(mesh), 12);
}

TEST(MendFolds, FoldsAtIrregularEdgesAreMended) {
    HexMesh mesh = test::make_nested_cubes(4);
    const auto boundary = on_boundary(mesh);
    Index point = 0;
    while (boundary[point] != 0) ++point;
    mesh.points[point] += Vec3(1.4, 1.1, 0.9) * glm::distance(mesh.points[point], mesh.points[point + 1]);
    const Mended mended = mend_folds(mesh);
    expect_mended(mesh, mended, 12);
}

class MendFoldsOf : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, MendFoldsOf, testing::Values(Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(MendFoldsOf, OtherSchemesAreMendedToo) {
    const HexMesh box = make_box(7, 7, 7);
    const HexMesh mesh = pushed(box, point_at(box, {3, 3, 3}), {6.2, 0.2, 0.1});
    MendOptions options;
    options.folds.scheme.kind = GetParam();
    const Mended mended = mend_folds(mesh, options);
    EXPECT_GT(mended.report.before.folded, 0u);
    EXPECT_EQ(check_folds(mended.mesh, options.folds).report.folded, 0u);
    EXPECT_TRUE(mended.report.left.empty());
}

// The boundary moves as far as it may, along itself: the planes of a box stay planes, nearly.
TEST(MendFolds, TheBoundaryMovesAlongItself) {
    const HexMesh box = make_box(7, 7, 7);
    const HexMesh mesh = pushed(box, point_at(box, {3, 3, 0}), {1.2, 0, 0});
    const Mended stays = mend_folds(mesh, {.boundary_edges = 0, .rounds = 2});
    EXPECT_GT(stays.report.left.size(), 0u);
    EXPECT_THAT(stays.report.left[0].reason, HasSubstr("boundary"));
    // The second round is in vain and taken back; what is known is what a check of the mesh finds.
    EXPECT_EQ(stays.check.verdicts, check_folds(stays.mesh).verdicts);
    const Mended mended = mend_folds(mesh, {.boundary_edges = 8});
    expect_mended(mesh, mended, 12);
    for (Index p = 0; p < mesh.points.size(); ++p) {
        if (box.points[p].z == 0) EXPECT_NEAR(mended.mesh.points[p].z, 0, 0.02);
    }
}

TEST(MendFolds, AMeshWithoutFoldsStays) {
    HexMesh mesh = make_box(5, 5, 5);
    test::jitter(mesh, 0.05, 3);
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x; });
    const Mended mended = mend_folds(mesh);
    EXPECT_EQ(mended.mesh.points, mesh.points);
    EXPECT_EQ(mended.mesh.attributes[0].values, mesh.attributes[0].values);
    EXPECT_EQ(mended.report.moved + static_cast<std::size_t>(mended.report.rounds), 0u);
}

TEST(MendFolds, TheSameBitsForAnyNumberOfThreads) {
    const HexMesh mesh = overshooting();
    const HexMesh many = mend_folds(mesh, {.rounds = 1}).mesh;
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(mend_folds(mesh, {.rounds = 1}).mesh.points, many.points);
}

TEST(MendFolds, IsCancelledBetweenSteps) {
    struct Cancel : Progress {
        void report(std::string_view stage, double) override { mends = mends || stage == "mend"; }
        [[nodiscard]] bool cancelled() const override { return mends; }
        bool mends = false;
    } progress;
    EXPECT_THROW((void)mend_folds(overshooting(), {.folds = {.progress = &progress}}), Error);
    EXPECT_TRUE(progress.mends);
}

TEST(MendFolds, OptionsAreChecked) {
    EXPECT_THAT(test::error_of([] { (void)mend_folds(make_box(3, 3, 3), {.boundary_edges = -1}); }),
                HasSubstr("boundary_move"));
    EXPECT_THAT(test::error_of([] { (void)mend_folds(make_box(3, 3, 3), {.rounds = 0}); }), HasSubstr("rounds"));
}

}  // namespace mend_folds_test
}  // namespace subvol
