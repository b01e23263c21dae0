// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "subvol/detail/atomic_file.h"
#include "subvol/error.h"
#include "subvol/srgb.h"

namespace subvol {

using namespace detail;

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;  // 4 GB as float RGBA

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

void check_image(const Image& image) {
    const auto width = static_cast<std::size_t>(std::max(image.width, 0));
    const auto height = static_cast<std::size_t>(std::max(image.height, 0));
    if (width == 0 || height == 0) throw Error(ErrorCode::InvalidInput, "the image has no pixels");
    if (image.rgba.size() != 4 * width * height) {
        throw Error(ErrorCode::InvalidInput, "the image's values do not match its size");
    }
}

std::uint8_t encoded_byte(double linear) {
    if (!(linear > 0)) return 0;  // NaN too
    return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(std::min(linear, 1.0))));
}

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw Error(ErrorCode::Io, "cannot be written: " + why, path.string());
}

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// When memory is short, OpenImageIO may leave a picture unfinished without reporting an error.
bool is_whole(const fs::path& path, const OIIO::ImageSpec& spec) {
    const auto input = OIIO::ImageInput::open(path.string());
    std::vector<float> row(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
    return input && input->read_scanline(spec.height - 1, 0, OIIO::TypeDesc::FLOAT, row.data());
}

void write_pixels(const fs::path& path, const OIIO::ImageSpec& spec, const void* pixels) {
    AtomicFile file(path);
    // OpenImageIO does not report a full disk when it writes .png; the stream does.
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.path().c_str(), "wb"), &std::fclose);
    if (!stream) fail(path, std::generic_category().message(errno));
    OIIO::Filesystem::IOFile proxy(stream.get(), OIIO::Filesystem::IOProxy::Write);
    const auto output = OIIO::ImageOutput::create(file.path().string(), &proxy);
    if (!output) {
        const std::string said = OIIO::geterror();
        throw Error(ErrorCode::MissingCapability, said.empty() ? "cannot be written; memory may be short" : said,
                    path.string());
    }
    const bool written =
        output->open(file.path().string(), spec) && output->write_image(spec.format, pixels) && output->close();
    const bool failed = std::ferror(stream.get()) != 0;
    if (!written && failed) fail(path, first_line(output->geterror()));
    if (!written)
        throw Error(ErrorCode::MissingCapability, "cannot be written: " + first_line(output->geterror()), path.string());
    if (std::fclose(stream.release()) != 0) fail(path, std::generic_category().message(errno));
    if (failed) fail(path, "the disk is full, or the file is too large");
    if (!is_whole(file.path(), spec)) {
        throw Error(ErrorCode::MissingCapability, "was not written completely; memory may be short", path.string());
    }
    file.commit();
}

void write_exr(const fs::path& path, const Image& image, std::span<const float> depth) {
    OIIO::ImageSpec spec(image.width, image.height, depth.empty() ? 4 : 5, OIIO::TypeDesc::FLOAT);
    spec.attribute("DateTime", "");  // otherwise the time of writing: the same picture must give the same file
    if (depth.empty()) return write_pixels(path, spec, image.rgba.data());
    spec.channelnames = {"R", "G", "B", "A", "Z"};
    spec.z_channel = 4;
    std::vector<float> pixels;
    pixels.reserve(5 * depth.size());
    for (std::size_t i = 0; i < depth.size(); ++i) {
        for (std::size_t c = 0; c < 4; ++c) pixels.push_back(image.rgba[4 * i + c]);
        pixels.push_back(depth[i]);
    }
    write_pixels(path, spec, pixels.data());
}

