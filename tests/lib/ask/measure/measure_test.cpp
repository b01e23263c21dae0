// SPDX-License-Identifier: Apache-2.0
#include "subvol/measure.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "lib/expect_error.h"
#include "lib/finite_volumes.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace measure_test {

TEST(Measure, IntegralOfALinearFieldOverABox) {
    HexMesh mesh = test::make_box(3, 2, 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x + 2 * p.z; });
    const LimitMeasure found = measure_limit(mesh, {.bins = 10});
    const FieldMeasure& field = found.whole.fields.at(0);
    EXPECT_NEAR(found.whole.volume, 24, 1e-9);
    EXPECT_NEAR(field.integral, 24 * (1.5 + 4), 1e-8);
    EXPECT_NEAR(field.mean, 5.5, 1e-9);
    EXPECT_NEAR(field.min.value, 0, 1e-9);
    EXPECT_NEAR(field.max.value, 11, 1e-9);
    EXPECT_NEAR(field.max.place.x, 3, 1e-9);
    EXPECT_NEAR(field.max.place.z, 4, 1e-9);
    EXPECT_NEAR(std::accumulate(field.histogram.begin(), field.histogram.end(), 0.0), 24, 1e-9);
}

// Values that jump from point to point: what a cell changes says little about what it leaves, and its neighbours have to.
TEST(Measure, IsOffByNoMoreThanItSays) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        HexMesh mesh = test::distorted_box(5, .15);
        std::mt19937 random(seed);
        std::vector<double> values(mesh.points.size());
        for (double& value : values) value = static_cast<double>(random() % 2);
        mesh.attributes = {{"f", 1, values}};
        const double exact = measure_limit(refine(mesh, {.levels = 2}), {.tolerance = 1e-6}).whole.fields[0].mean;
        for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
            const PartMeasure found = measure_limit(mesh, {.tolerance = tolerance}).whole;
            EXPECT_LE(std::abs(found.fields[0].mean - exact), found.error) << seed << ' ' << tolerance;
            EXPECT_LE(found.error, tolerance) << seed;
        }
    }
}

TEST(Measure, VolumeOfTheBallConvergesToItsClosedForm) {
    // The control points lie on the sphere, and so do the limit's vertices: what is between them converges.
    const double exact = 4.0 / 3 * std::numbers::pi;
    double last = 1;
    for (const int resolution : {4, 8}) {
        const double error = std::abs(measure_limit(make_model("ball", resolution)).whole.volume / exact - 1);
        EXPECT_LT(error, last / 4) << resolution;
        last = error;
    }
    EXPECT_LT(last, 1e-3);
}

TEST(Measure, IntegralOfTheTwistIsThatOfItsClosedForm) {
    // Midpoints of 60³ parameters, which are of second order: 1e-4 of the integral.
    constexpr int kSide = 60;
    const double h = 2.0 / kSide;
    double volume = 0, integral = 0;
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
        const Vec3 p = Vec3(i % kSide, i / kSide % kSide, i / kSide / kSide) * h + Vec3(h / 2 - 1);
        Mat3 jacobian;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 step(0);
            step[axis] = 1e-5;
            jacobian[axis] = (TwistField::position(p + step) - TwistField::position(p - step)) / 2e-5;
        }
        const double part = glm::determinant(jacobian) * h * h * h;
        volume += part;
        integral += part * TwistField::density(p);
    }
    const LimitMeasure found = measure_limit(make_model("twist", 24));
    EXPECT_NEAR(found.whole.volume / volume, 1, 2e-4);
    EXPECT_NEAR(found.whole.fields[0].mean, integral / volume, 5e-4);
}

TEST(Measure, ExtremesAreThoseOfTheLimitAndLieThere) {
    // A bump between control points, which overshoots: no vertex has the largest value.
    HexMesh mesh = test::make_box(6, 6, 6);
    test::add_field(mesh, "f", [](const Vec3& p) { return -glm::dot(p - Vec3(2.4, 3.1, 2.7), p - Vec3(2.4, 3.1, 2.7)); });
    const FieldMeasure field = measure_limit(mesh).whole.fields[0];
    EXPECT_NEAR(field.max.value, 0, 1e-5);  // quadratics are reproduced; the place is right to 1e-3
    EXPECT_NEAR(glm::distance(field.max.place, Vec3(2.4, 3.1, 2.7)), 0, 5e-3);
    const LimitSamples there = evaluate_limit(mesh, std::vector<LimitQuery>{{field.max.cell, field.max.uvw}});
    EXPECT_EQ(there.attributes[0].values[0], field.max.value);
    EXPECT_EQ(there.positions[0], field.max.place);
}

