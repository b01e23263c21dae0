// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "subvol/approximate.h"
#include "subvol/approximator.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/probe.h"

namespace subvol {
namespace approximate_test {

using test::error_of;
using test::make_box;
using testing::HasSubstr;

/// A mesh with values from a die at its points: a field that no polynomial is.
HexMesh with_noise(HexMesh mesh, unsigned seed) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    mesh.attributes = {{.name = "T", .channels = 1, .values = {}}};
    for (std::size_t p = 0; p < mesh.points.size(); ++p) mesh.attributes[0].values.push_back(value(dice));
    return mesh;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return a.size() == b.size() ? most : INFINITY;
}

// Trilinear in the cell that a point is in, by hand; outside the value at the nearest place of a box.
TEST(Approximate, MapsTheValuesOfCellsToPoints) {
    HexMesh data = make_box(2, 1, 1);
    const auto linear = [](const Vec3& x) { return 1 + 2 * x.x - 3 * x.y + 0.5 * x.z; };
    Attribute corner{.name = "corner", .channels = 1, .values = {}}, both{.name = "both", .channels = 2, .values = {}};
    for (const Vec3& x : data.points) {
        corner.values.push_back(x == Vec3(2, 1, 1) ? 8 : 0);
        both.values.insert(both.values.end(), {linear(x), -linear(x)});
    }
    data.attributes = {corner, both};
    HexMesh onto = make_box(1, 1, 1);
    onto.points = {{0.3, 0.2, 0.9}, {1.5, 0.5, 0.5}, {2, 1, 1},      {1, 0.25, 0.5},
                   {-1, 0.5, 0.5},  {3, 2, 3},       {1, 1.25, 0.5}, {1.75, 0.5, -0.1}};
    onto.attributes = {{.name = "old", .channels = 1, .values = std::vector<double>(8)}};
    const MappedFields mapped = map_fields(onto, data);
    ASSERT_EQ(mapped.mesh.attributes.size(), 2U);
    const std::vector<double> corners{0, 8 * .5 * .5 * .5, 8, 0, 0, 8, 0, 0};
    for (std::size_t p = 0; p < onto.points.size(); ++p) {
        const Vec3 nearest = glm::clamp(onto.points[p], Vec3(0.0), Vec3(2, 1, 1));
        EXPECT_NEAR(mapped.mesh.attributes[0].values[p], corners[p], 1e-9) << p;
        EXPECT_NEAR(mapped.mesh.attributes[1].values[2 * p], linear(nearest), 1e-9) << p;
        EXPECT_NEAR(mapped.mesh.attributes[1].values[2 * p + 1], -linear(nearest), 1e-9) << p;
    }
    EXPECT_EQ(mapped.report.outside, 4U);
    // A label is that of the cell, never a mean of labels: outside, that of the nearest one.
    HexMesh labelled = make_box(2, 1, 1);
    labelled.attributes = {{.name = "material",
                            .channels = 1,
                            .values = std::vector<double>(labelled.points.size(), 5.5),
                            .cells = {3, 8},
                            .constant = true}};
    HexMesh places = onto;
    places.points = {{0.9, 0.5, 0.5}, {1.1, 0.5, 0.5}, {0.2, 0.2, 0.2}, {1.8, 0.3, 0.3},
                     {0.9, 0.5, -1},  {1.2, 1.5, 0.5}, {-1, 0, 0},      {3, 1, 1}};
    EXPECT_EQ(map_fields(places, labelled).mesh.attributes[0].values, (std::vector<double>{3, 8, 3, 8, 3, 8, 3, 8}));
    EXPECT_NEAR(mapped.report.farthest_world, std::sqrt(1 + 1 + 4), 1e-12);
    EXPECT_EQ(mapped.report.farthest_at, Vec3(3, 2, 3));
    EXPECT_THAT(error_of([&] { (void)map_fields(onto, HexMesh{}); }), HasSubstr("no cells"));
    for (Vec3& x : onto.points) x += Vec3(9);
    EXPECT_THAT(error_of([&] { (void)map_fields(onto, data); }), HasSubstr("no point of the mesh lies in the data"));
    data.attributes.clear();
    EXPECT_THAT(error_of([&] { (void)map_fields(onto, data); }), HasSubstr("no field"));
}

TEST(Approximate, FindsALimitAgain) {
    for (const HexMesh& bare : {make_model("twist", 4), make_model("ball", 2), test::irregular()}) {
        const HexMesh control = with_noise(bare, 3);
        const HexMesh fine = refine(control, {.levels = 2});
        const Approximation made = approximate(control, fine);
        EXPECT_EQ(made.report.samples, fine.points.size());
        EXPECT_LT(difference(made.mesh.attributes[0].values, control.attributes[0].values), 1e-10);
        // Samples are found to a millionth of the diagonal, and the rest of the way goes along derivatives, which are known to
        // 1e-3 at irregular edges.
        EXPECT_LT(made.report.fields[0].max, 1e-9);
    }
}

// In these meshes many cells have neighbourhoods that are alike, and share tables; others have not.
TEST(Approximate, FindsALimitAgainWhereCellsShareTables) {
    const auto find_again = [](const HexMesh& bare, int levels) {
        const HexMesh control = with_noise(bare, 3);
        const Approximation made = approximate(control, refine(control, {.levels = levels}));
        EXPECT_LT(difference(made.mesh.attributes[0].values, control.attributes[0].values), 1e-10);
    };
    find_again(make_model("twist", 12), 1);  // samples at a part of the points of level 2
    find_again(make_model("ball", 4), 2);
    const HexMesh control = with_noise(make_model("ball", 4), 4);
    const HexMesh fine =
        on_limit(refine(control, {.scheme = {.kind = Scheme::CatmullClark}, .levels = 2}), Scheme::CatmullClark);
    const Approximation made = approximate(control, fine, {.scheme = {.kind = Scheme::CatmullClark}, .iterations = 400});
    EXPECT_LT(difference(made.mesh.attributes[0].values, control.attributes[0].values), 1e-8);
}

TEST(Approximate, FindsALimitOfASchemeThatDoesNotInterpolate) {
    const HexMesh control = with_noise(make_model("ball", 2), 4);
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        const HexMesh fine = on_limit(refine(control, {.scheme = {.kind = scheme}, .levels = 2}), scheme);
        const Approximation made = approximate(control, fine, {.scheme = {.kind = scheme}});
        EXPECT_LT(difference(made.mesh.attributes[0].values, control.attributes[0].values), 1e-8) << name_of(scheme);
    }
}

