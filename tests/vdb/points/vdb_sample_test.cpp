// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_sample.h"

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <tbb/global_control.h>
#include "openvdb_grids.h"

#include <cstdlib>
#include <functional>
#include <random>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "subvol/rbf_field.h"

namespace subvol {
namespace vdb_sample_test {

using openvdb::Coord;
using Function = std::function<double(const Vec3&)>;

// Values are 32-bit floats below 8 and so are the terms of about ten kernels that overlap: 1e-6 each.
constexpr double kFloatTolerance = 1e-5;

/// A sheared lattice away from the origin, as other programs may write it.
const openvdb::Mat4d kSheared(0.2, 0., 0., 0., 0.03, 0.15, 0., 0., 0., -0.02, 0.25, 0., 3., -1., 0.5, 1.);

/// A grid written to a file and read again, like grids of other programs.
class VdbSample : public test::TempFolder {
protected:
    VdbSample() { openvdb::initialize(); }

    openvdb::FloatGrid::Ptr make(const Function& field, const openvdb::CoordBBox& box,
                                 const openvdb::Mat4d& to_world = kSheared) const {
        auto grid = openvdb::FloatGrid::create(0.0f);
        grid->setName("heat");
        grid->setTransform(openvdb::math::Transform::createLinearTransform(to_world));
        auto accessor = grid->getAccessor();
        for (auto voxel = box.begin(); voxel; ++voxel) {
            const auto x = grid->indexToWorld(*voxel);
            accessor.setValueOn(*voxel, static_cast<float>(field({x[0], x[1], x[2]})));
        }
        return grid;
    }

    VdbGrid through_file(const openvdb::GridBase::Ptr& grid) const {
        const auto file = path("a.vdb");
        openvdb::io::File(file.string()).write(openvdb::GridCPtrVec{grid});
        return std::move(read_vdb(file).front());
    }
};

/// World positions of random places in the lattice, at least `margin` voxels inside the box's outermost centres.
std::vector<Vec3> places(const VdbGrid& grid, double margin, int count) {
    const auto voxels = grid.voxels();
    const auto [lower, upper] = voxels->range();
    std::mt19937 random(5);
    std::vector<Vec3> result;
    for (int i = 0; i < count; ++i) {
        Vec3 index;
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            index[k] = std::uniform_real_distribution(lower[axis] + margin, upper[axis] - margin)(random);
        }
        result.push_back(voxels->to_world() * index + voxels->origin());
    }
    return result;
}

double linear(const Vec3& p) {
    return 1.5 + 0.25 * p.x - 0.5 * p.y + p.z;
}

double quadratic(const Vec3& p) {
    return 1 + 0.1 * p.x * p.x - 0.2 * p.x * p.y + 0.15 * p.y * p.y + 0.05 * p.y * p.z - 0.1 * p.z * p.z;
}

const openvdb::CoordBBox kBox(Coord(-9, -4, -7), Coord(10, 11, 6));  // across leaves, and across 0

TEST_F(VdbSample, LinearFieldsComeBackUpToTheRim) {
    const VdbGrid grid = through_file(make(linear, kBox));
    for (const Correction correction : {Correction::Gradient, Correction::Second, Correction::Full}) {
        const auto result = sample_rbf_points(grid, {.correction = correction});
        EXPECT_EQ(result.report.points, grid.report().active_voxels);
        EXPECT_EQ(result.volume.channels.front().name, "heat");
        const RbfField field(result.volume);
        for (const Vec3& x : places(grid, 0, 500)) ASSERT_NEAR(field.value(x).value(), linear(x), kFloatTolerance);
    }
}

double volume_of(const Surface& surface) {
    double six = 0;
    for (const auto& [a, b, c] : surface.triangles)
        six += glm::dot(surface.points[a], glm::cross(surface.points[b], surface.points[c]));
    return six / 6;
}

// Kernels end at the faces of their voxels, or of the blocks of voxels: a closed surface, outward also where an axis is
// mirrored, around as many parallelepipeds.
TEST_F(VdbSample, FacesEncloseTheVoxels) {
    openvdb::Mat4d mirrored = kSheared;
    mirrored.preScale(openvdb::Vec3d(1, -1, 1));
    for (const openvdb::Mat4d& to_world : {kSheared, mirrored}) {
        auto voxels = make(linear, kBox, to_world);
        voxels->getAccessor().setValueOff(Coord(0, 0, 0));       // a cavity
        voxels->getAccessor().setValueOn(Coord(20, 20, 20), 7);  // alone
        const VdbGrid grid = through_file(voxels);
        const VoxelSampleResult result = sample_rbf_points(grid, {.faces = true});
        const Surface& faces = result.faces.surface;
        const double voxel = std::abs(glm::determinant(grid.voxels()->to_world()));
        EXPECT_NEAR(volume_of(faces), static_cast<double>(grid.report().active_voxels) * voxel, 1e-9);
        // Faces of a box of 20 × 16 × 14 voxels, of the cavity and of the voxel that is alone, two triangles each.
        EXPECT_EQ(faces.triangles.size(), 2U * (2 * (20 * 16 + 16 * 14 + 20 * 14) + 6 + 6));
        EXPECT_EQ(faces.points.size(), result.faces.values.front().size());
        double least = 1e9, largest = -1e9;
        for (std::size_t p = 0; p < faces.points.size(); ++p) {
            const double value = result.faces.values.front()[p];
            least = std::min(least, value);
            largest = std::max(largest, value);
        }
        EXPECT_EQ(largest, 7);
        EXPECT_NEAR(least, grid.report().min, 1e-6);  // at a corner of the box there is one voxel alone
        // Of blocks of 2³, whose lattice is another one.
        const VoxelSampleResult blocks = sample_rbf_points(grid, {.spacing_world = 2 * std::cbrt(voxel), .faces = true});
        EXPECT_NEAR(volume_of(blocks.faces.surface), static_cast<double>(blocks.report.points) * 8 * voxel, 1e-9);
        EXPECT_TRUE(sample_rbf_points(grid).faces.surface.triangles.empty());
    }
}

TEST_F(VdbSample, WithoutCorrectionOnlyTheValuesAreThere) {
    const auto volume = sample_rbf_points(through_file(make(linear, kBox)), {.correction = Correction::None}).volume;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        ASSERT_NEAR(volume.channels[0].values[i], linear(volume.centers[i]), kFloatTolerance);
        ASSERT_EQ(volume.channels[0].gradients[i], (std::array<float, 3>{}));
        ASSERT_EQ(volume.channels[0].moments[i], 0);
    }
}