TEST(Measure, PartsAddUpToTheWhole) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y; });
    mesh.attributes.push_back({"v", 2, std::vector<double>(2 * mesh.points.size(), 1.5)});
    std::vector<Index> groups;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) groups.push_back(static_cast<Index>(c % 3));
    const LimitMeasure found = measure_limit(mesh, {.groups = groups, .names = {"a", "b", "c"}});
    ASSERT_EQ(found.parts.size(), 3u);
    ASSERT_EQ(found.whole.fields.size(), 3u);
    EXPECT_EQ(found.whole.fields[1].name, "v.0");
    EXPECT_NEAR(found.whole.fields[1].mean, 1.5, 1e-6);
    double volume = 0, integral = 0;
    std::size_t cells = 0;
    for (const PartMeasure& part : found.parts) {
        volume += part.volume;
        integral += part.fields[0].integral;
        cells += part.cells;
        EXPECT_LE(part.fields[0].max.value, found.whole.fields[0].max.value);
    }
    EXPECT_NEAR(volume, found.whole.volume, 1e-12 * volume);
    EXPECT_NEAR(integral, found.whole.fields[0].integral, 1e-12);
    EXPECT_EQ(cells, mesh.cells.size());
    EXPECT_EQ(found.parts[1].name, "b");
}

/// Sets of cells of a box of 4×2×2 unit cubes with f = x, that overlap: what lies between two planes x = const.
TEST(Measure, SetsWithCommonCellsHaveTheirOwnFigures) {
    HexMesh mesh = test::make_box(4, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const auto between = [&](const std::string& name, double from, double to) {
        CellSet set{name, {}};
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            const double x = mesh.points[mesh.cells[c][0]].x;
            if (x >= from && x < to) set.cells.push_back(c);
        }
        return set;
    };
    const std::vector<std::array<double, 2>> ends{{0, 3}, {2, 4}, {0, 4}, {2, 3}};
    std::vector<CellSet> sets;
    for (const auto& [from, to] : ends) sets.push_back(between("from " + std::to_string(from), from, to));
    const std::vector<Region> lower{Region("half:0,1,0,0,-1,0")};
    const LimitMeasure whole = measure_limit(mesh, {.scheme = {.kind = Scheme::Linear}, .bins = 4, .sets = sets});
    const LimitMeasure half = measure_limit_in(mesh, lower, {.scheme = {.kind = Scheme::Linear}, .sets = sets});
    ASSERT_EQ(whole.parts.size(), sets.size());
    ASSERT_EQ(half.parts.size(), sets.size());
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto& [from, to] = ends[s];
        for (const auto* found : {&whole, &half}) {
            const PartMeasure& part = found->parts[s];
            const double area = found == &whole ? 4 : 2, volume = area * (to - from);
            const double least = found == &whole ? 1e-12 : 1e-6;  // pieces of regions are kept as floats
            EXPECT_EQ(part.name, sets[s].name);
            EXPECT_EQ(part.cells, static_cast<std::size_t>(volume));
            EXPECT_NEAR(part.volume, volume, least * volume);
            EXPECT_NEAR(part.given_volume, volume, least * volume);
            EXPECT_NEAR(part.fields[0].mean, (from + to) / 2, 4 * least);
            EXPECT_NEAR(part.fields[0].integral, volume * (from + to) / 2, 32 * least);
            EXPECT_NEAR(part.fields[0].min.value, from, 4 * least);
            EXPECT_NEAR(part.fields[0].max.value, to, 4 * least);
            EXPECT_NEAR(part.fields[0].given.mean, (from + to) / 2, 4 * least);
            EXPECT_NEAR(part.fields[0].given.min.value, from, 4 * least);
            EXPECT_NEAR(part.fields[0].given.max.value, to, 4 * least);
        }
        for (std::size_t b = 0; b < 4; ++b) {
            const auto at = static_cast<double>(b);
            EXPECT_NEAR(whole.parts[s].fields[0].histogram[b], at >= from && at < to ? 4 : 0, 1e-9) << "bins of the whole";
        }
    }
    const std::vector<Region> none{Region("half:2,0,0,-1,0,0")};
    const LimitMeasure beside = measure_limit_in(mesh, none, {.scheme = {.kind = Scheme::Linear}, .sets = sets});
    EXPECT_EQ(beside.parts[3].cells, 0U) << "nothing of it lies in the region";
    EXPECT_EQ(beside.parts[3].volume, 0);
    const std::vector<CellSet> wrong{{"much", {99}}};
    test::expect_error(ErrorCode::InvalidInput, "much", [&] { (void)measure_limit(mesh, {.sets = wrong}); });
    const std::vector<Index> groups(mesh.cells.size(), 0);
    test::expect_error(ErrorCode::InvalidInput, "groups and sets",
                       [&] { (void)measure_limit(mesh, {.groups = groups, .sets = sets}); });
}