/// Random places in a box, as samples of a function.
template <class Function>
HexMesh random_samples(std::size_t count, const Box& box, unsigned seed, const Function& function) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> part(0, 1);
    HexMesh samples;
    samples.attributes = {{.name = "f", .channels = 1, .values = {}}};
    for (std::size_t k = 0; k < count; ++k) {
        const double x = part(dice), y = part(dice), z = part(dice);
        samples.points.push_back(glm::mix(box.lower, box.upper, Vec3(x, y, z)));
        samples.attributes[0].values.push_back(function(samples.points.back()));
    }
    return samples;
}

TEST(Approximate, ScalesWithItsSamples) {
    // Squares of the large values, and of the small ones, are no doubles.
    const HexMesh control = with_noise(test::irregular(), 6);
    HexMesh samples = random_samples(300, bounds(control), 5, [](const Vec3& x) { return std::sin(3 * x.x) + x.y; });
    const Approximation usual = approximate(control, samples);
    for (const int exponent : {900, -900}) {
        HexMesh scaled = samples;
        for (double& value : scaled.attributes[0].values) value = std::ldexp(value, exponent);
        const Approximation made = approximate(control, scaled);
        for (std::size_t p = 0; p < control.points.size(); ++p) {
            const double value = std::ldexp(made.mesh.attributes[0].values[p], -exponent);
            EXPECT_NEAR(value, usual.mesh.attributes[0].values[p], 1e-9) << exponent;
        }
        EXPECT_EQ(made.report.iterations, usual.report.iterations);
        EXPECT_NEAR(std::ldexp(made.report.fields[0].rms, -exponent), usual.report.fields[0].rms, 1e-9);
    }
}

/// Random places in the limit, with values that no limit has, and the matrix of the limit there by unit fields.
struct Scattered {
    HexMesh samples;
    Eigen::MatrixXd matrix;
    Eigen::VectorXd values;
};

Scattered scattered(const HexMesh& mesh, std::size_t count, unsigned seed) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> part(0.02, 0.98);
    std::vector<LimitQuery> queries;
    for (std::size_t k = 0; k < count; ++k) {
        queries.push_back({static_cast<Index>(k % mesh.cells.size()), {part(dice), part(dice), part(dice)}});
    }
    HexMesh units = mesh;
    const std::size_t n = mesh.points.size();
    units.attributes = {{.name = "units", .channels = static_cast<int>(n), .values = std::vector<double>(n * n, 0)}};
    for (std::size_t p = 0; p < n; ++p) units.attributes[0].values[p * n + p] = 1;
    const LimitSamples limit = evaluate_limit(units, queries);
    Scattered made;
    made.samples.points = limit.positions;
    made.samples.attributes = {{.name = "v", .channels = 1, .values = {}}};
    made.matrix.resize(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(n));
    made.values.resize(static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3& x = limit.positions[k];
        const double value = std::sin(3 * x.x) + x.y * x.z + 0.1 * (part(dice) - 0.5);
        made.samples.attributes[0].values.push_back(value);
        made.values(static_cast<Eigen::Index>(k)) = value;
        for (std::size_t p = 0; p < n; ++p) {
            made.matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) = limit.attributes[0].values[k * n + p];
        }
    }
    return made;
}

