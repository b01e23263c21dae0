// SPDX-License-Identifier: Apache-2.0
// Quantities that are not linear, between the points of a mesh: against closed forms of components whose limit is exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lib/test_meshes.h"
#include "subvol/boundary_values.h"
#include "subvol/dense_cells.h"
#include "subvol/detail/place_function.h"
#include "subvol/field_bounds.h"
#include "subvol/limit.h"
#include "subvol/limit_field.h"
#include "subvol/limit_level.h"
#include "subvol/limit_slice.h"
#include "subvol/measure.h"
#include "subvol/mesh_motion.h"
#include "subvol/model.h"
#include "subvol/probe.h"
#include "subvol/quantity.h"

namespace subvol {
namespace place_values_test {

HexMesh with_quantity(HexMesh mesh, const std::string& source) {
    mesh.attributes = {field_of(mesh, "q", source)};
    return mesh;
}

std::vector<LimitQuery> some_places(const HexMesh& mesh, int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<LimitQuery> queries;
    for (int i = 0; i < count; ++i) {
        queries.push_back({static_cast<Index>(random() % mesh.cells.size()), {unit(random), unit(random), unit(random)}});
    }
    return queries;
}

// The limit of the coordinates is the place itself, so the length of vector(x,y,z) is that of the place, whatever the mesh.
TEST(PlaceValues, TheLengthOfThePlaceIsThatOfThePlace) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Linear}) {
        const HexMesh mesh = with_quantity(make_model("twist", 2), "mag(vector(x,y,z))");
        const auto queries = some_places(mesh, 200);
        const LimitSamples found = evaluate_limit(mesh, queries, {.scheme = {.kind = scheme}});
        ASSERT_EQ(found.attributes.size(), 1u);
        ASSERT_EQ(found.attributes[0].channels, 1u);
        for (std::size_t q = 0; q < queries.size(); ++q) {
            const Vec3& x = found.positions[q];
            EXPECT_NEAR(found.attributes[0].values[q], glm::length(x), 1e-12);
            // By the chain rule ∂|x|/∂u = x/|x| · ∂x/∂u. Differences are exact to 1e-10 of the range.
            const Vec3 slope = glm::transpose(found.jacobians[q]) * (x / glm::length(x));
            EXPECT_LT(glm::distance(found.attributes[0].derivatives[q], slope), 1e-8 * (1 + 1 / glm::length(x)));
        }
    }
}

TEST(PlaceValues, AProbeFindsThemToo) {
    const LimitProbe probe(with_quantity(make_model("twist", 2), "mag(vector(x,y,z))"));
    const std::vector<Vec3> places{{.1, .1, .1}, {-.2, .3, .05}, {.01, 0, 0}};
    const ProbeResult found = probe.at(places);
    for (std::size_t p = 0; p < places.size(); ++p) {
        ASSERT_TRUE(found.inside(p));
        EXPECT_NEAR(found.fields[0].values[p], glm::length(places[p]), 1e-9);
        // A gradient is that of a place at most 2e-5 of a cell away, and turns by 1/|x|.
        EXPECT_LT(glm::distance(found.fields[0].gradients[p], glm::normalize(places[p])), 1e-5 / glm::length(places[p]));
    }
}

/// The box [-1,1]³. The origin is one of its points only if the number of cells a side is even.
HexMesh centred_box(Index cells) {
    HexMesh mesh = test::make_box(cells, cells, cells);
    for (Vec3& p : mesh.points) p = 2.0 / cells * p - Vec3(1.0);
    return mesh;
}