TEST_F(VdbSample, QuadraticFieldsComeBackInsideWithAllSecondDerivatives) {
    const VdbGrid grid = through_file(make(quadratic, kBox));
    const RbfField full(sample_rbf_points(grid, {.correction = Correction::Full}).volume);
    // The outermost voxels have no second derivatives, and kernels reach 1.43 voxels.
    for (const Vec3& x : places(grid, 2.5, 500)) ASSERT_NEAR(full.value(x).value(), quadratic(x), kFloatTolerance);
}

TEST_F(VdbSample, TheSecondMomentIsThatOfTheLattice) {
    const VdbGrid grid = through_file(make(quadratic, kBox));
    const auto volume = sample_rbf_points(grid).volume;
    const double r2 = std::pow(support_radius(volume.kernel), 2);
    const Mat3 hessian(0.2, -0.2, 0, -0.2, 0.3, 0.05, 0, 0.05, -0.2), j = grid.voxels()->to_world();
    double moment = 0;  // R² H:JJᵀ/6
    for (int a = 0; a < 3; ++a) moment += r2 / 6 * glm::dot(j[a], hessian * j[a]);
    int inside = 0;
    for (const float found : volume.channels[0].moments) inside += std::abs(found - moment) < kFloatTolerance;
    EXPECT_EQ(inside, 18 * 14 * 12);  // all but the outermost of 20 x 16 x 14
}

TEST_F(VdbSample, FramesAreTheVoxelsAxes) {
    const VdbGrid grid = through_file(make(linear, kBox));
    const auto volume = sample_rbf_points(grid).volume;
    const double radius = support_radius(volume.kernel);
    const Mat3 j = radius * grid.voxels()->to_world(), s = j * glm::transpose(j);
    const std::array<double, 6> expected{s[0][0], s[1][0], s[2][0], s[1][1], s[2][1], s[2][2]};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(volume.frames[0][k], expected[k], 1e-7);
}

TEST_F(VdbSample, ASpacingTakesMeansOfBlocks) {
    // From a multiple of 3 to a multiple of 3: no block is cut.
    const VdbGrid grid = through_file(make(linear, {Coord(-9, -6, -9), Coord(8, 11, 5)}));
    const double spacing = 3.2 * std::cbrt(glm::determinant(grid.voxels()->to_world()));
    const auto result = sample_rbf_points(grid, {.spacing_world = spacing});
    EXPECT_EQ(result.report.voxels_a_side, 3);
    EXPECT_EQ(result.report.points * 27, grid.report().active_voxels);
    EXPECT_EQ(result.report.left_out, 0u);
    // The mean of a linear field over a block is its value in the middle, where the kernel must then be.
    const RbfField field(result.volume);
    for (const Vec3& x : places(grid, 1, 500)) ASSERT_NEAR(field.value(x).value(), linear(x), kFloatTolerance);
}

