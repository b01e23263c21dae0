// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_io.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "subvol/error.h"

namespace subvol {
namespace image_io_test {

namespace fs = std::filesystem;

class ImageIo : public ::testing::Test {
protected:
    ImageIo() : folder_(fs::temp_directory_path() / ("subvol_image_io_" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~ImageIo() override { fs::remove_all(folder_); }

    [[nodiscard]] bool folder_is_empty() const { return fs::is_empty(folder_); }

    fs::path folder_;
};

template <class Call>
ErrorCode code_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "no error was thrown";
    return ErrorCode::Cancelled;
}

Image random_image(int width, int height) {
    std::mt19937 random(7);
    Image image(width, height);
    for (float& v : image.rgba) v = static_cast<float>(static_cast<double>(random()) / 4294967295.0);
    return image;
}

Image uniform_image(const Vec3& rgb, float alpha) {
    Image image(4, 3);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto pixel = image.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(rgb[static_cast<int>(c)]);
            pixel[3] = alpha;
        }
    }
    return image;
}

std::vector<unsigned char> bytes_of(const fs::path& path) {
    const auto input = OIIO::ImageInput::open(path.string());
    EXPECT_TRUE(input);
    const auto& spec = input->spec();
    EXPECT_EQ(spec.nchannels, 3);
    std::vector<unsigned char> bytes(static_cast<std::size_t>(spec.width * spec.height * spec.nchannels));
    EXPECT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, bytes.data()));
    return bytes;
}

// The formula again, written from the standard, so that the library is not tested with its own code.
double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

TEST_F(ImageIo, TheTimeOfWritingIsNotInTheFile) {
    const Image image = random_image(5, 3);
    for (const char* ending : {".exr", ".png"}) {
        const fs::path path = folder_ / ("a" + std::string(ending));
        write_image(path, image);
        const auto input = OIIO::ImageInput::open(path.string());
        ASSERT_TRUE(input);
        EXPECT_EQ(input->spec().get_string_attribute("DateTime"), "") << ending;
    }
}

TEST_F(ImageIo, InfinityIsWhiteAndNoNumberIsBlack) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Image image(5, 1);
    for (int x = 0; x < 5; ++x) {
        const auto pixel = image.pixel(x, 0);
        const float value = std::array{infinity, nan, 3e38f, -1.0f, -infinity}[static_cast<std::size_t>(x)];
        pixel[0] = pixel[1] = pixel[2] = value;
        pixel[3] = 1;
    }
    const std::vector<std::uint8_t> expected{255, 255, 255, 0, 0, 0, 255, 255, 255, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(srgb_bytes(image), expected);
    EXPECT_EQ(srgb_bytes(image, Vec3(0.5)), expected);  // opaque: the background does not show
    write_image(folder_ / "a.png", image);
    EXPECT_EQ(bytes_of(folder_ / "a.png"), expected);
}

TEST_F(ImageIo, ExrKeepsEveryBit) {
    Image image = random_image(37, 21);
    image.rgba[0] = -3.5f;
    image.rgba[1] = 1e30f;
    image.rgba[2] = 1e-40f;
    write_image(folder_ / "a.exr", image);
    const Image read = read_image(folder_ / "a.exr");
    EXPECT_EQ(read.width, 37);
    EXPECT_EQ(read.height, 21);
    EXPECT_EQ(read.rgba, image.rgba);
}

TEST_F(ImageIo, ExrCarriesDepthAsAFifthChannel) {
    const Image image = random_image(7, 5);
    std::vector<float> depth(35, std::numeric_limits<float>::infinity());
    depth[3] = 1.25f;
    depth[34] = 1e9f;
    const fs::path path = folder_ / "a.exr";
    write_image(path, image, Vec3(0.0), depth);
    EXPECT_EQ(read_image(path).rgba, image.rgba);

    const auto input = OIIO::ImageInput::open(path.string());
    ASSERT_TRUE(input);
    const OIIO::ImageSpec& spec = input->spec();
    ASSERT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B", "A", "Z"}));
    EXPECT_EQ(spec.z_channel, 4);
    EXPECT_EQ(spec.channelformat(4), OIIO::TypeDesc::FLOAT);
    std::vector<float> read(35);
    ASSERT_TRUE(input->read_image(0, 0, 4, 5, OIIO::TypeDesc::FLOAT, read.data()));
    EXPECT_EQ(read, depth);
}

