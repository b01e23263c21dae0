// SPDX-License-Identifier: Apache-2.0
#include "subvol/points_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/probe.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"

namespace subvol::test {

namespace points_error_test {

RbfVolume points_of(const HexMesh& mesh, int per_edge = 1) {
    return sample_rbf_points(mesh, {.per_edge = per_edge}).volume;
}

// True errors at random places of the limit.
struct Truth {
    double max = 0, rms = 0;
};

Truth truth(const RbfVolume& points, const HexMesh& mesh) {
    std::mt19937 random(5);
    const LimitProbe probe(mesh);
    const Box box = probe.box();
    std::vector<Vec3> places;
    for (int i = 0; i < 10000; ++i) {
        Vec3 x;
        for (int a = 0; a < 3; ++a) x[a] = std::uniform_real_distribution<double>(box.lower[a], box.upper[a])(random);
        places.push_back(x);
    }
    const ProbeResult limit = probe.at(places);
    const std::vector<double> sums = RbfField(points).evaluate(places);
    Truth truth;
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!limit.inside(i) || std::isnan(sums[i])) continue;
        const double off = std::abs(sums[i] - limit.fields[0].values[i]);
        truth.max = std::max(truth.max, off);
        squares += off * off;
        ++count;
    }
    truth.rms = std::sqrt(squares / static_cast<double>(count));
    return truth;
}

// The estimate is of the size of the true error.
TEST(PointsError, IsAboutTheTrueError) {
    for (const char* model : {"twist", "ball", "pawn"}) {
        const HexMesh mesh = make_model(model, model == std::string("pawn") ? 0 : 6);
        const RbfVolume points = points_of(mesh);
        const PointsError error = points_error(points, mesh, "density");
        const Truth is = truth(points, mesh);
        EXPECT_EQ(error.of_points.size(), points.size());
        EXPECT_EQ(*std::ranges::max_element(error.of_points), error.max);
        EXPECT_GT(error.max, 0.5 * is.max) << model;
        EXPECT_LT(error.max, 3 * is.max) << model;
        EXPECT_GT(error.rms, 0.5 * is.rms) << model;
        EXPECT_LT(error.rms, 2.5 * is.rms) << model;
    }
}

TEST(PointsError, FallsWithMoreKernels) {
    const HexMesh mesh = make_model("ball", 5);
    EXPECT_LT(points_error(points_of(mesh, 2), mesh, "density").rms, 0.7 * points_error(points_of(mesh), mesh, "density").rms);
}

// Kernels with gradients reproduce linear fields.
TEST(PointsError, IsNothingWhereKernelsAreExact) {
    HexMesh mesh = make_box(4, 4, 4);
    add_field(mesh, "f", [](const Vec3& x) { return 2 * x.x - x.y + 0.5 * x.z; });
    const PointsError error = points_error(points_of(mesh), mesh, "f");
    EXPECT_GT(error.places, 500U);
    EXPECT_EQ(error.gaps, 0U);
    EXPECT_LT(error.max, 2e-5);
}

TEST(PointsError, BecomesAChannel) {
    const HexMesh mesh = make_model("ball", 4);
    RbfVolume points = points_of(mesh);
    const PointsError error = points_error(points, mesh, "density");
    points.channels.push_back(error_channel(error, "density"));
    validate(points);
    EXPECT_EQ(points.channels.back().name, "density_error");
    EXPECT_EQ(points.channels.back().values[7], static_cast<float>(error.of_points[7]));
    EXPECT_NE(error_of([&] { static_cast<void>(points_error(points, mesh, "density", {.channel = 9})); }).find("channel"),
              std::string::npos);
}

}  // namespace points_error_test
}  // namespace subvol::test