/// Half of a ball, by whole cells: by symmetry half of the volume and of each integral, whatever the cut does to the half
/// alone.
TEST(Measure, APartIsThatOfTheLimitOfTheWhole) {
    HexMesh ball = make_model("ball", 4);
    ball.attributes.clear();
    test::add_field(ball, "f", [](const Vec3& p) { return p.y * p.y; });
    std::vector<std::uint8_t> half(ball.cells.size(), 0);
    CellSet quarter{"quarter", {}};
    for (Index c = 0; c < ball.cells.size(); ++c) {
        Vec3 middle(0.0);
        for (const Index p : ball.cells[c]) middle += ball.points[p] / 8.0;
        half[c] = middle.x > 0 ? 1 : 0;
        if (middle.z > 0) quarter.cells.push_back(c);
    }
    const std::vector<CellSet> sets{quarter};
    const PartMeasure whole = measure_limit(ball, {.tolerance = 1e-4}).whole;
    const std::vector<Region> around{Region("box:-9,-9,-9,9,9,9")};
    for (const LimitMeasure& found : {measure_limit(ball, {.tolerance = 1e-4, .sets = sets, .cells = half}),
                                      measure_limit_in(ball, around, {.tolerance = 1e-4, .sets = sets, .cells = half})}) {
        const PartMeasure& part = found.whole;
        EXPECT_EQ(part.cells, static_cast<std::size_t>(std::ranges::count(half, 1)));
        EXPECT_NEAR(part.volume, whole.volume / 2, 4e-4 * whole.volume);  // the tolerance, of both
        EXPECT_NEAR(part.given_volume, whole.given_volume / 2, 4e-4 * whole.given_volume);
        EXPECT_NEAR(part.fields[0].mean, whole.fields[0].mean, 4e-4);
        EXPECT_NEAR(part.fields[0].max.value, whole.fields[0].max.value, 1e-3);
        EXPECT_GE(part.fields[0].max.place.x, -1e-9);
        ASSERT_EQ(found.parts.size(), 1U);
        EXPECT_NEAR(found.parts[0].volume, whole.volume / 4, 4e-4 * whole.volume) << "what the set has of the half";
        const Index cell = part.fields[0].max.cell;
        ASSERT_LT(cell, ball.cells.size());
        EXPECT_NE(half[cell], 0) << "cells have the numbers of the whole mesh";
    }
    const std::vector<std::uint8_t> few(3, 1);
    test::expect_error(ErrorCode::InvalidInput, "3 flags", [&] { (void)measure_limit(ball, {.cells = few}); });
}

TEST(Measure, IsTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = make_model("pawn", 12);
    const auto field = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return measure_limit(mesh, {.tolerance = 1e-3}).whole.fields[0];
    };
    EXPECT_EQ(field(1).integral, field(4).integral);
    EXPECT_EQ(field(1).histogram, field(4).histogram);
    EXPECT_EQ(field(1).max.value, field(4).max.value);
}