// Nodes of all refinements are values of the function at them, and never negative.
TEST(PlaceValues, RefinementsHaveThemAtTheirNodes) {
    const HexMesh mesh = with_quantity(centred_box(3), "length(vector(x,y,z))");
    // Pieces are floats.
    const auto expect = [](const char* of, const Vec3& x, double value) { EXPECT_NEAR(value, glm::length(x), 1e-6) << of; };
    for (const DenseBits bits : {DenseBits::OfRefine, DenseBits::ToRounding}) {
        const DenseCells dense(mesh, {.levels = 2}, true, bits);
        std::vector<Index> cells(mesh.cells.size());
        for (Index c = 0; c < cells.size(); ++c) cells[c] = c;
        dense.for_each(cells, [&](const DenseCell& cell) {
            ASSERT_EQ(cell.values[0].size(), cell.points.size());
            for (std::size_t n = 0; n < cell.points.size(); ++n) expect("dense", cell.points[n], cell.values[0][n]);
        });
    }
    const LimitCells limit = find_limit_cells(mesh, {}, {.position_world = 1e-3, .value_of_range = 1e-3});
    ASSERT_TRUE(limit.pieces);
    ASSERT_EQ(limit.pieces->node_size, 4u);
    for (std::size_t piece = 0; piece < limit.pieces->cells.size(); ++piece) {
        for (std::size_t n = 0; n < LimitPieces::kNodes; ++n) {
            expect("pieces", limit.pieces->position(piece, n), limit.pieces->value(piece, n, 0));
            EXPECT_GE(limit.pieces->value(piece, n, 0), 0);
        }
    }
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const RefineOptions options{.scheme = {.kind = scheme}, .levels = 2};
        const HexMesh fine = on_limit(refine(mesh, options), scheme);
        for (std::size_t p = 0; p < fine.points.size(); ++p) expect("refined", fine.points[p], fine.attributes[0].values[p]);
        const BoundaryValues hull = boundary_values(mesh, options), again = BoundaryTables(mesh, options).apply(mesh);
        for (const BoundaryValues* one : {&hull, &again}) {
            for (std::size_t p = 0; p < one->surface.points.size(); ++p)
                expect(one == &hull ? "hull" : "tables", one->surface.points[p], one->values[0][p]);
        }
    }
    const LimitField field(mesh, "q", {});
    for (const Vec3& x : {Vec3(.1, .02, .03), Vec3(0, 0, 0), Vec3(.9, -.8, .7)}) {
        ASSERT_TRUE(field.value(x));
        EXPECT_GE(*field.value(x), 0);
        EXPECT_NEAR(*field.value(x), glm::length(x), .03) << "pieces of an eighth of a cell, at the tip of the cone";
    }
}

// ∫ of x² + y² + z² over [-1,1]³ is 8, its mean 1; the mean of |x| is 1/2. The least values lie between the points of three
// cells a side, where those at the points are 1/3 or more.
TEST(PlaceValues, MeasuresOfPowersAndLengths) {
    HexMesh mesh = centred_box(3);
    mesh.attributes = {field_of(mesh, "square", "x^2+y^2+z^2"), field_of(mesh, "length", "length(vector(x,y,z))"),
                       field_of(mesh, "side", "abs(x)")};
    const PartMeasure found = measure_limit(mesh).whole;
    EXPECT_NEAR(found.fields[0].mean, 1, 1e-9);
    EXPECT_NEAR(found.fields[0].min.value, 0, 1e-6);
    EXPECT_NEAR(found.fields[0].max.value, 3, 1e-9);
    EXPECT_NEAR(found.fields[1].min.value, 0, 2e-4);  // the search ends within 1e-4 of the range
    EXPECT_NEAR(found.fields[1].max.value, std::numbers::sqrt3, 1e-9);
    EXPECT_LT(glm::length(found.fields[1].min.place), 1e-3);
    EXPECT_NEAR(found.fields[2].mean, .5, 2e-3) << "a kink through the middle of cells";
    for (const FieldMeasure& field : found.fields) EXPECT_GE(field.min.value, 0) << field.name;
    const std::vector<Region> ball = parse_regions(std::vector<std::string>{"sphere:0,0,0,.5"});
    const PartMeasure part = measure_limit_in(mesh, ball).whole;
    EXPECT_NEAR(part.fields[0].mean, 3. / 5 * .25, 1e-3);  // ∫ r⁴ / ∫ r² = 3/5 R²
    EXPECT_NEAR(part.fields[0].max.value, .25, 1e-3);
    EXPECT_NEAR(part.fields[1].mean, 3. / 4 * .5, 3e-3);
}