TEST(Approximate, IsAsGoodAsDenseLeastSquares) {
    for (const HexMesh& bare : {make_model("twist", 3), make_model("ball", 2)}) {
        const Scattered data = scattered(bare, 40 * bare.cells.size(), 5);
        const Eigen::VectorXd best = data.matrix.householderQr().solve(data.values);
        const double least = (data.matrix * best - data.values).norm();
        const Approximation made = approximate(bare, data.samples, {.levels = 3});
        const auto& found = made.mesh.attributes[0].values;
        const Eigen::Map<const Eigen::VectorXd> x(found.data(), static_cast<Eigen::Index>(found.size()));
        EXPECT_LT((data.matrix * x - data.values).norm(), 1.01 * least);
        const double rms = least / std::sqrt(static_cast<double>(data.samples.points.size()));
        EXPECT_NEAR(made.report.fields[0].rms, rms, 0.02 * rms);
    }
}

/// How far values of the limit are from a field of the samples, root mean square.
double rms(const LimitSamples& limit, const HexMesh& samples) {
    double sum = 0;
    for (std::size_t k = 0; k < samples.points.size(); ++k) {
        sum += std::pow(limit.attributes[0].values[k] - samples.attributes[0].values[k], 2);
    }
    return std::sqrt(sum / static_cast<double>(samples.points.size()));
}

TEST(Approximate, TheLimitIsAsFarFromTheSamplesAsIsSaid) {
    for (const HexMesh& bare : {make_model("twist", 11), make_model("ball", 4)}) {
        std::mt19937 dice(9);
        std::uniform_real_distribution<double> part(0, 1);
        for (const std::size_t per_cell : {1U, 12U}) {  // one in an octant that is the same in all cells, or many everywhere
            const double most = per_cell == 1 ? 0.4 : 1;
            std::vector<LimitQuery> places;
            for (std::size_t k = 0; k < per_cell * bare.cells.size(); ++k) {
                places.push_back({static_cast<Index>(k / per_cell), most * Vec3(part(dice), part(dice), part(dice))});
            }
            HexMesh samples;
            samples.points = evaluate_limit(bare, places).positions;
            samples.attributes = {{.name = "T", .channels = 1, .values = {}}};
            for (const Vec3& x : samples.points) {
                samples.attributes[0].values.push_back(std::sin(9 * x.x) * x.y + 0.3 * part(dice));
            }
            for (const int levels : {1, 2, 3}) {
                const Approximation made = approximate(bare, samples, {.levels = levels, .smoothing = 0.01});
                const double found = rms(evaluate_limit(made.mesh, places), samples);
                // Between points of the level the limit is interpolated, which is of second order here.
                EXPECT_NEAR(made.report.fields[0].rms, found, 0.15 * found * std::pow(0.25, levels - 1));
            }
        }
    }
}

TEST(Approximate, WhatNoSampleSeesContinuesWhatIsAroundIt) {
    HexMesh box = make_box(6, 3, 3);
    HexMesh samples = refine(with_noise(box, 1), {.levels = 2});
    for (double& value : samples.attributes[0].values) value = 7;
    HexMesh part;
    part.attributes = {{.name = "T", .channels = 1, .values = {}}};
    for (std::size_t p = 0; p < samples.points.size(); ++p) {
        if (samples.points[p].x > 2) continue;
        part.points.push_back(samples.points[p]);
        part.attributes[0].values.push_back(7);
    }
    const Approximation made = approximate(box, part);
    EXPECT_GT(made.report.unseen, 0U);
    for (const double value : made.mesh.attributes[0].values) EXPECT_NEAR(value, 7, 1e-6);
}

TEST(Approximate, ValuesThatSamplesHardlyDecideFollowTheirNeighbors) {
    const HexMesh box = make_box(4, 4, 4);
    const Scattered data = scattered(box, 4000, 11);
    HexMesh part;  // down to a thin layer of a cell that is sampled
    part.attributes = {{.name = "v", .channels = 1, .values = {}}};
    for (std::size_t p = 0; p < data.samples.points.size(); ++p) {
        if (data.samples.points[p].x > 2.05) continue;
        part.points.push_back(data.samples.points[p]);
        part.attributes[0].values.push_back(data.samples.attributes[0].values[p]);
    }
    const Approximation made = approximate(box, part);
    const auto [least, most] = std::ranges::minmax(part.attributes[0].values);
    const auto [low, high] = std::ranges::minmax(made.mesh.attributes[0].values);
    EXPECT_GT(low, least - 0.3 * (most - least));
    EXPECT_LT(high, most + 0.3 * (most - least));
}