std::unique_ptr<OIIO::ImageInput> open_image(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) throw Error(ErrorCode::Io, "cannot be read: no such file", path.string());
    // Otherwise OpenImageIO premultiplies encoded values; alpha applies to linear light, after decoding.
    OIIO::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(path.string(), &wish);
    if (!input) throw Error(ErrorCode::InvalidInput, "is not an image: " + OIIO::geterror(), path.string());
    const auto& spec = input->spec();
    const bool proper = spec.width > 0 && spec.height > 0 && spec.depth <= 1 && spec.nchannels > 0 && !spec.deep &&
                        static_cast<std::int64_t>(spec.width) * spec.height <= kMaxPixels;
    if (!proper) throw Error(ErrorCode::InvalidInput, "is not a flat picture of at most 2^28 pixels", path.string());
    return input;
}

// Which of a file's first four channels are red, green, blue and alpha (-1: opaque); a file with one or two colours is grey.
std::array<int, 4> channels_of(const OIIO::ImageSpec& spec, int count) {
    const int alpha = spec.alpha_channel < count ? spec.alpha_channel : -1;
    std::vector<int> colors;
    for (int c = 0; c < count; ++c) {
        if (c != alpha) colors.push_back(c);
    }
    if (colors.empty()) return {alpha, alpha, alpha, alpha};
    if (colors.size() < 3) return {colors[0], colors[0], colors[0], alpha};
    return {colors[0], colors[1], colors[2], alpha};
}

Image linear_image(const OIIO::ImageSpec& spec, const std::vector<float>& pixels, int count) {
    const auto channels = channels_of(spec, count);
    const bool encoded = !spec.format.is_floating_point();
    const bool unassociated = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    Image image(spec.width, spec.height);
    for (std::size_t i = 0; i < image.rgba.size() / 4; ++i) {
        const float* pixel = pixels.data() + i * static_cast<std::size_t>(count);
        float* rgba = image.rgba.data() + 4 * i;
        rgba[3] = channels[3] < 0 ? 1.0f : pixel[channels[3]];
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = pixel[channels[c]];
            rgba[c] = encoded ? static_cast<float>(linear_from_srgb(static_cast<double>(value))) : value;
            if (unassociated && channels[3] >= 0) rgba[c] *= rgba[3];
        }
    }
    return image;
}

}  // namespace

std::vector<std::uint8_t> srgb_bytes(const Image& image, const Vec3& background) {
    check_image(image);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const double through = 1.0 - static_cast<double>(image.rgba[i + 3]);
        for (std::size_t c = 0; c < 3; ++c) {
            const double over = static_cast<double>(image.rgba[i + c]) + through * background[static_cast<int>(c)];
            bytes.push_back(encoded_byte(over));
        }
    }
    return bytes;
}

void write_image(const fs::path& path, const Image& image, const Vec3& background, std::span<const float> depth) {
    check_image(image);
    if (!depth.empty() && 4 * depth.size() != image.rgba.size()) {
        throw Error(ErrorCode::InvalidInput, "the number of depths is not the number of pixels", path.string());
    }
    const std::string extension = extension_of(path);
    if (extension == ".exr") {
        write_exr(path, image, depth);
    } else if (extension == ".png") {
        OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("oiio:ColorSpace", "sRGB");
        write_pixels(path, spec, srgb_bytes(image, background).data());
    } else {
        throw Error(ErrorCode::InvalidInput, "images are not written as \"" + extension + "\" files", path.string(),
                    ".exr or .png");
    }
}

Image read_image(const fs::path& path) {
    const auto input = open_image(path);
    const OIIO::ImageSpec& spec = input->spec();
    const int count = std::min(spec.nchannels, 4);
    std::vector<float> pixels(static_cast<std::size_t>(count) * static_cast<std::size_t>(spec.width) *
                              static_cast<std::size_t>(spec.height));
    if (!input->read_image(0, 0, 0, count, OIIO::TypeDesc::FLOAT, pixels.data())) {
        throw Error(ErrorCode::InvalidInput, "is not a complete image: " + input->geterror(), path.string());
    }
    return linear_image(spec, pixels, count);
}

}  // namespace subvol
