// SPDX-License-Identifier: Apache-2.0
#include "subvol/region.h"
#include "subvol/certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/warp.h"

namespace subvol {
namespace region_test {

/// A box of 4×4×4 unit cells with T = x + 10 y.
HexMesh box_with_field() {
    HexMesh mesh = test::make_box(4, 4, 4);
    Attribute field{"T", 1, {}};
    for (const Vec3& p : mesh.points) field.values.push_back(p.x + 10 * p.y);
    mesh.attributes = {field};
    return mesh;
}

std::size_t cells(const HexMesh& mesh, const std::vector<std::string>& texts) {
    std::vector<Region> regions;
    for (const std::string& text : texts) regions.emplace_back(text);
    return only_in(mesh, regions).cells.size();
}

TEST(Region, TakesCellsByTheirCentres) {
    const HexMesh mesh = box_with_field();
    EXPECT_EQ(cells(mesh, {"box:0,0,0,2,4,4"}), 32u);
    EXPECT_EQ(cells(mesh, {"box:0,0,0,2.4,4,4"}), 32u) << "a cell that is cut off its centre is out";
    EXPECT_EQ(cells(mesh, {"half:1,0,0,1,0,0"}), 48u) << "the side of the normal";
    EXPECT_EQ(cells(mesh, {"sphere:2,2,2,0.9"}), 8u);
    EXPECT_EQ(cells(mesh, {"half:1,0,0,1,0,0", "half:0,1,0,0,-1,0"}), 12u) << "all of them";
    HexMesh bent = mesh;
    bent.points[bent.cells[0][6]] += 3.0 * (bent.points[bent.cells[0][0]] - bent.points[bent.cells[0][6]]);
    const std::size_t folded = check_folds(bent).report.folded;
    EXPECT_GT(folded, 0u);
    EXPECT_EQ(cells(bent, {"fold:folded"}), folded);
    EXPECT_EQ(cells(mesh, {"fold:proved,folded"}), mesh.cells.size());
    EXPECT_EQ(cells(mesh, {"where:T>=20"}), 48u) << "cells with half of their corners";
    EXPECT_EQ(cells(mesh, {"where:x<=1"}), 32u) << "those beside the ones in it have four corners";
}

TEST(Region, KeepsFieldsAndPoints) {
    const HexMesh part = only_in(box_with_field(), std::vector{Region("box:2,0,0,4,4,4")});
    EXPECT_EQ(part.points.size(), 75u);
    for (std::size_t p = 0; p < part.points.size(); ++p) {
        EXPECT_GE(part.points[p].x, 2);
        EXPECT_EQ(part.attributes[0].values[p], part.points[p].x + 10 * part.points[p].y);
    }
}

TEST(Region, RefusesWhatIsNone) {
    const auto refused = [](const std::string& part, const std::string& text) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)Region(text); });
    };
    refused("6 numbers", "box:0,0,0,1,1");
    refused("6 numbers", "box:0,0,0,1,1,nan");
    refused("6 numbers", "box:0,0,0,1,1,1,");
    refused("no volume", "box:0,0,0,1,0,1");
    refused("no volume", "sphere:0,0,0,0");
    refused("no normal", "half:0,0,0,0,0,0");
    refused("is not a region", "cube:1");
    refused("is not a region", "where:");
    refused("is not a region", "fold:");
    refused("fold: 'folds' is unknown: did you mean folded?", "fold:proved,folds");
    refused("is not a region", "");
    test::expect_error(ErrorCode::InvalidInput, "no cell", [] { (void)cells(box_with_field(), {"sphere:9,9,9,1"}); });
}

LimitMeasure measured(const HexMesh& mesh, const std::vector<std::string>& texts, const MeasureOptions& options = {}) {
    std::vector<Region> regions;
    for (const std::string& text : texts) regions.emplace_back(text);
    return measure_limit_in(mesh, regions, options);
}