TEST(Approximate, LinearFunctionsAreMetEverywhereByWhateverSamples) {
    const auto linear = [](const Vec3& x) { return 3 + 2 * x.x - x.y + 0.5 * x.z; };
    for (const HexMesh& mesh : {make_box(7, 3, 3), make_model("ball", 3), test::irregular()}) {
        const Box all = bounds(mesh);
        Box corner = all;
        corner.upper = glm::mix(all.lower, all.upper, 0.6);
        for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Linear}) {
            const HexMesh samples = random_samples(200, corner, 3, linear);
            const Approximation made = approximate(mesh, samples, {.scheme = {.kind = scheme}, .reach = 0});
            EXPECT_GT(made.report.undecided, 0U);
            for (std::size_t p = 0; p < mesh.points.size(); ++p) {
                // Rounding of sums over 200 samples, continued over a few cells
                EXPECT_NEAR(made.mesh.attributes[0].values[p], linear(mesh.points[p]), 1e-8) << name_of(scheme);
            }
            EXPECT_LT(made.report.fields[0].max, 1e-8);
        }
    }
}

TEST(Approximate, AFinerControlMeshNeverFitsWorse) {
    const auto wave = [](const Vec3& x) { return std::sin(3 * x.x) * std::cos(2 * x.y) + x.z * x.z * std::sin(2 * x.x); };
    double max_before = INFINITY, unseen_before = INFINITY, rms_before = INFINITY;
    for (const Index cells : {4U, 8U, 12U}) {  // 300, 37 and 11 samples a cell
        HexMesh box = make_box(cells, cells, cells);
        for (Vec3& x : box.points) x /= cells;
        const HexMesh samples = random_samples(19000, bounds(box), 7, wave);
        const Approximation made = approximate(box, samples);
        const HexMesh unseen = random_samples(4000, bounds(box), 8, wave);
        std::vector<LimitQuery> places;
        for (const Vec3& x : unseen.points) {
            const Vec3 at = x * double(cells), cell = glm::min(glm::floor(at), double(cells - 1));
            places.push_back({static_cast<Index>(cell.x + cells * (cell.y + cells * cell.z)), at - cell});
        }
        const LimitSamples found = evaluate_limit(made.mesh, places);
        double most = 0;
        for (std::size_t k = 0; k < places.size(); ++k)
            most = std::max(most, std::abs(found.attributes[0].values[k] - unseen.attributes[0].values[k]));
        EXPECT_LT(made.report.fields[0].max, max_before);
        EXPECT_LT(most, unseen_before);
        // At least of second order, and between 4³ and 8³ of third
        EXPECT_LT(made.report.fields[0].rms, rms_before * (cells == 8 ? 0.125 : 0.44));
        max_before = made.report.fields[0].max;
        unseen_before = most;
        rms_before = made.report.fields[0].rms;
    }
}

/// Trilinear values of a mesh at the points of its linear refinement.
HexMesh halved(const HexMesh& mesh, int levels) {
    return refine(mesh, {.scheme = {.kind = Scheme::Linear}, .levels = levels});
}

TEST(Approximate, CoarseDataIsSampledBetweenItsPoints) {
    const HexMesh coarse = with_noise(test::irregular(), 5);
    for (const int levels : {0, 1, 2}) {  // also onto the mesh itself
        const HexMesh fine = halved(coarse, levels);
        const Approximation made = approximate(fine, coarse, {.scheme = {.kind = Scheme::Linear}});
        // What is trilinear in a coarse cell is so in the fine cells, whose values are means of the coarse ones.
        EXPECT_LT(difference(made.mesh.attributes[0].values, fine.attributes[0].values), 1e-7) << levels;
        EXPECT_LT(made.report.fields[0].max_between, 1e-6);
        EXPECT_EQ(made.report.undecided, 0U);
        EXPECT_TRUE(made.report.continuous);
    }
}

// Data that is coarser along x and finer along y and z than the control mesh, with errors that no field of this mesh has:
// values half way along x are not decided by its points.
TEST(Approximate, ValuesBetweenTheDataDoNotRing) {
    HexMesh data = with_noise(make_box(6, 20, 20), 9), onto = make_box(12, 8, 8);
    for (Vec3& x : data.points) x = {x.x / 6, x.y / 20, x.z / 20};
    for (Vec3& x : onto.points) x = {x.x / 12, x.y / 8, x.z / 8};
    for (const bool with_cells : {true, false}) {
        HexMesh samples = data;
        if (!with_cells) samples.cells.clear();
        const Approximation made = approximate(onto, samples, {.scheme = {.kind = Scheme::Linear}});
        const auto [low, high] = std::ranges::minmax(made.mesh.attributes[0].values);
        EXPECT_GT(low, -1.3);  // the data's values are in [-1, 1]
        EXPECT_LT(high, 1.3);
        EXPECT_GE(made.report.fields[0].beyond, std::max(high - 1, -1 - low));
        EXPECT_EQ(made.report.continuous, with_cells);
    }
}

