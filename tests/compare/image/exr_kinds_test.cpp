// SPDX-License-Identifier: Apache-2.0
// Files in .exr that other programs write, and damaged ones.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "subvol/error.h"
#include "subvol/image_io.h"

namespace subvol {
namespace exr_kinds_test {

namespace fs = std::filesystem;

class ExrKinds : public ::testing::Test {
protected:
    ExrKinds() : folder_(fs::temp_directory_path() / ("subvol_exr_kinds_" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~ExrKinds() override { fs::remove_all(folder_); }

    /// Values that half floats hold exactly.
    [[nodiscard]] static std::vector<float> values(const OIIO::ImageSpec& spec) {
        std::vector<float> values;
        const int count = spec.width * spec.height * spec.nchannels;
        for (int i = 0; i < count; ++i) values.push_back(static_cast<float>(i % 257) / 256);
        return values;
    }

    [[nodiscard]] Image written_and_read(const OIIO::ImageSpec& spec) const {
        const fs::path path = folder_ / "a.exr";
        const auto output = OIIO::ImageOutput::create(path.string());
        EXPECT_TRUE(output && output->open(path.string(), spec));
        EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values(spec).data()) && output->close());
        return read_image(path);
    }

    /// channels: the file's channel of each of red, green, blue and alpha; -1: 1
    void expect_same(const Image& read, const OIIO::ImageSpec& spec, const std::array<int, 4>& channels) const {
        ASSERT_EQ(read.width, spec.width);
        ASSERT_EQ(read.height, spec.height);
        const std::vector<float> expected = values(spec);
        const auto count = static_cast<std::size_t>(spec.nchannels);
        for (std::size_t i = 0; i < expected.size() / count; ++i) {
            for (std::size_t c = 0; c < 4; ++c) {
                const float value = channels[c] < 0 ? 1 : expected[i * count + static_cast<std::size_t>(channels[c])];
                ASSERT_EQ(read.rgba[4 * i + c], value) << "pixel " << i << ", channel " << c;
            }
        }
    }

    fs::path folder_;
};

TEST_F(ExrKinds, HalvesFloatsAndPackings) {
    for (const int channels : {3, 4}) {
        for (const auto format : {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT}) {
            for (const char* packing : {"none", "rle", "zip", "zips", "piz"}) {
                OIIO::ImageSpec spec(19, 41, channels, format);
                spec.attribute("compression", packing);
                expect_same(written_and_read(spec), spec, {0, 1, 2, channels == 4 ? 3 : -1});
            }
        }
    }
}

TEST_F(ExrKinds, WhatOpenExrLeavesToOpenImageIo) {
    OIIO::ImageSpec tiled(40, 24, 4, OIIO::TypeDesc::FLOAT);
    tiled.tile_width = tiled.tile_height = 16;
    expect_same(written_and_read(tiled), tiled, {0, 1, 2, 3});
    OIIO::ImageSpec grey(8, 5, 1, OIIO::TypeDesc::HALF);
    grey.channelnames = {"Y"};
    expect_same(written_and_read(grey), grey, {0, 0, 0, -1});
    OIIO::ImageSpec more(8, 5, 6, OIIO::TypeDesc::FLOAT);
    more.channelnames = {"R", "G", "B", "A", "u", "v"};
    expect_same(written_and_read(more), more, {0, 1, 2, 3});
}

TEST_F(ExrKinds, AWindowOfALargerPictureHasThePixelsOfTheWindow) {
    OIIO::ImageSpec spec(12, 7, 4, OIIO::TypeDesc::FLOAT);
    spec.x = 5;
    spec.y = -3;
    spec.full_x = -2;
    spec.full_y = -4;
    spec.full_width = 64;
    spec.full_height = 48;
    expect_same(written_and_read(spec), spec, {0, 1, 2, 3});
}

TEST_F(ExrKinds, DamagedFilesAreRefusedOrReadAndNothingElse) {
    Image image(24, 20);
    for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = static_cast<float>(i * 7919 % 1009);
    const fs::path path = folder_ / "a.exr";
    write_image(path, image);
    std::ifstream in(path, std::ios::binary);
    const std::string sound((std::istreambuf_iterator<char>(in)), {});
    std::mt19937 dice(1);
    std::size_t refused = 0;
    for (int k = 0; k < 600; ++k) {
        std::string damaged = sound;
        const std::size_t among = k % 2 == 0 ? 400 : damaged.size();  // the header, or anywhere
        for (int n = 0; n <= k % 3; ++n) damaged[dice() % among] = static_cast<char>(dice());
        if (k % 10 == 0) damaged.resize(dice() % damaged.size());
        std::ofstream(path, std::ios::binary) << damaged;
        try {
            (void)read_image(path);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 100u);
}

}  // namespace exr_kinds_test
}  // namespace subvol
