// SPDX-License-Identifier: Apache-2.0
// What OpenVDB wrote passes the check of a file; what a file claims about its lengths does not reach OpenVDB unless it is so.
#include "vdb_check.h"

#include <gmock/gmock.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointGroup.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <sys/resource.h>
#include "openvdb_grids.h"

#include <cstring>
#include <optional>

#include "lib/temp_folder.h"
#include "subvol/detail/printable.h"
#include "subvol/vdb_grid.h"
#include "vdb/vdb_damage.h"

namespace subvol::test {

namespace vdb_check_test {

using namespace detail;
using openvdb::Coord;
using testing::HasSubstr;

class VdbCheck : public TempFolder {
protected:
    VdbCheck() { openvdb::initialize(); }

    [[nodiscard]] std::string bytes_of(const openvdb::GridCPtrVec& grids,
                                       std::uint32_t compression = openvdb::io::COMPRESS_BLOSC |
                                                                   openvdb::io::COMPRESS_ACTIVE_MASK) const {
        openvdb::io::File file(path("whole.vdb").string());
        file.setCompression(compression);
        file.write(grids);
        file.close();
        return read_bytes(path("whole.vdb"));
    }

    [[nodiscard]] std::string error_of_reading(const std::string& bytes) const {
        write("changed.vdb", bytes);
        return error_of([&] { static_cast<void>(read_vdb(path("changed.vdb"))); });
    }
};

/// Voxels in several leaves, and active and inactive tiles in every kind of node. value(i): one of many; spread: their count
template <class Grid, class Value>
typename Grid::Ptr grid_of(const std::string& name, const Value& value, int spread = 1000) {
    auto grid = Grid::create(value(0));
    grid->setName(name);
    std::mt19937 random(7);
    const auto any = [&] { return value(static_cast<int>(random() % static_cast<unsigned>(spread))); };
    auto& tree = grid->tree();
    for (int i = 0; i < 3000; ++i)
        tree.setValueOn(Coord(static_cast<int>(random() % 40), static_cast<int>(random() % 20), -5), any());
    for (int i = 0; i < 1000; ++i) tree.setValueOff(Coord(100 + static_cast<int>(random() % 16), i % 16, 3), any());
    tree.addTile(1, Coord(64, 64, 64), any(), true);
    tree.addTile(2, Coord(512, 0, 0), any(), false);
    tree.addTile(3, Coord(-4096, 8192, 0), any(), true);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    return grid;
}

openvdb::FloatGrid::Ptr floats(const std::string& name, int spread = 1000) {
    return grid_of<openvdb::FloatGrid>(
        name, [](int i) { return 0.37f * static_cast<float>(i); }, spread);
}

openvdb::points::PointDataGrid::Ptr some_points(int count) {
    std::mt19937 random(3);
    std::vector<openvdb::Vec3d> places;
    for (int i = 0; i < count; ++i) {
        const auto at = [&] { return 30.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()); };
        places.emplace_back(at(), at(), at());
    }
    using namespace openvdb::points;
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    auto grid = createPointDataGrid<FixedPointCodec<true>, PointDataGrid>(places, *transform);
    appendAttribute<float>(grid->tree(), "same", 2.5f);
    appendAttribute<openvdb::Vec3s>(grid->tree(), "strided", openvdb::Vec3s(1), /*stride=*/3);
    appendAttribute<float, TruncateCodec>(grid->tree(), "short");
    appendAttribute<std::int64_t>(grid->tree(), "many");
    for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
        AttributeWriteHandle<std::int64_t> many(leaf->attributeArray("many"));
        for (openvdb::Index i = 0; i < many.size(); ++i) many.set(i, static_cast<std::int64_t>(random()));
    }
    appendGroup(grid->tree(), "some");
    grid->setName("points");
    return grid;
}