TEST(Approximate, ClampKeepsControlValuesInTheRangeOfTheSamples) {
    const HexMesh box = make_box(5, 5, 5);
    const HexMesh samples = random_samples(3000, bounds(box), 4, [](const Vec3& x) { return x.x + x.y > 5 ? 1.0 : 0.0; });
    const Approximation free = approximate(box, samples), kept = approximate(box, samples, {.clamp = true});
    EXPECT_LT(std::ranges::min(free.mesh.attributes[0].values), -0.01);
    EXPECT_GE(std::ranges::min(kept.mesh.attributes[0].values), 0);
    EXPECT_LE(std::ranges::max(kept.mesh.attributes[0].values), 1);
    EXPECT_GT(kept.report.fields[0].rms, free.report.fields[0].rms);  // the error that is said is that of the clamped field
}

TEST(Approximate, WhereNoSampleIsBelowZeroNoControlValueIs) {
    const HexMesh box = make_box(5, 5, 5);
    const auto step = [](double low) { return [low](const Vec3& x) { return x.x + x.y > 5 ? 1.0 : low; }; };
    const HexMesh fog = random_samples(3000, bounds(box), 4, step(0)), signs = random_samples(3000, bounds(box), 4, step(-1));
    const Approximation free = approximate(box, fog), kept = approximate(box, fog, {.keep_sign = true});
    EXPECT_LT(std::ranges::min(free.mesh.attributes[0].values), -0.01);
    EXPECT_EQ(std::ranges::min(kept.mesh.attributes[0].values), 0);
    for (std::size_t p = 0; p < box.points.size(); ++p)
        EXPECT_EQ(kept.mesh.attributes[0].values[p], std::max(0.0, free.mesh.attributes[0].values[p]));
    EXPECT_EQ(approximate(box, signs, {.keep_sign = true}).mesh.attributes[0].values,
              approximate(box, signs).mesh.attributes[0].values);
}

TEST(Approximate, ABoxForDataThatHasNoMesh) {
    const HexMesh mesh = mesh_of_box({{-1, 0, 2}, {3, 1, 4.1}}, 8);
    EXPECT_EQ(mesh.cells.size(), 8u * 2 * 4);  // of sides of .5, .5 and .525
    EXPECT_EQ(bounds(mesh).lower, Vec3(-1, 0, 2));
    EXPECT_EQ(bounds(mesh).upper, Vec3(3, 1, 4.1));
    EXPECT_NEAR(measure_cells(mesh).volume, 4 * 2.1, 1e-12);
    EXPECT_NEAR(measure_cells(refine(mesh)).volume, 4 * 2.1, 1e-12);  // with its edges sharp
    EXPECT_EQ(mesh_of_box({Vec3(0.0), {1, 1e-6, 1}}, 2).cells.size(), 4u);
    for (const int cells : {0, 1001}) EXPECT_THROW((void)mesh_of_box({Vec3(0.0), Vec3(1.0)}, cells), Error);
    EXPECT_THROW((void)mesh_of_box({Vec3(0.0), Vec3(1, 0, 1)}, 2), Error);
    EXPECT_THROW((void)mesh_of_box({}, 2), Error);
}

// The error and the range that are said, against an evaluation of the limit at other places; a larger version of this is
// bench/fit_errors.py.
TEST(Approximate, NoErrorIsLargerThanIsSaid) {
    std::mt19937 dice(12);
    std::uniform_real_distribution<double> part(0, 1);
    for (unsigned seed = 0; seed < 12; ++seed) {
        const HexMesh mesh =
            std::array{make_box(4, 3, 5), make_model("ball", 2), make_model("twist", 3), test::irregular()}[seed % 4];
        const double noise = seed % 3 == 0 ? 0.2 : 0;
        const auto wave = [&](const Vec3& x) { return std::sin(2 * x.x + seed) * std::cos(x.y - x.z) + noise * part(dice); };
        Box box = bounds(mesh);
        if (seed % 5 == 1) box.upper.x = box.center().x;  // from one side alone
        const HexMesh samples = random_samples(seed % 2 == 0 ? 150 : 4000, box, seed, wave);
        const Approximation made = approximate(mesh, samples);
        const FieldError& said = made.report.fields[0];
        const ProbeResult found = LimitProbe(made.mesh, {.reach_world = 0.01 * bounds(mesh).diagonal()}).at(samples.points);
        double most = 0, squares = 0, count = 0;
        for (std::size_t k = 0; k < samples.points.size(); ++k) {
            if (!found.inside(k)) continue;
            const double off = std::abs(found.fields[0].values[k] - samples.attributes[0].values[k]);
            most = std::max(most, off);
            squares += off * off;
            count += 1;
        }
        EXPECT_EQ(made.report.samples, static_cast<std::size_t>(count));
        EXPECT_LT(most, 1.01 * said.max + 1e-12) << seed;
        EXPECT_NEAR(said.rms, std::sqrt(squares / count), 0.15 * said.rms) << seed;  // the matrix interpolates, as above
        const auto [low, high] = std::ranges::minmax(samples.attributes[0].values);
        std::vector<LimitQuery> places;
        for (Index k = 0; k < 5000; ++k)
            places.push_back({k % static_cast<Index>(mesh.cells.size()), {part(dice), part(dice), part(dice)}});
        const LimitSamples limit = evaluate_limit(made.mesh, places);
        const auto [least, greatest] = std::ranges::minmax(limit.attributes[0].values);
        EXPECT_LT(std::max(low - least, greatest - high), 1.02 * said.beyond + 1e-3 * said.range) << seed;
    }
}

