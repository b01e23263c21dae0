// SPDX-License-Identifier: Apache-2.0
// Surfaces of a mesh in bricks have the bits of the mesh in one piece.
#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/limit_surface.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol {
namespace brick_surface_test {

using test::error_of;
using testing::HasSubstr;

class BrickSurface : public test::TempFolder {
protected:
    void expect_same(const HexMesh& mesh, const SplitOptions& split, const SurfaceOptions& options) const {
        const LimitSurface whole = limit_surface(mesh, "f", options);
        const Bricks bricks = split_mesh(path("m.bricks"), mesh, split).bricks;
        const LimitSurface found = limit_surface(bricks, "f", options);
        ASSERT_GT(whole.surface.triangles.size(), 100U);
        EXPECT_EQ(found.surface.triangles, whole.surface.triangles);
        EXPECT_EQ(found.surface.points, whole.surface.points);
        EXPECT_EQ(found.normals, whole.normals);
        ASSERT_EQ(found.places.size(), whole.places.size());
        for (std::size_t p = 0; p < whole.places.size(); ++p) {
            EXPECT_EQ(found.places[p].cell, whole.places[p].cell);
            EXPECT_EQ(found.places[p].uvw, whole.places[p].uvw);
        }
        ASSERT_EQ(found.fields.size(), 2U);
        for (std::size_t f = 0; f < 2; ++f) {
            EXPECT_EQ(found.fields[f].name, whole.fields[f].name);
            EXPECT_EQ(found.fields[f].values, whole.fields[f].values);
            EXPECT_EQ(found.fields[f].gradients, whole.fields[f].gradients);
        }
        EXPECT_EQ(found.report.level, whole.report.level);
        EXPECT_EQ(found.report.deviation_world, whole.report.deviation_world);
        EXPECT_EQ(found.report.cells, whole.report.cells);
        EXPECT_EQ(found.report.watertight, whole.report.watertight);
        EXPECT_EQ(found.report.euler, whole.report.euler);
        EXPECT_EQ(found.report.volume, whole.report.volume);
    }
};

HexMesh ball() {
    HexMesh mesh = make_model("ball", 4);
    mesh.attributes.clear();
    test::jitter(mesh, 0.02, 3);
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x * x.x + 2 * x.y * x.y + x.z + 0.3 * x.x * x.y; });
    test::add_field(mesh, "g", [](const Vec3& x) { return x.y; });
    return mesh;
}

TEST_F(BrickSurface, HasTheBitsOfTheWhole) {
    const HexMesh mesh = ball();
    for (const BrickShape shape : {BrickShape::Blocks, BrickShape::Random}) {
        const SplitOptions split{.bricks = 5, .shape = shape};
        expect_same(mesh, split, {.boundary = true});
        expect_same(mesh, split, {.isos = {0.3}, .tolerance = 3e-3});
        expect_same(mesh, split, {.isos = {0.1, 0.6}, .cap = true, .tolerance = 3e-3});
        expect_same(mesh, split, {.scheme = {.crease_angle_deg = 40}, .isos = {0.3}, .boundary = true});
    }
}

TEST_F(BrickSurface, SaysWhatItCannotDo) {
    const HexMesh mesh = ball();
    const Bricks thin = split_mesh(path("thin"), mesh, {.bricks = 2, .halo_layers = 2}).bricks;
    EXPECT_THAT(error_of([&] { (void)limit_surface(thin, "f", {.boundary = true}); }), HasSubstr("split with --halo 3"));
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 2}).bricks;
    EXPECT_THAT(error_of([&] { (void)limit_surface(bricks, "f", {}); }), HasSubstr("nothing is asked for"));
    EXPECT_THAT(error_of([&] { (void)limit_surface(bricks, "none", {.isos = {0.3}}); }), HasSubstr("\"none\""));
    EXPECT_TRUE(limit_surface(bricks, "f", {.isos = {1e6}}).surface.triangles.empty());
}

}  // namespace brick_surface_test
}  // namespace subvol