openvdb::GridCPtrVec every_grid() {
    const auto half = floats("half");
    half->setSaveFloatAsHalf(true);
    const auto vectors = grid_of<openvdb::Vec3SGrid>("vectors", [](int i) { return openvdb::Vec3s(static_cast<float>(i)); });
    const auto half_vectors = vectors->deepCopy();
    half_vectors->setSaveFloatAsHalf(true);
    const auto mask = openvdb::MaskGrid::create();
    for (int i = 0; i < 100; ++i) mask->tree().setValueOn(Coord(i, 2 * i, 0));
    const auto fog = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5, openvdb::Vec3f(0), 0.4f);
    openvdb::GridCPtrVec grids{
        floats("floats"), half, floats("two values", 2), floats("three values", 3), vectors, half_vectors, mask, fog};
    grids.push_back(grid_of<openvdb::DoubleGrid>("doubles", [](int i) { return 0.1 * i; }));
    grids.push_back(grid_of<openvdb::Vec3DGrid>("vectors of doubles", [](int i) { return openvdb::Vec3d(i, 0, 1); }));
    grids.push_back(grid_of<openvdb::Vec3IGrid>("triples", [](int i) { return openvdb::Vec3i(i); }));
    grids.push_back(grid_of<openvdb::Int32Grid>("integers", [](int i) { return i; }));
    grids.push_back(grid_of<openvdb::Int64Grid>("long integers", [](int i) { return std::int64_t{i}; }));
    grids.push_back(grid_of<openvdb::BoolGrid>("booleans", [](int i) { return i % 2 == 1; }));
    const auto shared = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grids.front())->copyGrid();
    openvdb::ConstPtrCast<openvdb::GridBase>(shared)->setName("shares its tree with floats");
    grids.push_back(shared);
    const auto turned = floats("turned");
    turned->transform().postRotate(0.3, openvdb::math::X_AXIS);
    turned->transform().postTranslate({1, 2, 3});
    grids.push_back(turned);
    const auto frustum = floats("frustum");
    frustum->setTransform(openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {9, 9, 9}), 0.5, 10));
    grids.push_back(frustum);
    grids.push_back(openvdb::FloatGrid::create());
    grids.push_back(some_points(3000));
    grids.push_back(some_points(0));
    return grids;
}

std::vector<std::string> types_of(const openvdb::GridCPtrVec& grids) {
    std::vector<std::string> types;
    for (const auto& grid : grids) types.push_back(grid->type());
    return types;
}

TEST_F(VdbCheck, WhatOpenVdbWritesPasses) {
    using namespace openvdb::io;
    const openvdb::GridCPtrVec grids = every_grid();
    const std::vector<std::string> types = types_of(grids);
    for (const std::uint32_t packing : {COMPRESS_NONE, COMPRESS_ZIP, COMPRESS_BLOSC}) {
        for (const std::uint32_t mask : {0U, static_cast<unsigned>(COMPRESS_ACTIVE_MASK)}) {
            SCOPED_TRACE(compressionToString(packing | mask));
            static_cast<void>(bytes_of(grids, packing | mask));
            std::vector<std::string> found;
            for (const GridEntry& entry : checked_grids(path("whole.vdb"), types)) found.push_back(entry.type);
            EXPECT_EQ(found, types);
            EXPECT_EQ(read_vdb(path("whole.vdb")).size(), 9u);  // those of floats

            std::ofstream stream(path("stream.vdb"), std::ios::binary);
            Stream out(stream);
            out.setCompression(packing | mask);
            out.write(grids);
            stream.close();
            EXPECT_EQ(checked_grids(path("stream.vdb"), {}).size(), grids.size());
            EXPECT_EQ(read_vdb(path("stream.vdb")).size(), 9u);
        }
    }
}

TEST_F(VdbCheck, GridsThatShareATreeHaveTheSameVoxels) {
    const auto first = floats("first");
    const auto second = first->copyGrid();
    openvdb::ConstPtrCast<openvdb::GridBase>(second)->setName("second");
    static_cast<void>(bytes_of({first, second}));
    const auto read = read_vdb(path("whole.vdb"));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[1].report().name, "second");
    EXPECT_EQ(read[1].report().active_voxels, first->activeVoxelCount());
    for (int i = 0; i < 40; ++i) {
        const Vec3 voxel(0.25 * i, 1, -1.25);
        EXPECT_EQ(read[1].value(voxel), read[0].value(voxel)) << i;
    }
    EXPECT_TRUE(read[1].value({0, 0, -1.25}).has_value() || read[1].value({1, 1, -1.25}).has_value());
}

// OpenVDB asserts it when it makes a leaf.
TEST_F(VdbCheck, PointsOverABackgroundAreRefused) {
    const auto points = some_points(50);
    points->tree().root().setBackground(openvdb::PointDataIndex32(5), /*updateChildNodes=*/false);
    static_cast<void>(bytes_of({points}));
    const std::vector<std::string> types{points->type()};
    EXPECT_THAT(error_of([&] { static_cast<void>(checked_grids(path("whole.vdb"), types)); }),
                HasSubstr("a grid of points has the background 5 (0)"));
}