TEST(Approximate, RefinesUntilTheSamplesAreMet) {
    const HexMesh coarse = make_model("twist", 2);
    HexMesh samples = refine(coarse, {.levels = 3});
    samples.attributes = {{.name = "wave", .channels = 1, .values = {}}};
    for (const Vec3& x : samples.points) samples.attributes[0].values.push_back(std::sin(4 * x.x) * std::cos(3 * x.z));
    const Approximation once = approximate(coarse, samples);
    const Approximation more = approximate(coarse, samples, {.refine = 2, .tolerance = 0.01});
    EXPECT_EQ(once.report.refined, 0);
    EXPECT_GT(more.report.refined, 0);
    EXPECT_GT(more.mesh.cells.size(), coarse.cells.size());
    EXPECT_LT(more.report.fields[0].rms, 0.3 * once.report.fields[0].rms);
}

/// A function of the world at the points of a fine mesh.
template <class Function>
HexMesh sampled(const HexMesh& mesh, int levels, const Function& function) {
    HexMesh samples = refine(mesh, {.levels = levels});
    samples.attributes = {{.name = "f", .channels = 1, .values = {}}};
    for (const Vec3& x : samples.points) samples.attributes[0].values.push_back(function(x));
    return samples;
}

TEST(Approximate, SplitsSheetsAcrossAFrontAlone) {
    const HexMesh box = make_box(6, 5, 4);
    const HexMesh samples = sampled(box, 2, [](const Vec3& x) { return std::tanh(4 * (x.x - 3)); });
    const Approximation made = approximate(box, samples, {.refine = 2, .tolerance = 0.03});
    EXPECT_LE(made.report.fields[0].max, 0.03 * made.report.fields[0].range);
    EXPECT_EQ(made.mesh.cells.size() % 20, 0U);  // 5 × 4 columns of cells as before, with more cells in each
    EXPECT_GT(made.mesh.cells.size(), box.cells.size());
    EXPECT_LT(made.mesh.cells.size(), 4 * box.cells.size());
    std::vector<double> sizes;  // along x, of the cells of a column: they change step by step
    for (const auto& cell : made.mesh.cells) {
        const Vec3 lower = made.mesh.points[cell[0]];
        if (lower.y < 0.5 && lower.z < 0.5) sizes.push_back(made.mesh.points[cell[1]].x - lower.x);
    }
    for (std::size_t k = 1; k < sizes.size(); ++k) {
        EXPECT_LT(sizes[k] / sizes[k - 1], 1.8);
        EXPECT_GT(sizes[k] / sizes[k - 1], 1 / 1.8);
    }
    const Box before = bounds(box), after = bounds(made.mesh);
    EXPECT_NEAR(glm::distance(before.lower, after.lower) + glm::distance(before.upper, after.upper), 0, 1e-12);
}

TEST(Approximate, KeepsTheShapeWhereItRefines) {
    HexMesh arc = make_box(6, 3, 3);
    for (Vec3& x : arc.points) x = {(7 - x.y) * std::cos(x.x / 4), (7 - x.y) * std::sin(x.x / 4), x.z};
    const HexMesh samples = sampled(arc, 2, [](const Vec3& x) { return std::tanh(6 * (std::atan2(x.y, x.x) - 0.7)); });
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const SchemeOptions with{.kind = scheme};
        const auto limit = [&](const HexMesh& mesh) { return on_limit(refine(mesh, {.scheme = with, .levels = 3}), scheme); };
        const Approximation made = approximate(arc, samples, {.scheme = with, .reach = 0.1, .refine = 1, .tolerance = 0.02});
        EXPECT_GT(made.mesh.cells.size(), arc.cells.size());
        EXPECT_LT(made.mesh.cells.size(), 2 * arc.cells.size());
        const HexMesh before = limit(arc), after = limit(made.mesh);
        const double volume = test::volume_of(before);
        EXPECT_NEAR(test::volume_of(after), volume, 2e-3 * volume) << name_of(scheme);
        const Box a = bounds(before), b = bounds(after);
        EXPECT_LT(glm::distance(a.lower, b.lower) + glm::distance(a.upper, b.upper), 0.01 * a.diagonal()) << name_of(scheme);
    }
}

