// SPDX-License-Identifier: Apache-2.0
#include "subvol/region.h"
#include "subvol/certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/refine.h"
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

/// A box of 2³ unit cells whose limit is the box and whose field is x.
HexMesh two_by_two() {
    HexMesh mesh = test::make_box(2, 2, 2);
    Attribute field{"f", 1, {}};
    for (const Vec3& p : mesh.points) field.values.push_back(p.x);
    mesh.attributes = {field};
    return mesh;
}

TEST(MeasureRegion, ExtremesAreThoseOfWhatIsCut) {
    struct Case {
        std::string region;
        double min, max;
    };
    for (const auto& [region, min, max] :
         {Case{"half:0.3,0,0,-1,0,0", 0, 0.3}, Case{"half:0.55,0,0,-1,0,0", 0, 0.55}, Case{"half:0.55,0,0,1,0,0", 0.55, 2},
          Case{"box:.1,.1,.1,.13,1.9,1.9", 0.1, 0.13}, Case{"box:.1,.1,.1,1.1,1.100001,.100001", 0.1, 1.1},
          Case{"sphere:.5,.5,.5,.01", 0.49, 0.51}, Case{"sphere:1,1,1,.25", 0.75, 1.25}, Case{"half:1,1,1,-1,-1,-1", 0, 2},
          Case{"half:.2,.2,.2,-1,-1,-1", 0, 0.6}}) {
        const FieldMeasure field = measured(two_by_two(), {region}).whole.fields[0];
        EXPECT_NEAR(field.min.value, min, field.extreme_error) << region;
        EXPECT_NEAR(field.max.value, max, field.extreme_error) << region;
        EXPECT_LE(field.extreme_error, 2e-4) << region << ": the tolerance is 1e-4 of the range, which is 2";
        EXPECT_NEAR(field.max.place.x, field.max.value, 1e-6) << region << ": the field is x";
    }
    const FieldMeasure both = measured(two_by_two(), {"half:.5,0,0,1,0,0", "sphere:.5,1,1,.25"}).whole.fields[0];
    EXPECT_NEAR(both.min.value, 0.5, both.extreme_error);
    EXPECT_NEAR(both.max.value, 0.75, both.extreme_error);
}

TEST(MeasureRegion, SmallRegionsAreFound) {
    constexpr double kBall = 4 * std::numbers::pi / 3;
    const auto volume_of = [](const HexMesh& mesh, const std::vector<std::string>& regions, double volume) {
        const PartMeasure found = measured(mesh, regions).whole;
        EXPECT_NEAR(found.volume, volume, found.error * volume + 1e-9 * volume) << regions[0];
        EXPECT_LT(found.error, 0.02) << regions[0];
        EXPECT_GE(found.cells, 1u);
    };
    volume_of(two_by_two(), {"sphere:.5,.5,.5,.01"}, kBall * 1e-6);
    volume_of(two_by_two(), {"sphere:.37,.61,1.43,1e-4"}, kBall * 1e-12);
    volume_of(two_by_two(), {"sphere:1,1,1,1e-3"}, kBall * 1e-9);
    volume_of(two_by_two(), {"sphere:0,0,0,1e-3"}, kBall * 1e-9 / 8);
    volume_of(two_by_two(), {"box:0,0,0,1e-3,2e-3,3e-3"}, 6e-9);
    volume_of(two_by_two(), {"box:.999,.4,.1,1.001,1.6,1.9"}, 2e-3 * 1.2 * 1.8);
    // Between two planes along a diagonal: as long as the box is wide there, on the average.
    const double thin = 1e-4, diagonal = std::sqrt(8.0);
    volume_of(two_by_two(), {"half:1,1,0,1,1,0", "half:1.00005,1.00005,0,-1,-1,0"},
              2 * thin / std::sqrt(2.0) * (diagonal - thin / std::sqrt(2.0)));
    // A cell of a bent body: where it is does not matter to the volume.
    volume_of(make_model("ball", 4), {"sphere:.51,.32,.17,.003"}, kBall * 2.7e-8);
    volume_of(make_model("ball", 4), {"box:-.4,-.3,.1,.4,.3,.1001"}, 0.8 * 0.6 * 1e-4);
}

/// No value of the limit, at the vertices of four levels more, lies beyond what is said of the region, and what is said is not
/// far from them.
TEST(MeasureRegion, ExtremesAreBounds) {
    std::mt19937 random(5);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
    for (const char* region :
         {"half:1,1,1,-.5,.7,.3", "sphere:.7,1.2,1.1,.4", "box:.5,.1,.1,.8,1.9,1.9", "half:1.1,1,1,1,0,0"}) {
        HexMesh mesh = test::make_box(2, 2, 2);
        mesh.cells.pop_back();  // an edge that is irregular
        mesh = without_unused_points(std::move(mesh));
        for (Vec3& p : mesh.points) p += Vec3(between(-.15, .15), between(-.15, .15), between(-.15, .15));
        Attribute field{"f", 1, {}};
        for (std::size_t p = 0; p < mesh.points.size(); ++p) field.values.push_back(between(-1, 1));
        mesh.attributes = {field};
        const FieldMeasure found = measured(mesh, {region}).whole.fields[0];
        const HexMesh fine = on_limit(refine(mesh, {.levels = 4}), Scheme::Mcq);
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (std::size_t p = 0; p < fine.points.size(); ++p) {
            if (Region(region).depth(fine.points[p]) < 0) continue;
            least = std::min(least, fine.attributes[0].values[p]);
            most = std::max(most, fine.attributes[0].values[p]);
        }
        EXPECT_GE(least, found.min.value - found.extreme_error) << region;
        EXPECT_LE(most, found.max.value + found.extreme_error) << region;
        constexpr double kBetween = 0.15;  // of a range of 2: between vertices, where the limit is steep and cut
        EXPECT_NEAR(least, found.min.value, found.extreme_error + kBetween) << region;
        EXPECT_NEAR(most, found.max.value, found.extreme_error + kBetween) << region;
        EXPECT_LT(found.extreme_error, 0.1)
            << region << ": random values, which pieces of three levels resolve to some per cent";
    }
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