// A block that unpacks into the 512 floats of a leaf, as blosc's header says.
std::optional<std::size_t> find_block(const std::string& bytes) {
    for (std::size_t i = 0; i + 24 < bytes.size(); ++i) {
        std::int64_t size = 0;
        std::uint32_t raw = 0, packed = 0;
        std::memcpy(&size, &bytes[i], 8);
        std::memcpy(&raw, &bytes[i + 12], 4);
        std::memcpy(&packed, &bytes[i + 20], 4);
        if (size > 16 && size < 4096 && packed == size && raw == 2048) return i;
    }
    return std::nullopt;
}

TEST_F(VdbCheck, ABlockLongerThanItsBufferIsRefused) {
    const auto grid = openvdb::FloatGrid::create();
    grid->denseFill({Coord(0), Coord(31)}, 1, true);
    for (int i = 0; i < 32; ++i) grid->tree().setValue(Coord(i, i, i), static_cast<float>(i));
    const std::string whole = bytes_of({grid}, openvdb::io::COMPRESS_BLOSC);
    const auto at = find_block(whole);
    ASSERT_TRUE(at.has_value());
    for (const std::int64_t size : {std::int64_t{-60000}, std::int64_t{-2049}, std::int64_t{0},
                                    std::numeric_limits<std::int64_t>::min(), std::int64_t{1} << 40, std::int64_t{15}}) {
        std::string changed = whole;
        std::memcpy(&changed[*at], &size, sizeof size);
        EXPECT_THAT(error_of_reading(changed + std::string(70000, '\1')), HasSubstr("is not a whole OpenVDB file: at byte "))
            << size;
    }
    std::string changed = whole;
    const std::uint32_t raw = 1 << 20;  // what blosc's own header says
    std::memcpy(&changed[*at + 12], &raw, sizeof raw);
    EXPECT_THAT(error_of_reading(changed), HasSubstr("unpack into 1048576 (")) << "2048 are due";
}

// The lengths of the first name and of the first metadata, and the count of grids.
TEST_F(VdbCheck, AHugeLengthTakesNoMemory) {
    const std::string whole = bytes_of({floats("density")});
    const auto with_length_before = [&](const std::string& text) {
        std::string changed = whole;
        const std::size_t at = changed.find(text);
        const std::uint32_t huge = 0x7FFFFFFF;
        std::memcpy(&changed.at(at - 4), &huge, 4);
        return changed;
    };
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    for (const char* text : {"density", "Tree_float_5_4_3", "file_compression", "blosc + active values"}) {
        EXPECT_THAT(error_of_reading(with_length_before(text)), HasSubstr(" left)")) << text;
    }
    constexpr std::size_t kCount = 61;  // after the header of 57 bytes and a count of 0 metadata
    std::string many = whole;
    const std::int32_t grids = 0x7FFFFFFF;
    std::memcpy(&many[kCount], &grids, 4);
    EXPECT_THAT(error_of_reading(many), HasSubstr("a count of 2147483647 grids"));
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 << 10) << "KiB";
}

TEST_F(VdbCheck, NewerAndOlderFilesAreRefusedWithoutAWordOfOpenVdb) {
    std::string changed = bytes_of({floats("density")});
    for (const char version : {'\xE1', '\xDC'}) {
        changed[8] = version;
        testing::internal::CaptureStderr();
        EXPECT_THAT(error_of_reading(changed), HasSubstr("222 to 224 can be read"));
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    }
}

// The damage must not bring OpenVDB beyond its buffers (which the sanitizers would see), and it prints nothing.
TEST_F(VdbCheck, DamagedGridsAreReadOrRefused) {
    const int runs = run_count();
    std::mt19937 random(11);
    int refused = 0;
    testing::internal::CaptureStderr();
    for (const std::uint32_t compression : {0U, 3U, 6U}) {
        const auto small = openvdb::FloatGrid::create();
        small->setName("small");
        for (int i = 0; i < 50; ++i) small->tree().setValue(Coord(i), 0.7f * static_cast<float>(i * i));
        const std::string whole = bytes_of({small}, compression);
        for (int run = 0; run < runs; ++run) {
            write("damaged.vdb", mutated(whole, random));
            try {
                for (const VdbGrid& grid : read_vdb(path("damaged.vdb"))) static_cast<void>(grid.value({1, 2, 3}));
            } catch (const Error& error) {
                ++refused;
                EXPECT_THAT(std::string(error.what()), HasSubstr("damaged.vdb: "));
                EXPECT_EQ(printable(error.what()), error.what());
            }
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_GT(refused, runs / 2);
}

}  // namespace vdb_check_test

}  // namespace subvol::test
