// SPDX-License-Identifier: Apache-2.0
// Integrals, extremes and histograms of a mesh in bricks are those of the mesh.
#include <gmock/gmock.h>

#include <numeric>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol {
namespace brick_measure_test {

using test::error_of;
using testing::HasSubstr;

constexpr std::array kShapes{BrickShape::Blocks, BrickShape::Slabs, BrickShape::Random};

class BrickMeasure : public test::TempFolder {};

TEST_F(BrickMeasure, ABoxHasItsClosedForm) {
    HexMesh mesh = test::make_box(9, 5, 4);
    test::add_field(mesh, "x", [](const Vec3& x) { return x.x; });
    for (const BrickShape shape : kShapes) {
        const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 4, .shape = shape}).bricks;
        const LimitMeasure found = measure_limit(bricks, {.scheme = {.kind = Scheme::Linear}, .bins = 9});
        constexpr double kFloat = 1e-6;  // nodes of pieces are floats
        EXPECT_EQ(found.whole.cells, 180U);
        EXPECT_EQ(found.pieces, 180U);
        EXPECT_NEAR(found.whole.volume, 180, 180 * kFloat);
        const FieldMeasure& field = found.whole.fields.at(0);
        EXPECT_EQ(field.name, "x");
        EXPECT_NEAR(field.integral, 180 * 4.5, 180 * 4.5 * kFloat);
        EXPECT_NEAR(field.mean, 4.5, 4.5 * kFloat);
        EXPECT_NEAR(field.min.value, 0, 9 * kFloat);
        EXPECT_NEAR(field.max.value, 9, 9 * kFloat);
        EXPECT_EQ(mesh.points[mesh.cells.at(field.max.cell)[1]].x, 9);
        for (const double volume : field.histogram) EXPECT_NEAR(volume, 20, 20 * kFloat);
    }
}

TEST_F(BrickMeasure, IsThatOfTheWhole) {
    HexMesh mesh = make_model("ball", 2);
    mesh.attributes.clear();
    test::jitter(mesh, 0.02, 3);
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x * x.x + 2 * x.y * x.y + x.z; });
    const MeasureOptions options{.tolerance = 2e-3, .bins = 16};
    const LimitMeasure whole = measure_limit(mesh, options);
    for (const BrickShape shape : {BrickShape::Blocks, BrickShape::Random}) {
        const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 3, .shape = shape}).bricks;
        const LimitMeasure found = measure_limit(bricks, options);
        EXPECT_EQ(found.whole.cells, whole.whole.cells);
        // Both are within the tolerance of the pieces.
        EXPECT_NEAR(found.whole.volume, whole.whole.volume, 2 * options.tolerance * whole.whole.volume);
        ASSERT_EQ(found.whole.fields.size(), whole.whole.fields.size());
        for (std::size_t f = 0; f < whole.whole.fields.size(); ++f) {
            const FieldMeasure &a = found.whole.fields[f], &b = whole.whole.fields[f];
            const double range = b.max.value - b.min.value;
            EXPECT_EQ(a.name, b.name);
            EXPECT_NEAR(a.mean, b.mean, 2 * options.tolerance * range);
            EXPECT_NEAR(a.min.value, b.min.value, 2e-6 * range);  // the tolerance of the limit
            EXPECT_NEAR(a.max.value, b.max.value, 2e-6 * range);
            EXPECT_EQ(a.max.cell, b.max.cell);
            const double all = std::accumulate(a.histogram.begin(), a.histogram.end(), 0.0);
            EXPECT_NEAR(all, found.whole.volume, 1e-9 * found.whole.volume);
        }
    }
}

TEST_F(BrickMeasure, SaysWhatItCannotDo) {
    const HexMesh mesh = test::make_box(4, 4, 4);
    const Bricks thin = split_mesh(path("thin"), mesh, {.bricks = 2, .halo_layers = 2}).bricks;
    EXPECT_THAT(error_of([&] { (void)measure_limit(thin); }), HasSubstr("split with --halo 3"));
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 2}).bricks;
    EXPECT_THAT(error_of([&] { (void)measure_limit(bricks, {.tolerance = 0}); }), HasSubstr("tolerance"));
    const std::vector<Index> groups(64, 0);
    EXPECT_THAT(error_of([&] { (void)measure_limit(bricks, {.groups = groups}); }), HasSubstr("groups"));
}

}  // namespace brick_measure_test
}  // namespace subvol
