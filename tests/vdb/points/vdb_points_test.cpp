// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_points.h"

#include <gmock/gmock.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include "openvdb_grids.h"

#include <csignal>
#include <random>
#include <set>

#include "lib/kernel_samples.h"
#include "lib/rbf_volumes.h"
#include "lib/temp_folder.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/surface_io.h"
#include "subvol/points_io.h"
#include "subvol/vdb_grid.h"
#include "vdb/vdb_damage.h"

namespace subvol::test {

using namespace detail;

namespace vdb_points_test {

using testing::HasSubstr;

using VdbPoints = TempFolder;

openvdb::points::PointDataGrid::Ptr open_grid(const std::filesystem::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open(false);
    return openvdb::gridPtrCast<openvdb::points::PointDataGrid>(file.readGrid("points"));
}

void expect_round_trip(const RbfVolume& volume, const std::filesystem::path& path, double voxel) {
    write_vdb_points(path, volume);
    const RbfVolume read = read_vdb_points(path);
    expect_same_but_centers(read, volume);
    // P is a float in ±.5 voxels, hence exact to 2⁻²⁶ voxels; the transform rounds doubles.
    const double tolerance = 0x1p-26 * voxel + 1e-15 * glm::length(volume.bounds.center());
    for (std::size_t i = 0; i < volume.size(); ++i) {
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(read.centers[i][k], volume.centers[i][k], tolerance) << i;
    }
}

TEST_F(VdbPoints, ComeBackInTheirOrder) {
    for (const std::size_t channels : {1U, 3U}) {
        const RbfVolume volume = random_points(5000, channels);
        write_vdb_points(path("a.vdb"), volume);
        const double voxel = open_grid(path("a.vdb"))->voxelSize().x();
        EXPECT_LT(voxel, volume.bounds.diagonal() / 10);
        expect_round_trip(volume, path("a.vdb"), voxel);
    }
    EXPECT_EQ(file_count(), 2u);
    EXPECT_TRUE(holds_vdb_points(path("a.vdb")));
}

TEST_F(VdbPoints, HessiansOfASampledVolumeComeBack) {
    const RbfVolume volume = ball_with_hessians();
    write_vdb_points(path("a.vdb"), volume);
    expect_same_but_centers(read_vdb_points(path("a.vdb")), volume);
}

TEST_F(VdbPoints, EveryKernelComesBack) {
    RbfVolume volume = random_points(5, 1);
    const auto expect_kernel = [&](const Kernel& kernel) {
        volume.kernel = kernel;
        write_vdb_points(path("a.vdb"), volume);
        expect_same_but_centers(read_vdb_points(path("a.vdb")), volume);
    };
    for (const std::string& name : kernel_names()) expect_kernel(named_kernel(name));
    for (const auto& [name, kernel] : every_kernel()) expect_kernel(kernel);
}

// Names that would become equal get underscores, and each channel keeps its own Hessians, or none.
TEST_F(VdbPoints, NamesOfHessiansDoNotClash) {
    RbfVolume volume = random_points(50, 4);
    volume.channels[1].name = "density.hessian";
    volume.channels[3].name = "density_hessian";
    write_vdb_points(path("a.vdb"), volume);
    expect_same_but_centers(read_vdb_points(path("a.vdb")), volume);
}

TEST_F(VdbPoints, LieTheSameForAnyNumberOfThreads) {
    const RbfVolume volume = random_points(5000, 1);
    std::vector<std::int32_t> expected;
    for (const std::size_t threads : {1U, 3U}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        write_vdb_points(path("a.vdb"), volume);
        const auto grid = open_grid(path("a.vdb"));
        std::vector<std::int32_t> ids;
        for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
            const openvdb::points::AttributeHandle<std::int32_t> id(leaf->constAttributeArray("id"));
            for (auto i = leaf->beginIndexOn(); i; ++i) ids.push_back(id.get(*i));
        }
        if (expected.empty()) expected = ids;
        EXPECT_EQ(ids, expected);
    }
    EXPECT_EQ(expected.size(), volume.size());
}

TEST_F(VdbPoints, SmallAndFarOnesToo) {
    RbfVolume volume = random_points(300, 1);
    volume.boundary = {};
    for (auto& p : volume.centers) p *= 1e-9;
    for (auto& frame : volume.frames) {
        for (float& s : frame) s *= 1e-18f;
    }
    volume.bounds = box_of(volume);
    expect_round_trip(volume, path("small.vdb"), 1.45e-5);
    for (auto& p : volume.centers) p = 1e18 * p + Vec3(1e9);
    volume.bounds = box_of(volume);
    expect_round_trip(volume, path("far.vdb"), 2e9 / (1 << 30));
    expect_round_trip(random_points(0, 2), path("none.vdb"), 1);
}

// What Houdini reads: a few points per voxel; their instances of a unit sphere are the support ellipsoids.
TEST_F(VdbPoints, AttributesMeanWhatHoudiniTakesThemFor) {
    const RbfVolume volume = random_points(5000, 2);
    write_vdb_points(path("a.vdb"), volume, {.points_per_voxel = 4, .creator = "a test"});
    const auto grid = open_grid(path("a.vdb"));
    EXPECT_EQ(grid->getCreator(), "a test");
    EXPECT_EQ(grid->metaValue<std::string>("kernel"), to_json(volume.kernel));
    EXPECT_EQ(grid->metaValue<std::string>("channel_1"), volume.channels[1].name);
    EXPECT_EQ(openvdb::points::pointCount(grid->tree()), volume.size());
    std::set<std::string> names;
    for (const auto& [name, at] : grid->tree().cbeginLeaf()->attributeSet().descriptor().map()) names.insert(name);
    EXPECT_EQ(names, (std::set<std::string>{"P", "id", "frame", "orient", "scale", "pscale", "density", "density_gradient",
                                            "density_moment", "Temp___K________", "Temp___K_________gradient",
                                            "Temp___K_________moment", "Temp___K_________hessian"}));
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        using namespace openvdb;
        const points::AttributeHandle<Quats> orient(leaf->constAttributeArray("orient"));
        const points::AttributeHandle<Vec3f> scale(leaf->constAttributeArray("scale"));
        const points::AttributeHandle<float> pscale(leaf->constAttributeArray("pscale"));
        const points::AttributeHandle<Mat3s> frame(leaf->constAttributeArray("frame"));
        for (auto i = leaf->beginIndexOn(); i; ++i) {
            const Quats turn = orient.get(*i);
            const Quatd rotation(turn.x(), turn.y(), turn.z(), turn.w());
            std::array<Vec3d, 3> axes;
            for (int k = 0; k < 3; ++k) {
                Vec3d axis(0.0);
                axis[k] = static_cast<double>(pscale.get(*i) * scale.get(*i)[k]);
                axes[static_cast<std::size_t>(k)] = rotation.rotateVector(axis);
            }
            const double largest = static_cast<double>(frame.get(*i).trace());
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c) {
                    double sum = 0;
                    for (const Vec3d& axis : axes) sum += axis[r] * axis[c];
                    // The quaternion, scale and pscale are floats: some 2⁻²³ each.
                    ASSERT_NEAR(sum, static_cast<double>(frame.get(*i)(r, c)), 2e-6 * largest);
                }
            }
        }
    }
}