TEST(MeasureRegion, CutsStraightCellsExactly) {
    const HexMesh mesh = box_with_field();
    const PartMeasure box = measured(mesh, {"box:0.3,0.6,1.1,3.2,3.7,2.9"}).whole;
    EXPECT_NEAR(box.volume, 2.9 * 3.1 * 1.8, 2e-5 * box.volume) << "flat faces along the cells";
    EXPECT_NEAR(box.fields[0].mean, 1.75 + 10 * 2.15, 1e-4 * 44);
    EXPECT_NEAR(box.fields[0].integral, box.fields[0].mean * box.volume, 1e-9);
    EXPECT_GE(box.fields[0].min.value, 0.3 + 6 - 0.5);
    EXPECT_LE(box.fields[0].max.value, 3.2 + 37 + 0.5);
    const PartMeasure half = measured(mesh, {"half:1.7,0,0,-1,0,0"}).whole;
    EXPECT_NEAR(half.volume, 1.7 * 16, 1e-9) << "planes along the cells are exact";
    EXPECT_NEAR(half.fields[0].mean, 0.85 + 20, 2e-3);
    const PartMeasure slanted = measured(mesh, {"half:2,2,2,1,2,3"}).whole;
    EXPECT_NEAR(slanted.volume, 32, 2e-3) << "half of the box";
}

TEST(MeasureRegion, ErrorsAreAsLargeAsTheySay) {
    const HexMesh ball = make_model("ball", 8);
    const double sphere = 4 * std::numbers::pi / 3;
    const PartMeasure inside = measured(ball, {"sphere:0,0,0,0.5"}).whole;
    EXPECT_LT(inside.error, 5e-4);
    EXPECT_NEAR(inside.volume, sphere / 8, 1.5 * inside.error * inside.volume);
    const PartMeasure all = measured(ball, {"sphere:0,0,0,9"}).whole, whole = measure_limit(ball).whole;
    EXPECT_NEAR(all.volume, whole.volume, (all.error + whole.error) * whole.volume);
    EXPECT_NEAR(all.fields[0].mean, whole.fields[0].mean, 2e-4 * 2);
    EXPECT_NEAR(all.fields[0].max.value, whole.fields[0].max.value, all.fields[0].extreme_error);
    double histogram = 0;
    for (const double volume : all.fields[0].histogram) histogram += volume;
    EXPECT_NEAR(histogram, all.volume, 1e-3 * all.volume);
    test::expect_error(ErrorCode::InvalidInput, "no part of the volume", [&] { (void)measured(ball, {"sphere:9,9,9,1"}); });
}

TEST(MeasureRegion, PartsSumToTheWhole) {
    const HexMesh mesh = box_with_field();
    std::vector<Index> groups;
    for (const auto& cell : mesh.cells) groups.push_back(mesh.points[cell[0]].x < 2 ? 0 : 1);
    const LimitMeasure found = measured(mesh, {"box:0.5,0,0,3.5,4,1.25"}, {.groups = groups, .names = {"left", "right"}});
    ASSERT_EQ(found.parts.size(), 2u);
    EXPECT_EQ(found.parts[1].name, "right");
    EXPECT_NEAR(found.parts[0].volume + found.parts[1].volume, found.whole.volume, 1e-9);
    EXPECT_NEAR(found.parts[0].volume, 1.5 * 4 * 1.25, 1e-6);
}

TEST(Warp, MovesPointsByAVectorField) {
    HexMesh mesh = box_with_field();
    Attribute displacement{"D", 3, {}};
    for (const Vec3& p : mesh.points) displacement.values.insert(displacement.values.end(), {0, 0, p.x / 4});
    mesh.attributes.push_back(displacement);
    const HexMesh before = mesh;
    EXPECT_EQ(move_points(mesh, parse_warp("D*2")), 2);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_EQ(mesh.points[p], before.points[p] + Vec3(0, 0, before.points[p].x / 2));
    }
    EXPECT_EQ(mesh.attributes[1].values, before.attributes[1].values);
    mesh = before;
    EXPECT_NEAR(move_points(mesh, parse_warp("D*auto")), 0.1 * std::sqrt(48), 1e-12) << "the longest is 1";
    EXPECT_EQ(*parse_warp("D").factor, 1);
    EXPECT_EQ(*parse_warp("D*-1e-3").factor, -1e-3);
    const auto refused = [&](const std::string& part, const std::string& text) {
        HexMesh one = before;
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)move_points(one, parse_warp(text)); });
    };
    refused("a displacement has 3", "T");
    refused("did you mean", "d");
    refused("not a factor", "D*x");
    refused("not a factor", "D*inf");
}

}  // namespace region_test
}  // namespace subvol