// What is added for cells that are not refined is within what is said, whatever the tolerance is and however the mesh bends.
TEST(Measure, WhatIsExpectedToFollowIsWithinTheError) {
    for (const auto& [model, resolution] : {std::pair{"ball", 5}, {"twist", 5}, {"pawn", 4}}) {
        const HexMesh mesh = make_model(model, resolution);
        const PartMeasure fine = measure_limit(refine(mesh, {.levels = 1}), {.tolerance = 1e-5}).whole;
        const double range = fine.fields[0].max.value - fine.fields[0].min.value;
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
            const PartMeasure found = measure_limit(mesh, {.tolerance = tolerance}).whole;
            EXPECT_LE(found.error, tolerance) << model;
            const double allowed = found.error + fine.error;
            EXPECT_LE(std::abs(found.volume / fine.volume - 1), allowed) << model << ' ' << tolerance;
            EXPECT_LE(std::abs(found.fields[0].mean - fine.fields[0].mean) / range, allowed) << model << ' ' << tolerance;
            EXPECT_NEAR(found.fields[0].max.value, fine.fields[0].max.value, 1e-4 * range) << model << ' ' << tolerance;
            EXPECT_NEAR(found.fields[0].min.value, fine.fields[0].min.value, 1e-4 * range) << model << ' ' << tolerance;
        }
    }
}

// Random values in a distorted box have extremes between nodes in cells that no control value points to.
TEST(Measure, NoPlaceIsBeyondTheExtremes) {
    HexMesh mesh = test::distorted_box(4, .15);
    std::mt19937 random(7);
    std::vector<double> values(mesh.points.size());
    for (double& value : values) value = static_cast<double>(random() % 1000) / 1000;
    mesh.attributes = {{"f", 1, values}};
    const FieldMeasure field = measure_limit(mesh).whole.fields[0];
    std::vector<LimitQuery> queries;
    for (Index cell = 0; cell < mesh.cells.size(); ++cell) {
        for (int n = 0; n < 216; ++n) queries.push_back({cell, Vec3(n % 6, n / 6 % 6, n / 36) / 5.0});
    }
    const auto found = evaluate_limit(mesh, queries).attributes[0].values;
    const auto [low, high] = std::ranges::minmax(found);
    EXPECT_GE(static_cast<double>(low), field.min.value - 1e-4);  // the search stops at 1e-4 of the range
    EXPECT_LE(static_cast<double>(high), field.max.value + 1e-4);
    EXPECT_LE(field.extreme_error, 1e-4 * (field.max.value - field.min.value));  // and it says so
}

// Many rough fields: each is followed into the octants of its own cells.
TEST(Measure, ExtremesOfManyFieldsAreKnownToTheTolerance) {
    HexMesh mesh = test::distorted_box(6, .15);
    std::mt19937 random(3);
    for (int f = 0; f < 12; ++f) {
        Attribute field{"f" + std::to_string(f), 1, std::vector<double>(mesh.points.size())};
        for (double& value : field.values) value = static_cast<double>(random() % 1000) / 1000;
        mesh.attributes.push_back(std::move(field));
    }
    const LimitMeasure many = measure_limit(mesh);
    HexMesh alone = mesh;
    alone.attributes = {mesh.attributes[5]};
    const FieldMeasure one = measure_limit(alone, {.tolerance = 1e-6}).whole.fields[0];
    for (const FieldMeasure& field : many.whole.fields) {
        EXPECT_LE(field.extreme_error, 1e-4 * (field.max.value - field.min.value)) << field.name;
    }
    EXPECT_NEAR(many.whole.fields[5].max.value, one.max.value, 1e-4);
    EXPECT_NEAR(many.whole.fields[5].min.value, one.min.value, 1e-4);
}

// A flag at some points overshoots alike around each of them: in thousands of cells, of which none is passed over.
TEST(Measure, ExtremesOfManyEqualPlacesAreKnownToTheTolerance) {
    const auto flags = [](Index count) {
        HexMesh mesh = test::make_box(5 * count, 5 * count, 5 * count);
        mesh.attributes = {{"flag", 1, std::vector<double>(mesh.points.size(), 0)}};
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            const auto is_middle = [&](double x) { return std::fmod(x, 5) == 2; };
            const Vec3& at = mesh.points[p];
            if (is_middle(at.x) && is_middle(at.y) && is_middle(at.z)) mesh.attributes[0].values[p] = 1;
        }
        return measure_limit(mesh).whole.fields[0];
    };
    const FieldMeasure one = flags(1), many = flags(6);
    const double range = one.max.value - one.min.value;
    EXPECT_LE(many.extreme_error, 1e-4 * range);
    EXPECT_NEAR(many.max.value, one.max.value, 1e-6 * range);
    EXPECT_NEAR(many.min.value, one.min.value, 1e-6 * range);
}