TEST_F(VdbPoints, DeletedPointsLeaveTheOthersInOrder) {
    const RbfVolume volume = random_points(100, 1);
    write_vdb_points(path("a.vdb"), volume);
    const auto grid = open_grid(path("a.vdb"));
    const auto leaf = grid->tree().beginLeaf();
    const auto gone = static_cast<std::size_t>(leaf->pointCount());
    grid->tree().addTile(1, leaf->origin(), 0, /*active=*/false);  // replaces the leaf
    openvdb::io::File(path("a.vdb").string()).write({grid});
    const RbfVolume read = read_vdb_points(path("a.vdb"));
    ASSERT_EQ(read.size(), volume.size() - gone);
    std::size_t from = 0;
    for (std::size_t i = 0; i < read.size(); ++i) {
        while (from < volume.size() && volume.frames[from] != read.frames[i]) ++from;
        ASSERT_LT(from, volume.size()) << "in the old order";
    }
}

TEST_F(VdbPoints, HessiansOfSomePointsOnlyAreRefused) {
    RbfVolume volume = random_points(5000, 2);
    write_vdb_points(path("a.vdb"), volume);
    volume.channels[1].hessians.clear();
    write_vdb_points(path("b.vdb"), volume);
    const auto with = open_grid(path("a.vdb")), without = open_grid(path("b.vdb"));
    ASSERT_GT(with->tree().leafCount(), 1u);
    using Leaf = openvdb::points::PointDataGrid::TreeType::LeafNodeType;
    const openvdb::Coord origin = with->tree().cbeginLeaf()->origin();
    with->tree().addLeaf(without->tree().stealNode<Leaf>(origin, 0, /*active=*/false));
    openvdb::io::File(path("c.vdb").string()).write({with});
    EXPECT_THAT(error_of([&] { static_cast<void>(read_vdb_points(path("c.vdb"))); }),
                HasSubstr("does not have one Hessian per point"));
}

