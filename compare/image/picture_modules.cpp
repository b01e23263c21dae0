// SPDX-License-Identifier: Apache-2.0
#include <png.h>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <system_error>

#include "image_difference.h"
#include "picture_modules.h"
#include "subvol/detail/module.h"
#include "subvol/oiio_compare.h"

namespace subvol {

const detail::OpenExr& detail::openexr() {
    using ModuleEntry = const OpenExr* (*)();
    static const OpenExr& functions =
        *reinterpret_cast<ModuleEntry>(load_module("openexr", "reading or writing .exr pictures"))();
    return functions;
}

using namespace detail;

const OpenImageIo& detail::openimageio() {
    using ModuleEntry = const OpenImageIo* (*)();
    static const OpenImageIo& functions =
        *reinterpret_cast<ModuleEntry>(load_module("openimageio", "reading or comparing pictures"))();
    return functions;
}

OiioMetrics compare_oiio(const Image& a, const Image& b, const OiioOptions& options) {
    check_comparable(a, b);
    return openimageio().compare(a, b, options);
}

std::size_t compare_yee(const Image& a, const Image& b, float luminance, float field_of_view_deg) {
    check_finite(a, b);
    return openimageio().compare_yee(a, b, luminance, field_of_view_deg);
}

}  // namespace subvol

namespace subvol::detail {

namespace {

png_image png_of(int width, int height, std::span<const std::uint8_t> bytes) {
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = static_cast<png_uint_32>(width);
    picture.height = static_cast<png_uint_32>(height);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    picture.format = bytes.size() == 4 * pixels ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    return picture;
}

}  // namespace

std::string encoded_png(int width, int height, std::span<const std::uint8_t> bytes) {
    png_image picture = png_of(width, height, bytes);
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(picture);
    std::string png(size, '\0');
    if (png_image_write_to_memory(&picture, png.data(), &size, 0, bytes.data(), 0, nullptr) == 0)
        throw std::bad_alloc();  // the only way to fail with room for all of it
    png.resize(size);
    return png;
}

std::optional<PictureFault> write_png(const std::string& path, int width, int height, std::span<const std::uint8_t> bytes) {
    const auto failed = [](int error) {
        return PictureFault{ErrorCode::Io, "cannot be written: " + std::generic_category().message(error)};
    };
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(path.c_str(), "wb"), &std::fclose);
    if (!stream) return failed(errno);
    png_image picture = png_of(width, height, bytes);
    errno = 0;
    if (png_image_write_to_stdio(&picture, stream.get(), 0, bytes.data(), 0, nullptr) == 0) {
        if (errno != 0) return failed(errno);
        return PictureFault{ErrorCode::Io, std::string("cannot be written: ") + picture.message};
    }
    if (std::fclose(stream.release()) != 0) return failed(errno);
    return {};
}

}  // namespace subvol::detail