// One of many nearly equal places is the extreme: copies are told apart by less than the tolerance.
TEST(Measure, TheLargestOfManyNearlyEqualPlacesIsFound) {
    constexpr double kMore = 3e-4;
    HexMesh mesh = test::make_box(30, 30, 30);
    mesh.attributes = {{"flag", 1, std::vector<double>(mesh.points.size(), 0)}};
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& at = mesh.points[p];
        const auto is_middle = [&](double x) { return std::fmod(x, 5) == 2; };
        if (!is_middle(at.x) || !is_middle(at.y) || !is_middle(at.z)) continue;
        mesh.attributes[0].values[p] = at == Vec3(17, 12, 22) ? 1 + kMore : 1;
    }
    const FieldMeasure field = measure_limit(mesh).whole.fields[0];
    EXPECT_NEAR(field.max.value, 1 + kMore, 1e-6);
    EXPECT_LT(glm::length(field.max.place - Vec3(17, 12, 22)), 1e-2);
}

TEST(Measure, AConstantHasItsPlaceInACell) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.attributes = {{"f", 1, std::vector<double>(mesh.points.size(), 2.5)}};
    const FieldMeasure field = measure_limit(mesh, {.bins = 4}).whole.fields[0];
    EXPECT_EQ(field.min.value, 2.5);
    EXPECT_EQ(field.max.value, 2.5);
    EXPECT_LT(field.min.cell, mesh.cells.size());
    EXPECT_NEAR(field.histogram[0], 8, 1e-12);
    EXPECT_EQ(field.extreme_error, 0);
}

// More than are searched together; one of them a vector.
TEST(Measure, EachOfManyFieldsHasItsOwnExtremes) {
    HexMesh mesh = test::make_box(2, 1, 1);
    constexpr int kFields = 40, kVector = 20;
    for (int k = 0; k < kFields; ++k) {
        test::add_field(mesh, "f" + std::to_string(k), [&](const Vec3& p) { return (k + 1) * p.x - k * p.z; });
    }
    Attribute vector{"v", 3, {}};
    for (const Vec3& p : mesh.points) vector.values.insert(vector.values.end(), {p.x, 5 * p.y, 7 * p.z});
    mesh.attributes.insert(mesh.attributes.begin() + kVector, vector);
    const LimitMeasure found = measure_limit(mesh, {.bins = 2});
    ASSERT_EQ(found.whole.fields.size(), std::size_t{kFields + 3});
    for (std::size_t f = 0; f < found.whole.fields.size(); ++f) {
        const FieldMeasure& field = found.whole.fields[f];
        if (field.name.starts_with("v")) continue;
        const double k = std::stoi(field.name.substr(1));
        EXPECT_NEAR(field.max.value, 2 * (k + 1), 1e-4) << field.name;  // values of pieces are floats
        EXPECT_NEAR(field.min.value, -k, 1e-4) << field.name;
    }
    EXPECT_NEAR(found.whole.fields[kVector].max.value, 2, 1e-5);
    EXPECT_NEAR(found.whole.fields[kVector + 1].max.value, 5, 1e-5);
    EXPECT_NEAR(found.whole.fields[kVector + 2].max.value, 7, 1e-5);
}

// The volume is what is inside the hull, which is flat: whatever the cells inside are, and to whichever levels they are
// refined.
TEST(Measure, CellsOfDifferentLevelsHaveNoGapsBetweenThem) {
    HexMesh mesh = test::make_box(5, 5, 5);
    for (Vec3& p : mesh.points) {
        const Vec3 t = p / 5.0;
        const double inside = t.x * (1 - t.x) * t.y * (1 - t.y) * t.z * (1 - t.z);
        p += inside * Vec3(9 * std::sin(5 * t.y), -7 * t.x, 8 * std::cos(7 * t.x));
    }
    // A spike, around which alone cells are refined.
    test::add_field(mesh, "f", [](const Vec3& p) { return 1 / (0.05 + glm::dot(p - Vec3(1.5), p - Vec3(1.5))); });
    const LimitMeasure found = measure_limit(mesh, {.tolerance = 1e-6});
    EXPECT_GT(found.pieces, mesh.cells.size());
    EXPECT_NEAR(found.whole.volume, 125, 125e-12);
}