TEST_F(VdbPoints, OtherFilesAreRefused) {
    const auto error_of_reading = [&](const std::string& name) {
        return error_of([&] { static_cast<void>(read_vdb_points(path(name))); });
    };
    openvdb::initialize();
    const auto floats = openvdb::FloatGrid::create();
    floats->setName("density");
    floats->tree().setValue(openvdb::Coord(1, 2, 3), 4);
    openvdb::io::File(path("floats.vdb").string()).write(openvdb::GridCPtrVec{floats});
    EXPECT_FALSE(holds_vdb_points(path("floats.vdb")));
    EXPECT_THAT(error_of_reading("floats.vdb"), HasSubstr("holds no point grid (it holds: Tree_float"));

    const auto bare = openvdb::points::createPointDataGrid<openvdb::points::NullCodec, openvdb::points::PointDataGrid>(
        std::vector<openvdb::Vec3f>{{1, 2, 3}}, *openvdb::math::Transform::createLinearTransform(1.0));
    openvdb::io::File(path("bare.vdb").string()).write(openvdb::GridCPtrVec{floats, bare});
    EXPECT_TRUE(holds_vdb_points(path("bare.vdb")));
    EXPECT_EQ(read_vdb(path("bare.vdb")).size(), 1u);
    EXPECT_THAT(error_of_reading("bare.vdb"), HasSubstr("bare.vdb: has no points in this library's layout"));

    write("garbage.vdb", "not a grid");
    EXPECT_THAT(error_of_reading("garbage.vdb"), HasSubstr("is not a whole OpenVDB file"));
    EXPECT_THAT(error_of([&] { static_cast<void>(holds_vdb_points(path("garbage.vdb"))); }), HasSubstr("garbage.vdb"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_vdb_points(path("none.vdb"))); }, ErrorCode::Io), HasSubstr("none.vdb"));
}

TEST_F(VdbPoints, CutOffFilesAreRefused) {
    write_vdb_points(path("a.vdb"), random_points(200, 1));
    const std::string whole = read_bytes(path("a.vdb"));
    constexpr std::size_t kCuts = 97;
    for (std::size_t cut = 0; cut < kCuts; ++cut) {
        const auto file = write("cut.vdb", whole.substr(0, whole.size() * cut / kCuts));
        ASSERT_THAT(error_of([&] { static_cast<void>(read_vdb_points(file)); }), HasSubstr("cut.vdb")) << cut;
    }
}

// The damage must not bring OpenVDB beyond its buffers, which the sanitizers would see, and it prints nothing.
TEST_F(VdbPoints, DamagedFilesAreReadOrRefused) {
    write_vdb_points(path("a.vdb"), random_points(60, 1));
    const std::string whole = read_bytes(path("a.vdb"));
    std::mt19937 random(5);
    const int runs = run_count();
    int refused = 0;
    testing::internal::CaptureStderr();
    for (int run = 0; run < runs; ++run) {
        const auto file = write("damaged.vdb", mutated(whole, random));
        try {
            validate(read_vdb_points(file));
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(printable(error.what()), error.what());
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_GT(refused, runs / 4);
}

TEST_F(VdbPoints, AForeignBoundaryIsRefused) {
    RbfVolume volume = random_points(20, 1);
    write_vdb_points(path("a.vdb"), volume);
    volume.boundary.triangles.pop_back();
    write_points(path("a.vtp"), volume);
    EXPECT_THAT(error_of([&] { static_cast<void>(read_vdb_points(path("a.vdb"))); }), HasSubstr("a.boundary.vtp: has 3"));
    std::filesystem::remove(path("a.boundary.vtp"));
    EXPECT_TRUE(read_vdb_points(path("a.vdb")).boundary.triangles.empty());
}

TEST_F(VdbPoints, WhatCannotBeWrittenLeavesNothing) {
    const RbfVolume volume = random_points(3000, 1);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{20000, before.rlim_max};  // simulates a full disk
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    EXPECT_THAT(error_of([&] { write_vdb_points(path("a.vdb"), volume); }, ErrorCode::Io),
                HasSubstr("a.vdb: cannot be written"));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(file_count(), 0u);
    std::filesystem::create_directory(path("a.boundary.vtp"));
    EXPECT_THAT(error_of([&] { write_vdb_points(path("a.vdb"), volume); }, ErrorCode::Io), HasSubstr("is a folder"));
    EXPECT_EQ(file_count(), 1u);
}

}  // namespace vdb_points_test

}  // namespace subvol::test