TEST(Approximate, SharpFacesAndCreasesFollowTheSplits) {
    HexMesh box = make_box(6, 3, 3);
    const Topology topology = build_topology(box);
    for (Index f = 0; f < topology.faces.size(); ++f) {
        const auto& face = topology.faces[f];
        if (std::ranges::all_of(face, [&](Index p) { return box.points[p].x == 2; })) box.sharp_faces.push_back(face);
    }
    for (Index e = 0; e < topology.edges.size(); ++e) {
        const auto& [a, b] = topology.edges[e];
        if (topology.edge_on_boundary[e] != 0 && box.points[a].z == 3 && box.points[b].z == 3 && box.points[a].y == 1 &&
            box.points[b].y == 1) {
            box.creases.push_back({a, b});
        }
    }
    ASSERT_EQ(box.sharp_faces.size(), 9U);
    ASSERT_EQ(box.creases.size(), 6U);
    const HexMesh samples = sampled(box, 2, [](const Vec3& x) { return std::tanh(6 * (x.x - 3) + 6 * (x.y - 1.5)); });
    const Approximation made = approximate(box, samples, {.refine = 1, .tolerance = 0.01});
    // Each layer of cells between two values of x, y and z; a crease goes along x, the sharp faces along y and z.
    const auto layers = [&](int axis) {
        std::size_t count = 0;
        for (const auto& [a, b] : build_topology(made.mesh).edges) {
            const Vec3 &p = made.mesh.points[a], &q = made.mesh.points[b];
            const int other = (axis + 1) % 3, third = (axis + 2) % 3;
            count += p[other] == 0 && q[other] == 0 && p[third] == 0 && q[third] == 0;
        }
        return count;
    };
    EXPECT_GT(layers(0), 6U);
    EXPECT_GT(layers(1), 3U);
    EXPECT_EQ(made.mesh.cells.size(), layers(0) * layers(1) * layers(2));
    EXPECT_EQ(made.mesh.creases.size(), layers(0));
    EXPECT_EQ(made.mesh.sharp_faces.size(), layers(1) * layers(2));
}

TEST(Approximate, SmoothingMakesNeighborsAlike) {
    const HexMesh box = make_box(4, 4, 4);
    const Scattered data = scattered(box, 2000, 8);
    const auto roughness = [&](double smoothing) {
        const Approximation made = approximate(box, data.samples, {.smoothing = smoothing});
        const auto [low, high] = std::ranges::minmax(made.mesh.attributes[0].values);
        return high - low;
    };
    EXPECT_LT(roughness(10), 0.5 * roughness(0));
}

TEST(Approximate, TakesFieldsOfSeveralComponentsAndSamplesNearby) {
    const HexMesh box = make_box(3, 3, 3);
    HexMesh samples = refine(box, {.levels = 1});
    samples.attributes = {{.name = "x", .channels = 3, .values = {}}};
    for (const Vec3& x : samples.points)
        samples.attributes[0].values.insert(samples.attributes[0].values.end(), {x.x, x.y, x.z});
    samples.points[0] -= Vec3(0.001);
    samples.points.back() += Vec3(100.0);
    const Approximation made = approximate(box, samples);
    EXPECT_EQ(made.report.snapped, 1U);
    EXPECT_EQ(made.report.outside, 1U);
    for (std::size_t p = 0; p < box.points.size(); ++p) {
        for (int a = 0; a < 3; ++a) {
            EXPECT_NEAR(made.mesh.attributes[0].values[3 * p + static_cast<std::size_t>(a)], box.points[p][a], 2e-3);
        }
    }
}

TEST(Approximate, AnyNumberOfThreads) {
    const HexMesh control = with_noise(make_model("ball", 2), 6);
    const Scattered data = scattered(control, 800, 2);
    const auto fitted = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Approximation made = approximate(control, data.samples, {.refine = 1, .tolerance = 0.2});
        std::vector<double> all = made.mesh.attributes[0].values;
        for (const Vec3& x : made.mesh.points) all.insert(all.end(), {x.x, x.y, x.z});
        return all;
    };
    EXPECT_EQ(fitted(1), fitted(4));
    const HexMesh many = make_model("twist", 8);  // with cells that share tables
    const Scattered of_many = scattered(make_model("twist", 2), 900, 3);
    const auto fitted_many = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return approximate(many, of_many.samples).mesh.attributes[0].values;
    };
    EXPECT_EQ(fitted_many(1), fitted_many(4));
}

/// Steps of a wave at the same points, as samples.
std::vector<HexMesh> steps_of(const HexMesh& mesh, int count) {
    std::vector<HexMesh> steps(static_cast<std::size_t>(count), refine(mesh, {.levels = 2}));
    for (int k = 0; k < count; ++k) {
        HexMesh& step = steps[static_cast<std::size_t>(k)];
        step.attributes = {{.name = "wave", .channels = 1, .values = {}}};
        for (const Vec3& x : step.points) step.attributes[0].values.push_back(std::sin(5 * x.x + k) * std::cos(3 * x.z - k));
    }
    return steps;
}

