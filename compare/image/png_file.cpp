// SPDX-License-Identifier: Apache-2.0
#include "png_file.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace subvol::detail {

std::optional<PictureFault> write_png(const std::string& path, int width, int height, std::span<const std::uint8_t> rgb) {
    const auto failed = [](int error) {
        return PictureFault{ErrorCode::Io, "cannot be written: " + std::generic_category().message(error)};
    };
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(path.c_str(), "wb"), &std::fclose);
    if (!stream) return failed(errno);
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = static_cast<png_uint_32>(width);
    picture.height = static_cast<png_uint_32>(height);
    picture.format = PNG_FORMAT_RGB;
    errno = 0;
    if (png_image_write_to_stdio(&picture, stream.get(), 0, rgb.data(), 0, nullptr) == 0) {
        if (errno != 0) return failed(errno);
        return PictureFault{ErrorCode::Io, std::string("cannot be written: ") + picture.message};
    }
    if (std::fclose(stream.release()) != 0) return failed(errno);
    return {};
}

}  // namespace subvol::detail