TEST_F(VdbSample, BlocksOfWhichLessThanHalfIsActiveAreLeftOut) {
    const auto fine = make([](const Vec3&) { return 2.0; }, {Coord(0), Coord(3)}, openvdb::Mat4d::identity());
    fine->tree().setValueOn(Coord(-1, 0, 0), 5.0f);  // an eighth of its block
    const auto result = sample_rbf_points(through_file(fine), {.spacing_world = 2});
    EXPECT_EQ(result.report.points, 8u);
    EXPECT_EQ(result.report.left_out, 1u);
    for (const float value : result.volume.channels[0].values) EXPECT_EQ(value, 2);
    EXPECT_EQ(result.volume.bounds.lower, Vec3(0.5));
    EXPECT_EQ(result.volume.bounds.upper, Vec3(2.5));
}

TEST_F(VdbSample, TilesAreVoxelsToo) {
    auto grid = openvdb::FloatGrid::create(0.0f);
    grid->setName("tile");
    grid->denseFill({Coord(0), Coord(23)}, 3.0f);
    grid->tree().prune();
    ASSERT_GT(grid->constTree().activeTileCount(), 0u);
    const auto result = sample_rbf_points(through_file(grid));
    EXPECT_EQ(result.report.points, 24u * 24 * 24);
    EXPECT_EQ(result.volume.channels[0].values.front(), 3);
    EXPECT_EQ(sample_rbf_points(through_file(grid), {.spacing_world = 2}).report.points, 12u * 12 * 12);
}

TEST_F(VdbSample, SameForAnyNumberOfThreads) {
    std::mt19937 random(1);
    const auto noise = make([&](const Vec3&) { return static_cast<double>(random() % 1000) * 1e-3; }, {Coord(-20), Coord(25)});
    for (const openvdb::Coord hole : {Coord(0), Coord(7, 3, -9)}) noise->tree().setValueOff(hole);
    const VdbGrid grid = through_file(noise);
    const auto run = [&](std::size_t threads, double spacing) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return sample_rbf_points(grid, {.spacing_world = spacing, .correction = Correction::Full}).volume;
    };
    for (const double spacing : {0.0, 0.6}) {
        const RbfVolume one = run(1, spacing), many = run(7, spacing);
        EXPECT_EQ(one.centers, many.centers);
        EXPECT_EQ(one.frames, many.frames);
        EXPECT_EQ(one.channels[0].values, many.channels[0].values);
        EXPECT_EQ(one.channels[0].gradients, many.channels[0].gradients);
        EXPECT_EQ(one.channels[0].moments, many.channels[0].moments);
        EXPECT_EQ(one.channels[0].hessians, many.channels[0].hessians);
    }
}

TEST_F(VdbSample, RefusesWhatItCannotSample) {
    const auto grid = make(linear, kBox);
    const auto sample = [&](const VoxelSampleOptions& options) { (void)sample_rbf_points(through_file(grid), options); };
    test::expect_error(ErrorCode::InvalidInput, "spacing", [&] { sample({.spacing_world = std::nan("")}); });
    test::expect_error(ErrorCode::InvalidInput, "half active", [&] { sample({.spacing_world = 1e9}); });
    test::expect_error(ErrorCode::InvalidInput, "radial", [&] { sample({.kernel = named_kernel("cubic")}); });
    grid->tree().setValueOn(Coord(1), std::numeric_limits<float>::infinity());
    test::expect_error(ErrorCode::InvalidInput, "finite", [&] { sample({}); });
    grid->clear();
    test::expect_error(ErrorCode::InvalidInput, "no active voxels", [&] { sample({}); });
}

TEST_F(VdbSample, SmokeOfAnotherProgramAtItsVoxels) {
    const char* data = std::getenv("SUBVOL_DATA");
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real grids";
    const VdbGrid grid = std::move(read_vdb(std::filesystem::path(data) / "arnold_smoke.vdb").front());
    const auto volume = sample_rbf_points(grid).volume;
    ASSERT_EQ(volume.size(), grid.report().active_voxels);
    for (std::size_t i = 0; i < volume.size(); i += 997) {
        ASSERT_NEAR(volume.channels[0].values[i], grid.value(volume.centers[i]).value(), 1e-5 * grid.report().max);
    }
}

}  // namespace vdb_sample_test
}  // namespace subvol
