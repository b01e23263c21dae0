// SPDX-License-Identifier: Apache-2.0
// Slices of a mesh in bricks have the values of the mesh, wherever it is cut into bricks.
#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/limit_slice.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol {
namespace brick_slice_test {

using test::error_of;
using testing::HasSubstr;

class BrickSlice : public test::TempFolder {};

TEST_F(BrickSlice, ALinearFieldHasItsValues) {
    HexMesh mesh = test::make_box(6, 5, 4);
    test::add_field(mesh, "f", [](const Vec3& x) { return 2 * x.x - x.y + 0.5 * x.z; });
    for (const BrickShape shape : {BrickShape::Blocks, BrickShape::Slabs, BrickShape::Random}) {
        const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 4, .shape = shape}).bricks;
        const LimitSlice slice = slice_limit(bricks, {}, {3, 2, 1.5}, {0, 0, 1}, {.resolution = 30});
        EXPECT_EQ(slice.field, "f");
        EXPECT_EQ(slice.width, 30);
        EXPECT_EQ(slice.height, 25);
        ASSERT_EQ(slice.inside, 750U);
        for (int row = 0; row < slice.height; ++row) {
            for (int column = 0; column < slice.width; ++column) {
                const Vec3 x = slice.place(column, row);
                const auto p = static_cast<std::size_t>(row * slice.width + column);
                EXPECT_NEAR(x.z, 1.5, 1e-12);
                EXPECT_NEAR(slice.values[p], 2 * x.x - x.y + 0.75, 1e-9);
                EXPECT_NEAR(glm::distance(slice.gradients[p], Vec3(2, -1, 0.5)), 0, 1e-6);
            }
        }
    }
}

TEST_F(BrickSlice, IsThatOfTheWholeWhereFramesAreTheSame) {
    // A slice of the whole has the box of the limit; with a linear limit that is the box of the control points.
    HexMesh mesh = make_model("ball", 3);
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x * x.x + x.y * x.z; });
    const SliceOptions options{.resolution = 33, .limit = {.scheme = {.kind = Scheme::Linear}}};
    const LimitSlice whole = slice_limit(mesh, "f", {0.02, 0.01, 0.03}, {0.3, 0.2, 1}, options);
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 5}).bricks;
    const LimitSlice found = slice_limit(bricks, {}, {0.02, 0.01, 0.03}, {0.3, 0.2, 1}, options);
    // The pieces' boxes are of floats.
    const double near = 1e-5 * bounds(mesh).diagonal();
    ASSERT_EQ(found.width, whole.width);
    ASSERT_EQ(found.height, whole.height);
    EXPECT_LT(glm::distance(found.origin, whole.origin), near);
    EXPECT_NEAR(static_cast<double>(found.inside), static_cast<double>(whole.inside), 4);
    for (std::size_t p = 0; p < whole.values.size(); ++p) {
        if (found.cells[p] == kNone || whole.cells[p] == kNone) continue;
        EXPECT_NEAR(found.values[p], whole.values[p], 1e-4);
    }
}

TEST_F(BrickSlice, PlacesHaveTheValuesOfAMeshInMemory) {
    HexMesh mesh = make_model("ball", 3);
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x * x.x + x.y * x.z; });
    test::add_field(mesh, "g", [](const Vec3& x) { return x.z; });
    const std::vector<Vec3> places = places_on_line({-2, 0.1, 0.05}, {2, 0.1, 0.05}, 41);
    const ProbeResult whole = probe_limit(mesh, places);
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 4}).bricks;
    const ProbeResult found = probe_limit(bricks, places);
    ASSERT_EQ(found.fields.size(), 2U);
    std::size_t inside = 0;
    for (std::size_t p = 0; p < places.size(); ++p) {
        ASSERT_EQ(found.inside(p), whole.inside(p)) << p;
        if (!whole.inside(p)) continue;
        ++inside;
        for (std::size_t f = 0; f < 2; ++f) EXPECT_NEAR(found.fields[f].values[p], whole.fields[f].values[p], 1e-5);
    }
    EXPECT_GT(inside, 10U);
    EXPECT_THAT(error_of([&] { (void)probe_limit(bricks, places, {.reach_world = 1}); }), HasSubstr("distances"));
    const MeshSource only_g = source_of(bricks).changed([](HexMesh brick) {
        brick.attributes.erase(brick.attributes.begin());
        return brick;
    });
    EXPECT_EQ(probe_limit(only_g, places).fields.at(0).name, "g");
}

TEST_F(BrickSlice, RefusesWhatIsMalformed) {
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x; });
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 2}).bricks;
    EXPECT_THAT(error_of([&] { (void)slice_limit(bricks, {}, {2, 2, 9}, {0, 0, 1}); }), HasSubstr("misses the volume"));
    EXPECT_THAT(error_of([&] { (void)slice_limit(bricks, {}, {2, 2, 2}, {0, 0, 0}); }), HasSubstr("no direction"));
    EXPECT_THAT(error_of([&] {
                    (void)slice_limit(bricks, {}, {2, 2, 2}, {0, 0, 1}, {.resolution = 1});
                }),
                HasSubstr("2 to 20,000"));
}

}  // namespace brick_slice_test
}  // namespace subvol
