// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <sys/resource.h>
#include <unistd.h>
#include "openvdb_grids.h"

#include <csignal>
#include <filesystem>
#include <fstream>

#include "subvol/error.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace vdb_file_test {

namespace fs = std::filesystem;
using namespace test;

class VdbFile : public ::testing::Test {
protected:
    VdbFile() : folder_(fs::temp_directory_path() / ("subvol_vdb_" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~VdbFile() override { fs::remove_all(folder_); }

    [[nodiscard]] std::size_t files_in_folder() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }

    fs::path folder_;
};

std::vector<VdbGrid> two_grids(bool half = false) {
    auto mesh = with_field(jittered_box_mesh(3), "heat", [](const Vec3& p) { return std::sin(9 * p.x) * p.y + p.z; });
    add_field(mesh, "stress", [](const Vec3& p) { return p.x - 2; });
    const std::vector<std::string> fields{"heat", "stress"};
    return rasterize(mesh, fields, {.voxel_size_world = 0.04, .half = half, .creator = "a test"});
}

ErrorCode code_of_read(const fs::path& path) {
    try {
        (void)read_vdb(path);
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "no error was thrown";
    return ErrorCode::Cancelled;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void expect_same_voxels(const VdbGrid& a, const VdbGrid& b, double relative_tolerance) {
    std::size_t compared = 0;
    for_each_centre(a.report().voxel_size_world, 30, [&](const Vec3& p) {
        const auto expected = a.value(p), actual = b.value(p);
        ASSERT_EQ(expected.has_value(), actual.has_value());
        if (!expected) return;
        ++compared;
        ASSERT_NEAR(*actual, *expected, relative_tolerance * std::abs(*expected));
    });
    EXPECT_EQ(compared, a.report().active_voxels);
}

TEST_F(VdbFile, RoundTrip) {
    const auto written = two_grids();
    write_vdb(folder_ / "a.vdb", written);
    const auto read = read_vdb(folder_ / "a.vdb");
    ASSERT_EQ(read.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read[i].report().name, written[i].report().name);
        EXPECT_EQ(read[i].report().active_voxels, written[i].report().active_voxels);
        EXPECT_EQ(read[i].report().voxel_size_world, 0.04);
        EXPECT_EQ(read[i].report().min, written[i].report().min);
        EXPECT_EQ(read[i].report().max, written[i].report().max);
        EXPECT_EQ(read[i].report().bounds.lower, written[i].report().bounds.lower);
        EXPECT_EQ(read[i].report().bounds.upper, written[i].report().bounds.upper);
        expect_same_voxels(written[i], read[i], 0.0);
    }
    EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(VdbFile, HalfKeepsElevenBits) {
    const auto written = two_grids(true);
    write_vdb(folder_ / "half.vdb", written);
    write_vdb(folder_ / "full.vdb", two_grids(false));
    EXPECT_LT(fs::file_size(folder_ / "half.vdb"), fs::file_size(folder_ / "full.vdb"));
    // Rounding to 11 bits is 2^-12 relative; the values of "stress" lie in [-2,-1], far from where halves get coarser.
    expect_same_voxels(written[1], read_vdb(folder_ / "half.vdb")[1], 0x1p-11);
}

TEST_F(VdbFile, SaysWhatItHolds) {
    write_vdb(folder_ / "a.vdb", two_grids(true));
    openvdb::io::File file((folder_ / "a.vdb").string());
    file.open(false);
    const auto heat = file.readGrid("heat"), stress = file.readGrid("stress");
    EXPECT_EQ(heat->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_EQ(stress->getGridClass(), openvdb::GRID_UNKNOWN);
    EXPECT_TRUE(heat->saveFloatAsHalf());
    EXPECT_EQ(heat->getCreator(), "a test");
    EXPECT_EQ(stress->metaValue<std::string>("subvol_field"), "stress");
    EXPECT_EQ(openvdb::gridConstPtrCast<openvdb::FloatGrid>(heat)->background(), 0.0f);
    EXPECT_TRUE(heat->transform() == *openvdb::math::Transform::createLinearTransform(0.04));
    EXPECT_TRUE(file.compression() & openvdb::io::COMPRESS_ACTIVE_MASK);
}

TEST_F(VdbFile, LeavesOtherTypesOut) {
    openvdb::initialize();
    const auto vectors = openvdb::Vec3SGrid::create();
    vectors->setName("velocity");
    vectors->tree().setValue(openvdb::Coord(1, 2, 3), openvdb::Vec3s(1));
    const auto floats = openvdb::FloatGrid::create();
    floats->setName("density");
    openvdb::io::File((folder_ / "both.vdb").string()).write(openvdb::GridCPtrVec{vectors, floats});
    openvdb::io::File((folder_ / "vectors.vdb").string()).write(openvdb::GridCPtrVec{vectors});

    const auto read = read_vdb(folder_ / "both.vdb");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].report().name, "density");
    EXPECT_EQ(code_of_read(folder_ / "vectors.vdb"), ErrorCode::InvalidInput);
}

TEST_F(VdbFile, MissingFolder) {
    try {
        write_vdb(folder_ / "none" / "a.vdb", two_grids());
        FAIL() << "no error was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Io);
    }
    EXPECT_EQ(files_in_folder(), 0u);
    EXPECT_EQ(code_of_read(folder_ / "none.vdb"), ErrorCode::Io);
    EXPECT_EQ(code_of_read(folder_), ErrorCode::Io);
}

TEST_F(VdbFile, FullDisk) {
    // A limit on the size of files simulates a full disk.
    const auto grids = two_grids();
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{20000, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    try {
        write_vdb(folder_ / "a.vdb", grids);
        ADD_FAILURE() << "no error was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Io);
    }
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(VdbFile, GarbageIsRefused) {
    const auto path = folder_ / "a.vdb";
    for (const std::string& garbage : {std::string(), std::string("not a grid"), std::string(100000, '\xff')}) {
        std::ofstream(path, std::ios::binary) << garbage;
        EXPECT_EQ(code_of_read(path), ErrorCode::InvalidInput);
    }
}

TEST_F(VdbFile, CutOffFilesAreRefused) {
    write_vdb(folder_ / "a.vdb", two_grids());
    const std::string whole = bytes_of(folder_ / "a.vdb");
    constexpr std::size_t kCuts = 97;
    for (std::size_t cut = 0; cut < kCuts; ++cut) {
        std::ofstream(folder_ / "cut.vdb", std::ios::binary) << whole.substr(0, whole.size() * cut / kCuts);
        ASSERT_EQ(code_of_read(folder_ / "cut.vdb"), ErrorCode::InvalidInput) << cut;
    }
}

}  // namespace vdb_file_test
}  // namespace subvol
