// SPDX-License-Identifier: Apache-2.0
#include "subvol/probe.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace probe_test {

/// Random places inside cells of the limit.
std::vector<LimitQuery> random_queries(const HexMesh& mesh, std::size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> t(0, 1);
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < count; ++i) {
        const auto cell = static_cast<Index>(random() % mesh.cells.size());
        queries.push_back({cell, {t(random), t(random), t(random)}});
    }
    return queries;
}

/// Asserts that the limit has the same values at places as where they are found: to 1e-6 of the field's range of about 1, with
/// the tolerance of `evaluate_limit` (1e-6 of the diagonal) once for the place and once for its search.
void expect_values_of_the_limit(HexMesh mesh, const SchemeOptions& scheme = {}) {
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x) * p.y + p.z; });
    mesh.attributes.push_back({"v", 2, {}});
    for (const Vec3& p : mesh.points)
        mesh.attributes.back().values.insert(mesh.attributes.back().values.end(), {p.z, p.x * p.y});
    const LimitOptions limit{.scheme = scheme, .tolerance = 1e-8, .max_levels = 14};
    const auto queries = random_queries(mesh, 2000);
    const LimitSamples samples = evaluate_limit(mesh, queries, limit);
    const ProbeResult found = LimitProbe(mesh, {.limit = limit}).at(samples.positions);
    ASSERT_EQ(found.cells.size(), queries.size());
    std::size_t same_cells = 0;
    for (std::size_t q = 0; q < queries.size(); ++q) {
        ASSERT_TRUE(found.inside(q)) << q << " of cell " << queries[q].cell;
        same_cells += found.cells[q] == queries[q].cell ? 1 : 0;
        for (std::size_t f = 0; f < mesh.attributes.size(); ++f) {
            const std::size_t channels = found.fields[f].channels;
            for (std::size_t c = 0; c < channels; ++c) {
                EXPECT_NEAR(found.fields[f].values[q * channels + c], samples.attributes[f].values[q * channels + c], 1e-6)
                    << q;
            }
        }
    }
    EXPECT_GT(same_cells, queries.size() * 99 / 100);
}

TEST(Probe, FindsThePlacesOfRegularCells) {
    HexMesh mesh = test::make_box(4, 3, 3);
    test::jitter(mesh, .1, 5);
    expect_values_of_the_limit(mesh);
}

TEST(Probe, FindsPlacesAboutIrregularEdges) {
    expect_values_of_the_limit(test::irregular());
}

TEST(Probe, FindsPlacesOfSplines) {
    expect_values_of_the_limit(test::irregular(), {.kind = Scheme::CatmullClark});
}

TEST(Probe, FindsPlacesOfTrilinearCells) {
    expect_values_of_the_limit(test::irregular(), {.kind = Scheme::Linear});
}

TEST(Probe, FindsTheSameInAnyOrder) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x) * p.y + p.z; });
    const auto queries = random_queries(mesh, 3000);
    const std::vector<Vec3> places = evaluate_limit(mesh, queries).positions;
    const LimitProbe probe(mesh);
    const ProbeResult all = probe.at(places);
    const std::vector<Vec3> backwards(places.rbegin(), places.rbegin() + 1000);
    const ProbeResult some = probe.at(backwards);
    for (std::size_t p = 0; p < backwards.size(); ++p) {
        const std::size_t same = places.size() - 1 - p;
        EXPECT_EQ(some.cells[p], all.cells[same]);
        EXPECT_EQ(some.parameters[p], all.parameters[same]);
        EXPECT_EQ(some.fields[0].values[p], all.fields[0].values[same]);
        EXPECT_EQ(some.fields[0].gradients[p], all.fields[0].gradients[same]);
    }
}

TEST(Probe, GradientsAreThoseByPosition) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return 2 * p.x - 3 * p.y + .5 * p.z; });  // affine fields stay affine
    const ProbeResult found = LimitProbe(mesh).at(std::vector<Vec3>{{.1, .2, .3}, {-.6, .1, .2}, {0, 0, 0}});
    for (std::size_t p = 0; p < 3; ++p) {
        ASSERT_TRUE(found.inside(p));
        EXPECT_NEAR(glm::distance(found.fields[0].gradients[p], Vec3(2, -3, .5)), 0, 1e-6);
    }
    EXPECT_NEAR(found.fields[0].values[0], .2 - .6 + .15, 1e-6);
}