// The estimate holds, and so does what it promises; the finer run shows by how much.
TEST(Measure, ErrorsAreThoseThatAreSaid) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + p.z; });
    const PartMeasure coarse = measure_limit(mesh, {.tolerance = 1e-2}).whole,
                      fine = measure_limit(mesh, {.tolerance = 1e-6}).whole;
    const FieldMeasure &a = coarse.fields[0], &b = fine.fields[0];
    const double range = b.max.value - b.min.value;
    EXPECT_GT(coarse.error, 0);
    EXPECT_LE(fine.error, coarse.error);
    EXPECT_LE(std::abs(coarse.volume - fine.volume), (coarse.error + fine.error) * fine.volume);
    EXPECT_LE(std::abs(a.mean - b.mean), (coarse.error + fine.error) * range);
    EXPECT_LE(std::abs(a.min.value - b.min.value), a.extreme_error + b.extreme_error + 1e-6 * range);
    EXPECT_LE(std::abs(a.max.value - b.max.value), a.extreme_error + b.extreme_error + 1e-6 * range);
}

/// The volume, and the integral of the first field, over the triquadratic pieces between the vertices of a level: each control
/// cell's children of the level before are pieces. A sum of its own, by three Gauss points along each axis.
std::array<double, 2> integrals_of_level(const HexMesh& mesh, Scheme scheme, int level) {
    const HexMesh fine = on_limit(refine(mesh, {.scheme = {scheme}, .levels = level}), scheme);
    constexpr std::array<double, 3> kPlaces{0.11270166537925831, 0.5, 0.88729833462074169}, kWeights{5. / 18, 8. / 18, 5. / 18};
    const auto quadratic = [](double t) { return std::array{(2 * t - 1) * (t - 1), 4 * t * (1 - t), t * (2 * t - 1)}; };
    const auto slope = [](double t) { return std::array{4 * t - 3, 4 - 8 * t, 4 * t - 1}; };
    const auto corner = [](std::size_t u, std::size_t v, std::size_t w) { return 4 * w + (v == 0 ? u : 3 - u); };
    std::array<double, 2> sums{};
    for (std::size_t piece = 0; piece < fine.cells.size(); piece += 8) {
        std::array<Index, 27> nodes{};
        for (std::size_t n = 0; n < 27; ++n) {
            const std::array<std::size_t, 3> at{n % 3, n / 3 % 3, n / 9};
            const std::size_t u = at[0] / 2, v = at[1] / 2, w = at[2] / 2;
            nodes[n] = fine.cells[piece + corner(u, v, w)][corner(at[0] - u, at[1] - v, at[2] - w)];
        }
        for (std::size_t g = 0; g < 27; ++g) {
            const std::array<std::size_t, 3> at{g % 3, g / 3 % 3, g / 9};
            Mat3 jacobian(0.0);
            double value = 0, weight = 1;
            std::array<std::array<double, 3>, 3> f, df;
            for (std::size_t a = 0; a < 3; ++a) {
                f[a] = quadratic(kPlaces[at[a]]);
                df[a] = slope(kPlaces[at[a]]);
                weight *= kWeights[at[a]];
            }
            for (std::size_t n = 0; n < 27; ++n) {
                const std::size_t u = n % 3, v = n / 3 % 3, w = n / 9;
                const Vec3 p = fine.points[nodes[n]] - fine.points[nodes[0]];
                jacobian +=
                    Mat3(df[0][u] * f[1][v] * f[2][w] * p, f[0][u] * df[1][v] * f[2][w] * p, f[0][u] * f[1][v] * df[2][w] * p);
                value += f[0][u] * f[1][v] * f[2][w] * fine.attributes[0].values[nodes[n]];
            }
            sums[0] += weight * glm::determinant(jacobian);
            sums[1] += weight * glm::determinant(jacobian) * value;
        }
    }
    return sums;
}