// A stress that is linear in the place: of uniaxial bending, σxx = z, the von Mises stress is |z|, 0 between the points.
TEST(PlaceValues, BendingHasNoStressInTheMiddle) {
    HexMesh mesh = centred_box(3);
    Attribute stress{"STRESS", 6, {}};
    for (const Vec3& p : mesh.points) stress.values.insert(stress.values.end(), {100 * p.z, 0, 0, 0, 0, 0});
    mesh.attributes = {stress};
    mesh.attributes = {select_field(mesh, "STRESS").scalar};
    const auto queries = some_places(mesh, 100);
    const LimitSamples found = evaluate_limit(mesh, queries);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        EXPECT_NEAR(found.attributes[0].values[q], 100 * std::abs(found.positions[q].z), 1e-10);
    }
    const FieldMeasure whole = measure_limit(mesh).whole.fields[0];
    EXPECT_NEAR(whole.min.value, 0, 2e-2);
    EXPECT_NEAR(whole.max.value, 100, 1e-9);
    EXPECT_NEAR(whole.mean, 50, .2);
}

// The largest value on a plane, between the places of a coarse slice: of 1 − |x − c|² it is that at c, whatever the resolution.
TEST(PlaceValues, ExtremesOfASliceDoNotDependOnItsResolution) {
    const HexMesh mesh = with_quantity(centred_box(4), "1-((x-.123)^2+(y-.345)^2+z^2)");
    for (const int resolution : {2, 9, 64}) {
        LimitSlice slice = slice_limit(mesh, "q", Vec3(0.0), Vec3(0, 0, 1), {.resolution = resolution});
        find_slice_extremes(mesh, slice);
        EXPECT_NEAR(slice.max, 1, 1e-6) << resolution;
        EXPECT_LT(glm::distance(slice.max_at, Vec3(.123, .345, 0)), 1e-3) << resolution;
        EXPECT_NEAR(slice.min, 1 - (1.123 * 1.123 + 1.345 * 1.345), 1e-4) << resolution;
        EXPECT_LT(glm::distance(slice.min_at, Vec3(-1, -1, 0)), 1e-3) << resolution;
    }
}

// Values that jump from 0 to 1 become negative in between, where their root is not a number: there the limit of the values at
// the points stands for it.
TEST(PlaceValues, AreFinite) {
    HexMesh mesh = centred_box(4);
    Attribute jump{"T", 1, {}};
    for (const Vec3& p : mesh.points) jump.values.push_back(p.x < .25 ? 0 : 1);
    mesh.attributes = {jump, field_of(HexMesh{mesh.points, mesh.cells, {jump}, {}, {}}, "root", "sqrt(T)")};
    double least = 1;
    const LimitSamples found = evaluate_limit(mesh, some_places(mesh, 400));
    for (std::size_t q = 0; q < found.positions.size(); ++q) {
        const double value = found.attributes[0].values[q];
        EXPECT_NEAR(found.attributes[1].values[q], value >= 0 ? std::sqrt(value) : 0, value >= 0 ? 1e-12 : 0);
        least = std::min(least, value);
    }
    EXPECT_LT(least, -.01);
}

TEST(PlaceValues, LinearQuantitiesStayAtThePoints) {
    HexMesh mesh = centred_box(2);
    mesh.attributes = {{"T", 1, std::vector<double>(mesh.points.size(), 2)}, field_of(mesh, "U", "vector(x,y,z)")};
    for (const char* linear : {"T", "U", "U.x", "(T-293)/620", "-2*T+3*(x-y)/4", "vector(T,2*T,x)", "grad(T)", "div(U)", "3"})
        EXPECT_EQ(field_of(mesh, "q", linear).function, nullptr) << linear;
    for (const char* other : {"T^2", "T*x", "1/T", "abs(T)", "T>1", "length(U)", "vector(T^2,0,0)", "U+1", "norm(grad(T))"})
        EXPECT_NE(field_of(mesh, "q", other).function, nullptr) << other;
    const auto is_never_negative = [&](const char* source) {
        const Attribute field = field_of(mesh, "q", source);
        return !field.bounds.empty() && field.bounds[0][0] == 0;
    };
    for (const char* size :
         {"length(U)", "T^2", "abs(x)+x^4", "2*length(U)", "sqrt(x^2+y^2)", "max(abs(x),1)", "U/2", "(x>0)*2", "x<1 && y>0"})
        EXPECT_TRUE(is_never_negative(size)) << size;
    EXPECT_EQ(field_of(mesh, "q", "(x>0)").bounds, (std::vector<std::array<double, 2>>{{0, 1}}));
    for (const char* any : {"T", "x*y", "-length(U)", "length(U)-1", "x^3", "T+x^2", "min(x,1)", "1-x^2", "2^x*x"})
        EXPECT_FALSE(is_never_negative(any)) << any;
}