TEST(Approximator, GivesTheBitsOfEachStepAloneAndFindsPlacesOnce) {
    const HexMesh control = make_model("ball", 2);
    const std::vector<HexMesh> steps = steps_of(control, 3);
    Approximator approximator(control);
    for (const std::size_t k : {2U, 0U, 1U, 0U}) {  // in any order
        const Approximation made = approximator.fit(steps[k]), alone = approximate(control, steps[k]);
        EXPECT_EQ(made.mesh.attributes[0].values, alone.mesh.attributes[0].values);
        EXPECT_EQ(made.report.fields[0].rms, alone.report.fields[0].rms);
        EXPECT_EQ(made.report.iterations, alone.report.iterations);
        EXPECT_GT(made.report.fields[0].max, 1e-6);  // no step is a limit: it is a fit
    }
    EXPECT_EQ(approximator.placements(), 1U);
}

TEST(Approximator, FindsPlacesAnewWhereSamplesMoveOrAreOthers) {
    const HexMesh control = make_box(3, 3, 3);
    const HexMesh still = steps_of(control, 1)[0];
    HexMesh moved = still, fewer = still;
    for (Vec3& x : moved.points) x.x += 0.3;  // some samples leave the box
    fewer.points.resize(fewer.points.size() / 2);
    fewer.attributes[0].values.resize(fewer.points.size());
    fewer.cells.clear();  // which have points that are no longer there
    Approximator approximator(control);
    std::size_t placements = 0;
    for (const HexMesh& step : {still, moved, moved, fewer, still}) {
        const Approximation made = approximator.fit(step), alone = approximate(control, step);
        EXPECT_EQ(made.mesh.attributes[0].values, alone.mesh.attributes[0].values);
        EXPECT_EQ(made.report.outside, alone.report.outside);
        placements = approximator.placements();
    }
    EXPECT_EQ(placements, 4U);
}

TEST(Approximator, StepsMayHaveDifferentFields) {
    const HexMesh control = make_box(2, 2, 2);
    std::vector<HexMesh> steps = steps_of(control, 2);
    steps[1].attributes[0].name = "other";
    Approximator approximator(control, {.smoothing = 0.01});
    EXPECT_EQ(approximator.fit(steps[0]).mesh.attributes[0].name, "wave");
    const Approximation second = approximator.fit(steps[1]);
    ASSERT_EQ(second.mesh.attributes.size(), 1U);  // nothing of the first step is left
    EXPECT_EQ(second.mesh.attributes[0].name, "other");
}

TEST(Approximator, SaysWhatIsWrongAndGoesOn) {
    const HexMesh control = make_box(2, 2, 2);
    const HexMesh step = steps_of(control, 1)[0];
    EXPECT_THAT(error_of([&] { (void)Approximator(control, {.refine = 1}); }),
                HasSubstr("refine: all steps have the same control mesh"));
    EXPECT_THAT(error_of([&] { (void)Approximator(control, {.levels = 9}); }), HasSubstr("levels: 9 is out of range"));
    Approximator approximator(control);
    HexMesh none = step, short_one = step, gap = step, away = step;
    none.attributes.clear();
    short_one.attributes[0].values.pop_back();
    gap.attributes[0].values[5] = NAN;
    for (Vec3& x : away.points) x += 50.0;
    EXPECT_THAT(error_of([&] { (void)approximator.fit(none); }), HasSubstr("there is no field to approximate"));
    EXPECT_THAT(error_of([&] { (void)approximator.fit(short_one); }), HasSubstr("\"wave\" has 728 values, not 729"));
    EXPECT_THAT(error_of([&] { (void)approximator.fit(gap); }), HasSubstr("\"wave\" has no finite value at sample 5"));
    EXPECT_THAT(error_of([&] { (void)approximate(control, gap); }), HasSubstr("\"wave\" has no finite value at sample 5"));
    EXPECT_THAT(error_of([&] { (void)approximator.fit(away); }), HasSubstr("none of the samples lies in the limit"));
    EXPECT_EQ(approximator.fit(step).mesh.attributes[0].values, approximate(control, step).mesh.attributes[0].values);
}

TEST(Approximate, SaysWhatIsWrong) {
    const HexMesh box = make_box(2, 2, 2);
    HexMesh samples = test::only_points({{0.5, 0.5, 0.5}});
    EXPECT_THAT(error_of([&] { (void)approximate(box, samples); }), HasSubstr("there is no field to approximate"));
    samples.attributes = {{.name = "T", .channels = 1, .values = {1}}};
    samples.points[0] = Vec3(50.0);
    EXPECT_THAT(error_of([&] { (void)approximate(box, samples); }), HasSubstr("none of the samples lies in the limit"));
    EXPECT_THAT(error_of([&] { (void)approximate(box, samples, {.levels = 9}); }),
                HasSubstr("levels: 9 is out of range (1 to 4)"));
}

}  // namespace approximate_test
}  // namespace subvol
