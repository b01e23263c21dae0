// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample_mixed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/random_vector.h"
#include "lib/subdivision/mixed/mixed_meshes.h"
#include "subvol/rbf_field.h"

namespace subvol {
namespace sample_mixed_test {

using namespace test;

MixedMesh ball_with(const std::function<double(const Vec3&)>& f, int levels) {
    MixedMesh mesh = on_limit(refine(make_tet_ball(4), {.levels = levels}), TetScheme::Tetoct);
    mesh.attributes = {sampled(mesh, f)};
    return mesh;
}

// A quadratic has its own derivatives, whatever the mesh.
TEST(SampleMixed, DerivativesOfQuadraticsAreExact) {
    const MixedMesh mesh = ball_with([](const Vec3& p) { return 2 * p.x - p.y + p.x * p.x - 3 * p.y * p.z; }, 1);
    const RbfVolume volume = sample_rbf_points(mesh, {.correction = Correction::Full}).volume;
    validate(volume);
    const RbfChannel& channel = volume.channels[0];
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Vec3& p = mesh.points[i];
        const Vec3 gradient(2 + 2 * p.x, -1 - 3 * p.z, -3 * p.y);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(channel.gradients[i][static_cast<std::size_t>(k)], gradient[k], 1e-4);
        // tr(HS)/6 with H = diag(2, 0, 0) and −3 between y and z
        const double moment = (2 * volume.frames[i][0] - 6 * volume.frames[i][4]) / 6;
        EXPECT_NEAR(channel.moments[i], moment, 1e-4);
    }
}

TEST(SampleMixed, TheSumOfKernelsFollowsASmoothField) {
    const auto field = [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; };
    double before = 0;
    for (int level = 0; level < 2; ++level) {
        const MixedMesh mesh = ball_with(field, level);
        const RbfVolume volume = sample_rbf_points(mesh).volume;
        const RbfField sum(volume);
        double largest = 0;
        std::mt19937 random(1);
        std::uniform_real_distribution<double> side(-0.5, 0.5);
        for (int i = 0; i < 500; ++i) {
            const Vec3 x = random_vector(side, random);
            const auto value = sum.value(x);
            ASSERT_TRUE(value) << "a hole between the kernels";
            largest = std::max(largest, std::abs(*value - field(x)));
        }
        EXPECT_LT(largest, level == 0 ? 0.1 : before / 3);  // third order would be an eighth
        before = largest;
    }
}

TEST(SampleMixed, TheBoundaryIsThatOfTheMesh) {
    const MixedMesh mesh = ball_with([](const Vec3& p) { return p.x; }, 1);
    const Surface boundary = sample_rbf_points(mesh).volume.boundary;
    double volume = 0;
    for (const auto& [a, b, c] : boundary.triangles) {
        volume += glm::dot(boundary.points[a], glm::cross(boundary.points[b], boundary.points[c])) / 6;
    }
    EXPECT_NEAR(volume, measure_cells(mesh).volume, 1e-12);
}

TEST(SampleMixed, RefusesWhatItCannotSample) {
    MixedMesh mesh = make_kuhn_box(1);
    mesh.attributes = {{"v", 3, std::vector<double>(3 * mesh.points.size())}};
    expect_error(ErrorCode::InvalidInput, "scalars", [&] { static_cast<void>(sample_rbf_points(mesh)); });
}

}  // namespace sample_mixed_test
}  // namespace subvol