TEST(PlaceValues, OfNoPoints) {
    const HexMesh none;
    for (const char* source : {"vector(x^2,y,z)", "x^2+length(vector(x,y,z))", "3"})
        EXPECT_TRUE(field_of(none, "q", source).values.empty()) << source;
}

TEST(PlaceValues, GoWithThePointsOfAMesh) {
    HexMesh mesh = with_quantity(centred_box(3), "length(vector(x,y,z))");
    mesh.points.emplace_back(9, 9, 9);  // that no cell uses
    mesh.attributes[0].values.push_back(std::sqrt(243));
    mesh.attributes[0].arguments.insert(mesh.attributes[0].arguments.end(), {9, 9, 9});
    const HexMesh used = without_unused_points(mesh);
    EXPECT_EQ(used.attributes[0].arguments.size(), 3 * used.points.size());
    HexMesh half = only_in(used, std::vector<Region>{Region("half:0,0,0,1,0,0")});
    EXPECT_EQ(half.attributes[0].arguments.size(), 3 * half.points.size());
    const auto queries = some_places(half, 20);
    const LimitSamples found = evaluate_limit(half, queries);
    for (std::size_t q = 0; q < queries.size(); ++q)
        EXPECT_NEAR(found.attributes[0].values[q], glm::length(found.positions[q]), 1e-12);
    // Half way between two meshes the arguments are in the middle, not the lengths.
    HexMesh turned = used;
    for (Vec3& p : turned.points) p = -p;
    turned = with_quantity(turned, "length(vector(x,y,z))");
    const HexMesh middle = mesh_between(used, turned, .5);
    for (const double value : middle.attributes[0].values) EXPECT_NEAR(value, 0, 1e-15);
    detail::change_values(half.attributes[0], [](double value) { return 5 - 2 * value; });
    const LimitSamples changed = evaluate_limit(half, queries);
    for (std::size_t q = 0; q < queries.size(); ++q)
        EXPECT_NEAR(changed.attributes[0].values[q], 5 - 2 * glm::length(found.positions[q]), 1e-12);
}

// Values that jump from 0 to 1 overshoot in the limit. Within the range of what was given they do not.
TEST(FieldBounds, KeepTheLimitInTheRangeThatWasGiven) {
    HexMesh mesh = test::make_box(4, 4, 4);
    Attribute jump{"T", 1, {}};
    for (const Vec3& p : mesh.points) jump.values.push_back(p.x < 1.5 ? 3 : 7);
    mesh.attributes = {jump};
    const auto range = [](const HexMesh& of) {
        const FieldMeasure field = measure_limit(of).whole.fields[0];
        return std::pair(field.min.value, field.max.value);
    };
    EXPECT_LT(range(mesh).first, 2.9);
    EXPECT_GT(range(mesh).second, 7.1);
    HexMesh kept = mesh;
    bound_as_given(kept);
    EXPECT_EQ(range(kept), std::pair(3.0, 7.0));
    Attribute cells{"T", 1, std::vector<double>(mesh.cells.size(), 4)};
    cells.values[0] = 6;
    kept = mesh;
    bound_as_given(kept, std::vector<Attribute>{cells});
    EXPECT_EQ(range(kept), std::pair(4.0, 6.0)) << "the range of the cells";
    bound_as_given(kept);
    EXPECT_EQ(range(kept), std::pair(4.0, 6.0)) << "bounds that are there stay";
}

TEST(FieldBounds, FractionsAreKnownByNameAndRange) {
    HexMesh mesh = test::make_box(1, 1, 1);
    const auto add = [&](const char* name, double low, double high) {
        mesh.attributes.push_back({name, 1, {low, high, high, high, high, high, high, high}});
    };
    add("alpha.water", 0, 1);
    add("alphat", 0, .5);
    add("VolumeFraction", .2, .4);
    add("saturation", 0, 1.5);
    add("T", 0, 1);
    EXPECT_EQ(bound_fractions(mesh), (std::vector<std::string>{"alpha.water", "VolumeFraction"}));
    EXPECT_TRUE(bound_fractions(mesh).empty()) << "once";
    EXPECT_EQ(mesh.attributes[2].bounds[0], (std::array<double, 2>{0, 1}));
    EXPECT_TRUE(mesh.attributes[3].bounds.empty()) << "its values are beyond 1";
}

}  // namespace place_values_test
}  // namespace subvol
