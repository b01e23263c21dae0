// SPDX-License-Identifier: Apache-2.0
#include "subvol/reduce.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"
#include "subvol/sample.h"

namespace subvol {
namespace reduce_test {

/// A block whose field is constant but for a steep ball in one corner.
HexMesh mesh_with_feature(Index n) {
    HexMesh mesh = test::make_box(n, n, n);
    for (auto& p : mesh.points) p *= 1.0 / double(n);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::tanh((.2 - glm::length(p - Vec3(.3))) / .08); });
    return mesh;
}

TEST(Reduce, MeetsItsTargetOnIndependentSamples) {
    for (const std::string& name : {std::string("twist"), std::string("ball")}) {
        const HexMesh mesh = make_model(name, name == "ball" ? 8 : 16);
        // Not the samples that validated the reduction: more of them, at other places.
        const FieldSamples other = limit_samples_in_cells(mesh, "", 31'000, {.tolerance = 1e-4});
        for (const double rmse : {.05, .01}) {
            const auto reduced = reduce_rbf(mesh, "", {.rmse = rmse});
            EXPECT_TRUE(reduced.report.reached) << name;
            const ErrorAtSamples error = error_at_samples(reduced.volume, other);
            EXPECT_LE(error.rmse, 1.05 * rmse) << name;  // two sets of samples differ by some per cent
            EXPECT_EQ(error.uncovered, 0u) << name;
            EXPECT_EQ(reduced.report.points, reduced.volume.size());
            EXPECT_LT(reduced.volume.size(), mesh.points.size() / 4) << name;
            EXPECT_FALSE(reduced.volume.boundary.triangles.empty());
        }
    }
}

TEST(Reduce, NeedsFewerKernelsThanUniformSamplesWhereTheFieldIsLocal) {
    const HexMesh mesh = mesh_with_feature(24);
    const FieldSamples other = limit_samples_in_cells(mesh, "", 20'000, {.tolerance = 1e-4});
    for (const Index n : {8U, 12U}) {  // the same field, sampled on coarser lattices with second-order kernels
        const RbfVolume uniform = sample_rbf_points(mesh_with_feature(n)).volume;
        const double error = error_at_samples(uniform, other).rmse;
        const auto reduced = reduce_rbf(mesh, "", {.rmse = error});
        EXPECT_TRUE(reduced.report.reached);
        EXPECT_LE(error_at_samples(reduced.volume, other).rmse, 1.01 * error);
        EXPECT_LT(reduced.volume.size(), uniform.size() / 2) << "half as many and fewer at " << n;
    }
}

TEST(Reduce, OneKernelIsEnoughForALinearField) {
    HexMesh mesh = test::irregular();
    test::add_field(mesh, "f", [](const Vec3& p) { return 1 + p.x - 2 * p.y + .5 * p.z; });
    const auto reduced = reduce_rbf(mesh, "", {.rmse = 1e-4});
    EXPECT_EQ(reduced.volume.size(), 1u);
    EXPECT_TRUE(reduced.report.reached);
}

TEST(Reduce, StopsAtTheMostPoints) {
    const auto reduced = reduce_rbf(mesh_with_feature(8), "f", {.rmse = 1e-6, .max_points = 30});
    EXPECT_EQ(reduced.volume.size(), 30u);
    EXPECT_FALSE(reduced.report.reached);
}

void expect_same(const RbfVolume& a, const RbfVolume& b) {
    EXPECT_EQ(a.centers, b.centers);
    EXPECT_EQ(a.frames, b.frames);
    EXPECT_EQ(a.channels[0].values, b.channels[0].values);
    EXPECT_EQ(a.channels[0].gradients, b.channels[0].gradients);
    EXPECT_EQ(a.channels[0].moments, b.channels[0].moments);
}

TEST(Reduce, AnyNumberOfThreadsGivesTheSameBits) {
    const HexMesh mesh = mesh_with_feature(10);
    const ReduceOptions options{.rmse = .05, .move = true};
    const auto many = reduce_rbf(mesh, "", options);
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    expect_same(many.volume, reduce_rbf(mesh, "", options).volume);
}

TEST(Refine, LowersTheErrorOfSampledKernels) {
    const HexMesh coarse = mesh_with_feature(8), fine = mesh_with_feature(24);
    const FieldSamples samples = limit_samples_at_vertices(fine, "", 1);
    const FieldSamples other = limit_samples_in_cells(fine, "", 20'000, {.tolerance = 1e-4});
    const RbfVolume start = sample_rbf_points(coarse).volume;
    const auto fixed = refine_rbf(start, samples);
    const auto moved = refine_rbf(fixed.volume, samples, {.move = true, .iterations = 10});
    EXPECT_LT(fixed.report.rmse_after, .5 * fixed.report.rmse_before);
    EXPECT_LT(moved.report.rmse_after, .9 * moved.report.rmse_before);
    EXPECT_EQ(fixed.volume.centers, start.centers);
    EXPECT_NE(moved.volume.centers, start.centers);
    // The error falls between the samples as well as at them.
    const double before = error_at_samples(start, other).rmse;
    EXPECT_LT(error_at_samples(fixed.volume, other).rmse, .6 * before);
    EXPECT_LT(error_at_samples(moved.volume, other).rmse, error_at_samples(fixed.volume, other).rmse);
    EXPECT_EQ(error_at_samples(moved.volume, other).uncovered, 0u);
    EXPECT_EQ(moved.volume.boundary.triangles.size(), start.boundary.triangles.size());
}

TEST(Refine, LeavesKernelsThatReachNoSample) {
    RbfVolume volume = sample_rbf_points(mesh_with_feature(6)).volume;
    FieldSamples samples = limit_samples_at_vertices(mesh_with_feature(6), "", 1);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {  // only where x < .4
        if (samples.points[i].x >= .4) continue;
        samples.points[kept] = samples.points[i];
        samples.values[kept] = samples.values[i] + 1;
        samples.weights[kept++] = samples.weights[i];
    }
    samples.points.resize(kept);
    samples.values.resize(kept);
    samples.weights.resize(kept);
    const auto refined = refine_rbf(volume, samples);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        if (volume.centers[i].x > .4 + 1.43 / 6) {
            EXPECT_NEAR(refined.volume.channels[0].values[i], volume.channels[0].values[i], 1e-6);  // floats
        }
    }
    EXPECT_LT(refined.report.rmse_after, .2 * refined.report.rmse_before);
}

TEST(Reduce, RefusesWrongOptionsAndSamples) {
    const auto refuse = [](const std::string& part, const auto& call) {
        test::expect_error(ErrorCode::InvalidInput, part, call);
    };
    const HexMesh mesh = mesh_with_feature(4);
    refuse("rmse: ", [&] { (void)reduce_rbf(mesh, "", {.rmse = 0}); });
    refuse("rmse: ", [&] { (void)reduce_rbf(mesh, "", {.rmse = NAN}); });
    refuse("overlap", [&] { (void)reduce_rbf(mesh, "", {.overlap = .1}); });
    refuse("not radial", [&] { (void)reduce_rbf(mesh, "", {.kernel = CubicConvolutionKernel{}}); });
    refuse("max_points: 0 is out of range", [&] { (void)reduce_rbf(mesh, "", {.max_points = 0}); });
    refuse("no field", [&] { (void)reduce_rbf(test::make_box(2, 2, 2), ""); });
    refuse("no hexahedra", [&] { (void)limit_samples_in_cells(HexMesh{{}, {}, mesh.attributes, {}, {}}, "f", 10); });
    refuse("no hexahedra", [&] { (void)reduce_rbf(HexMesh{{}, {}, mesh.attributes, {}, {}}, "f"); });
    refuse("no hexahedra", [&] { (void)limit_samples_at_vertices(HexMesh{{}, {}, mesh.attributes, {}, {}}, "f", 1); });
    refuse("no hexahedra", [&] { (void)sample_rbf_points(HexMesh{{}, {}, mesh.attributes, {}, {}}); });
    FieldSamples samples = limit_samples_at_vertices(mesh, "", 1);
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    refuse("iterations", [&] { (void)refine_rbf(volume, samples, {.iterations = 0}); });
    refuse("ridge", [&] { (void)refine_rbf(volume, samples, {.ridge = 0}); });
    refuse("no channel", [&] { (void)refine_rbf(RbfVolume{}, samples); });
    FieldSamples elsewhere = samples;
    for (Vec3& x : elsewhere.points) x += Vec3(100);
    const ErrorAtSamples nowhere = error_at_samples(volume, elsewhere);  // an error of nothing is none of 0
    EXPECT_EQ(nowhere.uncovered, samples.size());
    EXPECT_TRUE(std::isnan(nowhere.rmse) && std::isnan(nowhere.max_abs));
    samples.values[3] = INFINITY;
    refuse("sample 3", [&] { (void)error_at_samples(volume, samples); });
    samples.values.pop_back();
    refuse("one value", [&] { (void)error_at_samples(volume, samples); });
}

}  // namespace reduce_test
}  // namespace subvol