/// A box without some of its cells, bent, with random values.
HexMesh random_castle(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    HexMesh mesh = seed % 4 == 3 ? test::make_nested_cubes(2) : test::make_box(3, 3, 2 + seed % 2);
    test::jitter(mesh, seed % 4 == 3 ? .06 : .2, seed);
    if (seed % 4 < 2) std::erase_if(mesh.cells, [&](const auto&) { return value(random) > .2; });
    mesh = without_unused_points(std::move(mesh));
    test::add_field(mesh, "f", [&](const Vec3& p) { return seed % 3 == 0 ? std::sin(3 * p.x) * p.y : value(random); });
    return mesh;
}

TEST(Measure, NoFigureIsFartherOffThanItsError) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const HexMesh mesh = random_castle(seed);
        const Scheme scheme = seed % 5 == 4 ? Scheme::CatmullClark : Scheme::Mcq;
        const auto coarse = integrals_of_level(mesh, scheme, 2), fine = integrals_of_level(mesh, scheme, 3);
        const auto& [low, high] = std::ranges::minmax(mesh.attributes[0].values);
        const PartMeasure found = measure_limit(mesh, {.scheme = {scheme}, .tolerance = seed % 2 == 0 ? 1e-2 : 1e-4}).whole;
        // Each level leaves a quarter of its change or less, a third with the logarithm of MCQ: that much is not known.
        const double volume_off = std::abs(fine[0] - coarse[0]) / 3, sum_off = std::abs(fine[1] - coarse[1]) / 3;
        EXPECT_NEAR(found.volume, fine[0], found.error * std::abs(found.volume) + volume_off) << seed;
        const double mean = fine[1] / fine[0], mean_off = (sum_off + std::abs(mean) * volume_off) / std::abs(fine[0]);
        EXPECT_NEAR(found.fields[0].mean, mean, found.error * (high - low) + mean_off) << seed;
    }
}

TEST(Measure, TheVolumeDoesNotDependOnTheFields) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        HexMesh mesh = random_castle(seed), bare = mesh;
        bare.attributes.clear();
        const double volume = measure_limit(bare).whole.volume;
        // Sums of nodes whose rows are longer may be rounded otherwise.
        EXPECT_NEAR(measure_limit(mesh).whole.volume, volume, 1e-13 * volume) << seed;
        test::add_field(mesh, "g", [](const Vec3& p) { return std::cos(9 * p.x * p.z); });
        EXPECT_NEAR(measure_limit(mesh).whole.volume, volume, 1e-13 * volume) << seed;
    }
}

// A smooth field of a fine mesh needs no more than one piece a cell, but for a few.
TEST(Measure, RefinesWhereTheEstimateAsksForIt) {
    const HexMesh mesh = make_model("twist", 24);
    const std::size_t cells = mesh.cells.size();
    EXPECT_LT(measure_limit(mesh).pieces, 2 * cells);
    EXPECT_GT(measure_limit(mesh, {.tolerance = 1e-7}).pieces, 2 * cells);
}

TEST(Measure, ASmallRangeFarFromZeroKeepsItsDigits) {
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "pressure", [](const Vec3& p) { return 101325 + 0.01 * p.x; });
    const FieldMeasure field = measure_limit(mesh).whole.fields[0];
    constexpr double kRange = 0.04;
    EXPECT_NEAR(field.min.value, 101325, 1e-6 * kRange);
    EXPECT_NEAR(field.max.value, 101325 + kRange, 1e-6 * kRange);
    EXPECT_NEAR(field.mean, 101325 + kRange / 2, 1e-6 * kRange);
}

TEST(Measure, RefusesOptionsOutOfRange) {
    const HexMesh mesh = test::make_box(1, 1, 1);
    test::expect_error(ErrorCode::InvalidInput, "tolerance", [&] { (void)measure_limit(mesh, {.tolerance = 0}); });
    test::expect_error(ErrorCode::InvalidInput, "bins", [&] { (void)measure_limit(mesh, {.bins = 0}); });
    const std::vector<Index> groups(2);
    test::expect_error(ErrorCode::InvalidInput, "groups", [&] { (void)measure_limit(mesh, {.groups = groups}); });
}

}  // namespace measure_test
}  // namespace subvol