TEST(Probe, ALineLeavesABallAndEntersItsHoleAgain) {
    // Of a ball with its inner cube taken out: in, out, in, out.
    HexMesh mesh = make_model("ball", 4);
    const HexMesh whole = mesh;
    std::erase_if(mesh.cells, [&](const auto& cell) {
        Vec3 center(0);
        for (const Index p : cell) center += whole.points[p] / 8.0;
        return std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)}) < .35;
    });
    mesh = without_unused_points(std::move(mesh));
    const auto places = places_on_line({-1.2, .013, .027}, {1.2, .013, .027}, 241);
    const ProbeResult found = LimitProbe(mesh).at(places);
    std::vector<double> changes;
    for (std::size_t p = 1; p < places.size(); ++p) {
        if (found.inside(p) != found.inside(p - 1)) changes.push_back(places[p].x);
    }
    ASSERT_EQ(changes.size(), 4u);
    EXPECT_NEAR(changes[0], -1, .02);
    EXPECT_NEAR(changes[1], -changes[2], .02);
    EXPECT_NEAR(changes[3], 1, .02);
}

TEST(Probe, OutsideThereIsNothingButWithinReachTheNearestPlace) {
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const std::vector<Vec3> places{{2.05, 1, 1}, {2.3, 1, 1}, {2, 2, 2}, {0, 0, 0}, {1e9, 0, 0}};
    const ProbeResult strict = LimitProbe(mesh).at(places);
    EXPECT_FALSE(strict.inside(0));
    EXPECT_FALSE(strict.inside(1));
    EXPECT_TRUE(strict.inside(2)) << "the boundary belongs to the volume";
    EXPECT_TRUE(strict.inside(3));
    EXPECT_FALSE(strict.inside(4));
    const ProbeResult reaching = LimitProbe(mesh, {.reach_world = .1}).at(places);
    ASSERT_TRUE(reaching.inside(0));
    EXPECT_NEAR(reaching.distances[0], .05, 1e-6);
    EXPECT_NEAR(reaching.fields[0].values[0], 2, 1e-6);
    EXPECT_FALSE(reaching.inside(1));
}

TEST(Probe, IsTheSameForAnyNumberOfThreads) {
    HexMesh mesh = make_model("twist", 6);
    const auto places = places_on_line({-1, -.9, -1.1}, {1.1, 1, .9}, 5000);
    const auto values = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return LimitProbe(mesh).at(places).fields[0].values;
    };
    EXPECT_EQ(values(1), values(4));
}

TEST(Probe, OfManyCellsIsThatOfTheCellsAboutThePlaces) {
    const HexMesh mesh = make_model("twist", 65);
    ASSERT_GT(mesh.cells.size(), kMostCellsOfAProbe);
    std::vector<Vec3> places = places_on_line({-1, -0.7, 0.3}, {1, 0.6, 0.4}, 40);
    places.push_back(mesh.points[1234]);
    places.emplace_back(9, 9, 9);
    const ProbeResult all = LimitProbe(mesh).at(places), near = probe_limit(mesh, places);
    EXPECT_EQ(near.cells, all.cells);
    EXPECT_EQ(near.fields[0].values, all.fields[0].values);
    for (std::size_t p = 0; p < places.size(); ++p) {
        EXPECT_LT(glm::distance(near.fields[0].gradients[p], all.fields[0].gradients[p]), 1e-12);
        EXPECT_LT(glm::distance(near.parameters[p], all.parameters[p]), 1e-12);
    }
    EXPECT_FALSE(near.inside(41));
}

TEST(Probe, RefusesWhatIsNoPlace) {
    const LimitProbe probe(test::make_box(2, 2, 2));
    test::expect_error(ErrorCode::InvalidInput, "place 1", [&] { (void)probe.at(std::vector<Vec3>{{0, 0, 0}, {0, NAN, 0}}); });
    test::expect_error(ErrorCode::InvalidInput, "count", [] { (void)places_on_line({0, 0, 0}, {1, 1, 1}, 0); });
    test::expect_error(ErrorCode::InvalidInput, "reach",
                       [] { (void)LimitProbe(test::make_box(1, 1, 1), {.reach_world = -1}); });
}

}  // namespace probe_test
}  // namespace subvol
