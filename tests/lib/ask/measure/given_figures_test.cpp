// SPDX-License-Identifier: Apache-2.0
// The figures of the cells as they were given, beside those of the limit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/patch_measure.h"
#include "subvol/quantity.h"

namespace subvol {
namespace given_figures_test {

/// The integral of the first attribute over trilinear cells: two places of Gauss an axis are exact for it.
double integral_of(const HexMesh& mesh) {
    double sum = 0;
    const double away = std::sqrt(1.0 / 3);
    for (const auto& cell : mesh.cells) {
        for (int place = 0; place < 8; ++place) {
            Vec3 uvw;
            for (int axis = 0; axis < 3; ++axis) uvw[axis] = ((place >> axis & 1) != 0 ? 1 + away : 1 - away) / 2;
            double value = 0;
            Mat3 jacobian(0.0);
            for (std::size_t k = 0; k < 8; ++k) {
                Vec3 share;
                for (int axis = 0; axis < 3; ++axis)
                    share[axis] = kCornerParameters[k][static_cast<std::size_t>(axis)] == 1 ? uvw[axis] : 1 - uvw[axis];
                value += share.x * share.y * share.z * mesh.attributes[0].values[cell[k]];
                for (int axis = 0; axis < 3; ++axis) {
                    const double sign = kCornerParameters[k][static_cast<std::size_t>(axis)] == 1 ? 1 : -1;
                    jacobian[axis] += sign * share[(axis + 1) % 3] * share[(axis + 2) % 3] * mesh.points[cell[k]];
                }
            }
            sum += value * glm::determinant(jacobian) / 8;
        }
    }
    return sum;
}

TEST(GivenFigures, AreThoseOfTrilinearCells) {
    for (const HexMesh& model : {make_model("ball", 3), test::irregular()}) {
        HexMesh mesh = model;
        std::mt19937 random(3);
        std::uniform_real_distribution<double> value(100, 101);
        mesh.attributes = {{"f", 1, {}}};
        for (std::size_t p = 0; p < mesh.points.size(); ++p) mesh.attributes[0].values.push_back(value(random));
        const PartMeasure whole = measure_limit(mesh).whole;
        const double volume = test::volume_of(mesh), integral = integral_of(mesh);
        EXPECT_NEAR(whole.given_volume, volume, 1e-12 * volume);
        const GivenFigures& given = whole.fields[0].given;
        EXPECT_NEAR(given.integral, integral, 1e-9 * integral);
        EXPECT_NEAR(given.mean, integral / volume, 1e-7);
        const std::vector<double>& values = mesh.attributes[0].values;
        for (const auto& [extreme, expected] :
             {std::pair{given.min, std::ranges::min_element(values)}, {given.max, std::ranges::max_element(values)}}) {
            EXPECT_NEAR(extreme.value, *expected, 1e-6);
            const auto point = static_cast<std::size_t>(expected - values.begin());
            ASSERT_TRUE(extreme.corner());
            EXPECT_EQ(mesh.cells[extreme.cell][*extreme.corner()], point);
            EXPECT_EQ(extreme.place, mesh.points[point]);
        }
    }
}

TEST(GivenFigures, AreAtAPointEvenIfAValueIsAllOverACell) {
    HexMesh mesh = test::make_box(3, 1, 1);
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(std::max(0.0, x.x - 2));
    const GivenFigures given = measure_limit(mesh).whole.fields[0].given;
    ASSERT_TRUE(given.min.corner());
    EXPECT_EQ(given.min.place, mesh.points[mesh.cells[given.min.cell][*given.min.corner()]]);
    EXPECT_LE(given.min.place.x, 2);
    EXPECT_EQ(given.max.place.x, 3);
}

TEST(GivenFigures, OfACutPartAreThoseOfTheCutCells) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes = {{"x", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(x.x);
    const std::vector<Region> regions = parse_regions(std::vector<std::string>{"half:.3,0,0,-1,0,0"});
    const PartMeasure part = measure_limit_in(mesh, regions).whole;
    EXPECT_NEAR(part.given_volume, .3, 1e-9);
    EXPECT_NEAR(part.fields[0].given.integral, .045, 1e-9);
    EXPECT_NEAR(part.fields[0].given.mean, .15, 1e-9);
    EXPECT_NEAR(part.fields[0].given.min.value, 0, 1e-6);
    EXPECT_NEAR(part.fields[0].given.max.value, .3, 1e-6);
}

TEST(GivenFigures, OfQuantitiesOfCellsAreThoseOfTheCells) {
    HexMesh mesh = test::make_box(2, 1, 1);
    mesh.attributes = {{.name = "U", .channels = 3, .values = std::vector<double>(3 * mesh.points.size(), 1.0)}};
    mesh.attributes[0].cells = {3, 4, 0, 0, 0, 12};
    for (const char* length : {"length(U)", "sqrt(U.x^2+U.y^2+U.z^2)"}) {
        HexMesh one = mesh;
        one.attributes = {field_of(mesh, "f", length)};
        const GivenFigures given = measure_limit(one).whole.fields[0].given;
        EXPECT_NEAR(given.mean, 8.5, 1e-12) << length;
        EXPECT_NEAR(given.min.value, 5, 1e-12) << length;
        EXPECT_NEAR(given.max.value, 12, 1e-12) << length;
        EXPECT_EQ(given.max.cell, 1U) << length;
    }
}

TEST(GivenFigures, AreNothingWhereNoCellIsInTheRegion) {
    // The limit of a ball reaches further than the sides of its cells.
    HexMesh mesh = make_model("ball", 2);
    const Vec3 along = glm::normalize(Vec3(1, .45, .2));
    mesh.attributes = {{"d", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(glm::dot(x, along));
    const FieldMeasure distance = measure_limit(mesh).whole.fields[0];
    ASSERT_GT(distance.max.value, distance.given.max.value + 1e-3);
    const Vec3 between = (distance.max.value + distance.given.max.value) / 2 * along;
    std::string half = "half:";
    for (const double number : {between.x, between.y, between.z, along.x, along.y, along.z})
        half += (half.ends_with(':') ? "" : ",") + std::to_string(number);
    const PartMeasure cap = measure_limit_in(mesh, parse_regions(std::vector{half})).whole;
    EXPECT_GT(cap.volume, 0);
    EXPECT_EQ(cap.given_volume, 0);
    for (const double nothing : {cap.fields[0].given.mean, cap.fields[0].given.integral, cap.fields[0].given.max.value})
        EXPECT_TRUE(std::isnan(nothing));
    for (const LimitExtreme& nowhere : {cap.fields[0].given.min, cap.fields[0].given.max}) {
        EXPECT_TRUE(std::isnan(nowhere.place.x) && std::isnan(nowhere.place.y) && std::isnan(nowhere.place.z));
        EXPECT_EQ(nowhere.cell, kNone);
    }
}

TEST(GivenFigures, OfPartsBeyondTheRegionAreNothing) {
    HexMesh mesh = test::make_box(4, 1, 1);
    mesh.attributes = {{"x", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(1 + x.x);
    const std::vector<Region> regions = parse_regions(std::vector<std::string>{"half:1.5,0,0,-1,0,0"});
    const std::vector<CellSet> sets{{"left", {0, 1}}, {"right", {2, 3}}};
    const std::vector<Index> groups{0, 0, 1, 1};
    for (const bool by_sets : {true, false}) {
        MeasureOptions options;
        options.names = {"left", "right"};
        if (by_sets) options.sets = sets;
        if (!by_sets) options.groups = groups;
        const LimitMeasure found = measure_limit_in(mesh, regions, options);
        ASSERT_EQ(found.parts.size(), 2U);
        EXPECT_NEAR(found.parts[0].volume, 1.5, 1e-9);
        const FieldMeasure& right = found.parts[1].fields[0];
        EXPECT_EQ(found.parts[1].volume, 0);
        EXPECT_EQ(right.integral, 0);
        for (const double nothing : {right.mean, right.min.value, right.max.value, right.min.place.x, right.max.place.x})
            EXPECT_TRUE(std::isnan(nothing));
        EXPECT_EQ(right.min.cell, kNone);
    }
}

TEST(GivenFigures, OfPatchesAreThoseOfBilinearSides) {
    HexMesh mesh = make_model("ball", 2);
    mesh.attributes = {{"x", 1, {}}};
    std::vector<double> ones;
    for (const Vec3& x : mesh.points) {
        mesh.attributes[0].values.push_back(x.x);
        ones.insert(ones.end(), {x.x, x.y, x.z});
    }
    CellSet all{"hull", {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) all.cells.push_back(c);
    const PatchMeasure hull = measure_patches(mesh, std::vector{hull_of(mesh, all)}, {.flux = ones})[0];
    // The flow of the position out of a body is three times its volume.
    EXPECT_NEAR(*hull.given_flux, 3 * test::volume_of(mesh), 1e-9);
    const GivenFigures& given = hull.fields[0].given;
    EXPECT_NEAR(given.mean, 0, 1e-9);
    for (const auto& [extreme, value] : {std::pair{given.max, bounds(mesh).upper.x}, {given.min, bounds(mesh).lower.x}}) {
        EXPECT_NEAR(extreme.value, value, 1e-6);
        ASSERT_TRUE(extreme.corner());
        const Index point = mesh.cells[extreme.cell][*extreme.corner()];
        EXPECT_EQ(extreme.place, mesh.points[point]);
        EXPECT_EQ(mesh.points[point].x, value);
    }
    EXPECT_LT(hull.given_area, hull.area);
    HexMesh box = test::make_box(2, 1, 1);
    CellSet two{"box", {0, 1}};
    EXPECT_NEAR(measure_patches(box, std::vector{hull_of(box, two)})[0].given_area, 10, 1e-12);
}

/// The cells have derivatives inside, but not at their points: what is made of those of the limit is not the file's.
TEST(GivenFigures, OfGradientsAreThoseOfTrilinearCells) {
    HexMesh mesh = test::make_box(4, 3, 2);  // cells of edge 1
    Attribute square{"T", 1, {}};
    for (const Vec3& x : mesh.points) square.values.push_back(x.x * x.x);
    mesh.attributes = {square};
    CellSet all{"all", {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) all.cells.push_back(c);
    Patch side = hull_of(mesh, all);
    std::erase_if(side.sides, [&](const CellSide& one) {
        return std::ranges::any_of(kCellFaces[one.side],
                                   [&](std::size_t k) { return mesh.points[mesh.cells[one.cell][k]].x != 4; });
    });
    ASSERT_EQ(side.sides.size(), 6u);
    // The slope of the trilinear cells at the side is 4² − 3² = 7 over an area of 6; that of x² is 8.
    const auto flow = [&](const std::string& vectors) {
        return measure_patches(mesh, std::vector{side}, {.flux_field = vector_field_of(mesh, vectors)})[0];
    };
    EXPECT_NEAR(flow("grad(T)").given_flux.value(), 42, 1e-9);
    EXPECT_NEAR(flow("grad(T)").flux.value(), 48, .5);
    EXPECT_FALSE(flow("vector(2*grad(T).x,0,0)").given_flux) << "left out rather than made of values at points";
    EXPECT_NEAR(flow("vector(T,0,0)").given_flux.value(), 96, 1e-9);
    mesh.attributes.push_back(field_of(mesh, "d", "grad(T).x + T"));
    const std::vector<FieldMeasure> whole = measure_limit(mesh).whole.fields;
    EXPECT_NEAR(whole[0].given.max.value, 16, 1e-12);
    EXPECT_TRUE(std::isnan(whole[1].given.max.value));
    EXPECT_TRUE(std::isnan(whole[1].given.integral));
    const std::vector<PatchField> fields = measure_patches(mesh, std::vector{side})[0].fields;
    EXPECT_NEAR(fields[0].given.mean, 16, 1e-9);
    EXPECT_TRUE(std::isnan(fields[1].given.mean));
}

TEST(GivenFigures, ExtremesOfPatchesHaveTheirPlaces) {
    // A linear field on one side of a box of cells, of which the limit is the box itself.
    HexMesh mesh = test::make_box(2, 3, 3);
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(x.y + 2 * x.z);
    Patch side{"x = 0", {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (mesh.points[mesh.cells[c][0]].x == 0) side.sides.push_back({c, 0});
    }
    const PatchField found = measure_patches(mesh, std::vector{side})[0].fields[0];
    for (const auto& [extreme, expected] : {std::pair{found.min, Vec3(0, 0, 0)},
                                            {found.max, Vec3(0, 3, 3)},
                                            {found.given.min, Vec3(0, 0, 0)},
                                            {found.given.max, Vec3(0, 3, 3)}}) {
        EXPECT_NEAR(glm::distance(extreme.place, expected), 0, 1e-6);
        ASSERT_LT(extreme.cell, mesh.cells.size());
        Box cell;
        for (const Index p : mesh.cells[extreme.cell]) cell.add(mesh.points[p]);
        EXPECT_TRUE(cell.lower == expected || glm::distance(cell.upper, expected) == 1) << "the cell in that corner";
    }
}

TEST(GivenFigures, OfASliceAreThoseOfTheCellsOnItsPlane) {
    HexMesh mesh = test::make_box(3, 4, 2);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> between(5, 6);
    mesh.attributes = {{"f", 1, {}}};
    for (std::size_t p = 0; p < mesh.points.size(); ++p) mesh.attributes[0].values.push_back(between(random));
    // In a plane of constant z trilinear cells of a box are bilinear: their extremes are at the edges that it cuts.
    constexpr double kZ = 1.3;
    std::map<std::pair<double, double>, double> on_edges;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        if (x.z == 1) on_edges[{x.x, x.y}] += (2 - kZ) * mesh.attributes[0].values[p];
        if (x.z == 2) on_edges[{x.x, x.y}] += (kZ - 1) * mesh.attributes[0].values[p];
    }
    const auto by_value = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [least, most] = std::ranges::minmax_element(on_edges, by_value);
    LimitSlice slice = slice_limit(mesh, "f", Vec3(0, 0, kZ), Vec3(0, 0, 1), {.resolution = 16});
    const SliceExtremes file = find_slice_extremes(mesh, slice);
    for (const auto& [extreme, expected] : {std::pair{file.min, *least}, {file.max, *most}}) {
        // Places are climbed to in steps of a part of a cell: 1e-4 of a range of 1.
        EXPECT_NEAR(extreme.value, expected.second, 1e-4);
        EXPECT_NEAR(glm::distance(extreme.place, Vec3(expected.first.first, expected.first.second, kZ)), 0, 1e-3);
    }
    EXPECT_GT(std::abs(slice.max - file.max.value), 1e-3) << "the limit has others";
}

TEST(GivenFigures, OfASliceHaveTheAreaAndTheMeanOfTheCells) {
    // Trilinear cells in a plane of constant z are polygons: those of a ball's control mesh, whose limit is rounder. The field
    // is their z alone where it is cut, plus x times a number whose mean is that of a symmetric body, 0.
    HexMesh mesh = make_model("ball", 3);
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(7 + x.z + 3 * x.x);
    constexpr double kZ = 0.31;
    // The area by the volume between two planes near it, by numbers that the slice does not use.
    const auto volume_below = [&](double z, const SchemeOptions& scheme) {
        const std::string half = "half:0,0," + std::to_string(z) + ",0,0,-1";
        MeasureOptions options;
        options.scheme = scheme;
        options.tolerance = 1e-6;
        return measure_limit_in(mesh, parse_regions(std::vector{half}), options).whole.volume;
    };
    const auto area = [&](const SchemeOptions& scheme) {
        constexpr double kHalf = .02;
        return (volume_below(kZ + kHalf, scheme) - volume_below(kZ - kHalf, scheme)) / (2 * kHalf);
    };
    const LimitSlice slice = slice_limit(mesh, "f", Vec3(0, 0, kZ), Vec3(0, 0, 1), {.resolution = 256});
    const SliceFigures limit = figures_of(mesh, slice), file = given_figures_of(mesh, slice);
    // What the area bends over the layer between the planes (5e-4 of it for a ball), and the squares at the rim.
    EXPECT_NEAR(limit.area, area({}), 1e-3 * limit.area);
    EXPECT_NEAR(file.area, area({.kind = Scheme::Linear}), 1e-3 * file.area);
    EXPECT_GT(limit.area, 1.02 * file.area);
    EXPECT_NEAR(file.mean, 7 + kZ, 1e-3);
    EXPECT_NEAR(limit.mean, 7 + kZ, 1e-3);
    EXPECT_NEAR(file.max.value, 7 + kZ + 3 * file.max.place.x, 1e-9);
}

TEST(GivenFigures, OfASliceOfCellsAreTheCells) {
    HexMesh mesh = test::make_box(4, 1, 2);
    mesh.attributes = {{.name = "m", .channels = 1, .values = std::vector<double>(mesh.points.size(), 2.5), .constant = true}};
    for (const auto& cell : mesh.cells) {
        const Vec3& x = mesh.points[cell[0]];
        mesh.attributes[0].cells.push_back(x.z == 0 ? 7 + x.x : 100);
    }
    LimitSlice slice = slice_limit(mesh, "m", Vec3(0, 0, 0.4), Vec3(0, 0, 1), {.resolution = 16});
    const SliceExtremes file = find_slice_extremes(mesh, slice);
    EXPECT_EQ(file.min.value, 7);
    EXPECT_EQ(file.max.value, 10);
    EXPECT_EQ(file.max.place, Vec3(3.5, 0.5, 0.5));
    EXPECT_EQ(slice.min, 7);
    EXPECT_EQ(slice.max, 10);
    EXPECT_NEAR(given_figures_of(mesh, slice).mean, 8.5, 1e-12);
    EXPECT_NEAR(given_figures_of(mesh, slice).area, 4, 1e-4);  // squares, which reach a little beyond the box
    // Cells that the plane misses have no figures, and so no places.
    std::vector<std::uint8_t> above(mesh.cells.size(), 0);
    for (std::size_t c = 0; c < above.size(); ++c) above[c] = mesh.points[mesh.cells[c][0]].z > 0 ? 1 : 0;
    const SliceFigures none = given_figures_of(mesh, slice, above);
    EXPECT_EQ(none.area, 0);
    EXPECT_TRUE(std::isnan(none.mean) && std::isnan(none.min.value) && std::isnan(none.min.place.z));
}

}  // namespace given_figures_test
}  // namespace subvol