TEST_F(ImageIo, PngTakesNoDepthAndNoFileTakesTooFew) {
    const Image image = random_image(4, 2);
    const std::vector<float> depth(8, 1.0f), few(7, 1.0f);
    write_image(folder_ / "with.png", image, Vec3(0.0), depth);
    write_image(folder_ / "without.png", image);
    EXPECT_EQ(bytes_of(folder_ / "with.png"), bytes_of(folder_ / "without.png"));
    EXPECT_EQ(code_of([&] { write_image(folder_ / "few.exr", image, Vec3(0.0), few); }), ErrorCode::InvalidInput);
    EXPECT_FALSE(fs::exists(folder_ / "few.exr"));
}

TEST_F(ImageIo, PngIsRoundedSrgb) {
    Image image = random_image(64, 16);
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1.0f;
    write_image(folder_ / "a.png", image);
    const Image read = read_image(folder_ / "a.png");
    ASSERT_EQ(read.rgba.size(), image.rgba.size());
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
        // Half a step of 1/255, and a little for rounding to floats.
        ASSERT_NEAR(srgb(static_cast<double>(read.rgba[i])), srgb(static_cast<double>(image.rgba[i])), 0.501 / 255);
    }
}

TEST_F(ImageIo, MiddleGreyAndTheEnds) {
    const auto byte_of = [&](double grey) {
        write_image(folder_ / "grey.png", uniform_image(Vec3(grey), 1.0f));
        return static_cast<int>(bytes_of(folder_ / "grey.png").front());
    };
    EXPECT_EQ(byte_of(0.5), 188);
    EXPECT_EQ(byte_of(0.0), 0);
    EXPECT_EQ(byte_of(1.0), 255);
    EXPECT_EQ(byte_of(7.0), 255);
    EXPECT_EQ(byte_of(-1.0), 0);
    EXPECT_EQ(byte_of(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST_F(ImageIo, PngLiesOverTheBackground) {
    // Premultiplied: .25 of its own light, plus half of the background's.
    write_image(folder_ / "a.PNG", uniform_image(Vec3(0.25, 0.0, 0.25), 0.5f), Vec3(0.5, 1.0, 0.0));
    const auto bytes = bytes_of(folder_ / "a.PNG");
    EXPECT_EQ(bytes[0], 188);                            // .25 + .5 · .5
    EXPECT_EQ(bytes[1], 188);                            // 0 + .5 · 1
    EXPECT_EQ(bytes[2], std::lround(255 * srgb(0.25)));  // .25 + .5 · 0
}

TEST_F(ImageIo, BytesAreThoseOfThePng) {
    const Image image = random_image(6, 4);
    write_image(folder_ / "a.png", image, Vec3(0.2, 0.4, 0.6));
    EXPECT_EQ(srgb_bytes(image, Vec3(0.2, 0.4, 0.6)), bytes_of(folder_ / "a.png"));
}

TEST_F(ImageIo, ForeignPngIsPremultipliedInLinearLight) {
    OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const auto output = OIIO::ImageOutput::create((folder_ / "a.png").string());
    const std::array<unsigned char, 4> pixel{188, 255, 0, 51};
    ASSERT_TRUE(output->open((folder_ / "a.png").string(), spec) && output->write_image(OIIO::TypeDesc::UINT8, pixel.data()) &&
                output->close());
    const Image read = read_image(folder_ / "a.png");
    // 188 is .5 up to half a step, which is .002 in linear light there, and a fifth of that after alpha.
    EXPECT_NEAR(read.rgba[0], 0.5 * 0.2, 0.001);
    EXPECT_NEAR(read.rgba[1], 0.2, 1e-6);
    EXPECT_EQ(read.rgba[2], 0.0f);
    EXPECT_NEAR(read.rgba[3], 0.2, 1e-6);
}

TEST_F(ImageIo, GreyFilesBecomeColours) {
    const auto output = OIIO::ImageOutput::create((folder_ / "grey.png").string());
    const unsigned char pixel = 188;
    ASSERT_TRUE(output->open((folder_ / "grey.png").string(), OIIO::ImageSpec(1, 1, 1, OIIO::TypeDesc::UINT8)) &&
                output->write_image(OIIO::TypeDesc::UINT8, &pixel) && output->close());
    const Image read = read_image(folder_ / "grey.png");
    EXPECT_NEAR(read.rgba[0], 0.5, 0.003);
    EXPECT_EQ(read.rgba[0], read.rgba[1]);
    EXPECT_EQ(read.rgba[0], read.rgba[2]);
    EXPECT_EQ(read.rgba[3], 1.0f);
}

TEST_F(ImageIo, RefusesWithoutLeavingAFile) {
    const Image image(2, 2);
    EXPECT_EQ(code_of([&] { write_image(folder_ / "a.xyz", image); }), ErrorCode::InvalidInput);
    EXPECT_EQ(code_of([&] { write_image(folder_ / "a", image); }), ErrorCode::InvalidInput);
    EXPECT_EQ(code_of([&] { write_image(folder_ / "a.exr", Image()); }), ErrorCode::InvalidInput);
    EXPECT_EQ(code_of([&] { write_image(folder_ / "none" / "a.exr", image); }), ErrorCode::Io);
    Image torn = image;
    torn.rgba.pop_back();
    EXPECT_EQ(code_of([&] { write_image(folder_ / "a.png", torn); }), ErrorCode::InvalidInput);
    EXPECT_TRUE(folder_is_empty());
}

/// During its lifetime, files cannot grow beyond this many bytes, as on a full disk.
class SmallDisk {
public:
    explicit SmallDisk(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit small{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

private:
    rlimit before_{};
    void (*signal_)(int);
};

TEST_F(ImageIo, AFullDiskIsAnErrorAndLeavesNothing) {
    const Image image = random_image(64, 64);  // noise: at least 12 KB in either format
    for (const rlim_t room : {rlim_t{0}, rlim_t{100}, rlim_t{8192}}) {
        for (const char* name : {"a.png", "a.exr"}) {
            const SmallDisk disk(room);
            EXPECT_EQ(code_of([&] { write_image(folder_ / name, image); }), ErrorCode::Io) << name << " in " << room;
            EXPECT_TRUE(folder_is_empty()) << name << " in " << room;
        }
    }
}

TEST_F(ImageIo, RefusesWhatIsNoImage) {
    EXPECT_EQ(code_of([&] { (void)read_image(folder_ / "none.png"); }), ErrorCode::Io);
    EXPECT_EQ(code_of([&] { (void)read_image(folder_); }), ErrorCode::Io);
    for (const char* name : {"a.png", "a.exr", "a.txt"}) {
        std::ofstream(folder_ / name) << "this is no image";
        EXPECT_EQ(code_of([&] { (void)read_image(folder_ / name); }), ErrorCode::InvalidInput) << name;
    }
}

/// The bytes of a chunk of a .png: its length, kind, content and checksum.
std::string chunk(const std::string& kind, const std::string& content) {
    const auto word = [](std::uint32_t value) {
        std::string bytes;
        for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
        return bytes;
    };
    std::uint32_t sum = 0xffffffff;
    for (const char c : kind + content) {
        sum ^= static_cast<std::uint8_t>(c);
        for (int k = 0; k < 8; ++k) sum = sum >> 1 ^ (0xedb88320 & (0 - (sum & 1)));
    }
    return word(static_cast<std::uint32_t>(content.size())) + kind + content + word(~sum);
}

TEST_F(ImageIo, AHeaderThatPromisesTooMuchTakesNoMemory) {
    const std::string size("\0\0\x40\0", 4);  // 16384
    std::ofstream(folder_ / "a.png", std::ios::binary)
        << "\x89PNG\r\n\x1a\n"
        << chunk("IHDR", size + size + std::string("\x08\x02\0\0\0", 5))
        << chunk("IDAT", std::string("\x78\x9c\x03\0\0\0\0\x01", 8)) << chunk("IEND", "");
    try {
        (void)read_image(folder_ / "a.png");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("16384 × 16384 pixels, too many for its few bytes"), std::string::npos)
            << error.what();
    }
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    EXPECT_LT(used.ru_maxrss, 1'000'000) << "kilobytes; the pixels would take three times as much";
}

TEST_F(ImageIo, CutOffFilesAreRefused) {
    for (const char* name : {"a.png", "a.exr"}) {
        write_image(folder_ / name, random_image(64, 64));
        fs::resize_file(folder_ / name, fs::file_size(folder_ / name) / 2);
        EXPECT_EQ(code_of([&] { (void)read_image(folder_ / name); }), ErrorCode::InvalidInput) << name;
    }
}

}  // namespace image_io_test
}  // namespace subvol
