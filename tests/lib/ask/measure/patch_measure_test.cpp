// SPDX-License-Identifier: Apache-2.0
#include "subvol/patch_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol {
namespace patch_measure_test {

/// The hull of the limit, and of a box the side where x is 0.
Patch hull(const HexMesh& mesh) {
    CellSet all{"hull", {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) all.cells.push_back(c);
    return hull_of(mesh, all);
}
Patch side_at_0(const HexMesh& mesh) {
    Patch patch = hull(mesh);
    std::erase_if(patch.sides, [&](const CellSide& side) {
        return std::ranges::any_of(kCellFaces[side.side], [&](int k) {
            return mesh.points[mesh.cells[side.cell][static_cast<std::size_t>(k)]].x != 0;
        });
    });
    return patch;
}

/// Nothing of a constant is in doubt but the area, however its values are rounded.
TEST(PatchMeasure, TheErrorOfAConstantIsThatOfTheArea) {
    HexMesh mesh = make_model("ball", 4);
    mesh.attributes = {{"third", 1, std::vector<double>(mesh.points.size(), 1.0 / 3)}};
    Attribute tensor{"tensor", 9, {}};
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        for (int k = 0; k < 9; ++k) tensor.values.push_back(1.0 / (3 + k));
    }
    mesh.attributes.push_back(tensor);
    const std::vector<Patch> patches{hull(mesh)};
    const PatchMeasure found = measure_patches(mesh, patches)[0];
    mesh.attributes.clear();
    const PatchMeasure area = measure_patches(mesh, patches)[0];
    EXPECT_EQ(found.area, area.area) << "as many parts are integrated";
    EXPECT_NEAR(found.error, area.error, 1e-10) << "the rest are roundings";
    EXPECT_LE(found.error, 2e-4) << "as eight parts a side reach it beside irregular edges";
    EXPECT_NEAR(found.area, 4 * std::numbers::pi, 0.02 * found.area) << "about a sphere";
    ASSERT_EQ(found.fields.size(), 10u);
    for (std::size_t k = 0; k < 10; ++k) {
        const double value = k == 0 ? 1.0 / 3 : 1.0 / (2 + static_cast<double>(k));
        EXPECT_NEAR(found.fields[k].mean, value, 1e-10);
        EXPECT_NEAR(found.fields[k].min.value, value, found.fields[k].extreme_error + 1e-10);
        EXPECT_NEAR(found.fields[k].max.value, value, found.fields[k].extreme_error + 1e-10);
        EXPECT_LE(found.fields[k].extreme_error, 1e-4) << "of the range, which is less than 1";
    }
}

/// A flow along a side: what goes through it is nothing but roundings, and so is its error.
TEST(PatchMeasure, NoFlowHasNoError) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.attributes.clear();
    std::vector<double> flow;
    for (const Vec3& p : mesh.points) flow.insert(flow.end(), {1e-17 * p.y, 1.0 / 3, p.z / 7});
    const PatchMeasure found = measure_patches(mesh, std::vector{side_at_0(mesh)}, {.flux = flow})[0];
    EXPECT_NEAR(found.area, 4, 1e-12);
    EXPECT_NEAR(*found.flux, 0, 1e-12);
    EXPECT_LE(found.error, 1e-12);
}

/// The limit at x = 0 depends on all points, but stays in the plane: its vertices there, four levels finer, are on the patch.
TEST(PatchMeasure, NoValueLiesBeyondTheExtremes) {
    std::mt19937 random(3);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
    double largest_error = 0;
    for (int round = 0; round < 6; ++round) {
        HexMesh mesh = test::make_box(2, 3, 3);
        for (Vec3& p : mesh.points) p += Vec3(p.x == 0 ? 0 : between(-.2, .2), between(-.2, .2), between(-.2, .2));
        Attribute field{"f", 2, {}};
        for (std::size_t p = 0; p < 2 * mesh.points.size(); ++p) field.values.push_back(between(-1, 1));
        mesh.attributes = {field};
        const PatchMeasure found = measure_patches(mesh, std::vector{side_at_0(mesh)})[0];
        const HexMesh fine = on_limit(refine(mesh, {.levels = 4}), Scheme::Mcq);
        for (std::size_t c = 0; c < 2; ++c) {
            double least = HUGE_VAL, most = -HUGE_VAL;
            for (std::size_t p = 0; p < fine.points.size(); ++p) {
                if (std::abs(fine.points[p].x) > 1e-12) continue;
                least = std::min(least, fine.attributes[0].values[2 * p + c]);
                most = std::max(most, fine.attributes[0].values[2 * p + c]);
            }
            const PatchField& one = found.fields[c];
            EXPECT_GE(least, one.min.value - one.extreme_error);
            EXPECT_LE(most, one.max.value + one.extreme_error);
            constexpr double kBetween = 0.01;  // a parabola rises by an eighth of its bend (some 16 of a cell²) × 1/16² between
            EXPECT_NEAR(least, one.min.value, kBetween + one.extreme_error);
            EXPECT_NEAR(most, one.max.value, kBetween + one.extreme_error);
            largest_error = std::max(largest_error, one.extreme_error);
        }
    }
    EXPECT_LT(largest_error, 2e-3) << "ten times the tolerance of a range of 2";
}

}  // namespace patch_measure_test
}  // namespace subvol
