// SPDX-License-Identifier: Apache-2.0
// The module subvol_openimageio.so. OpenImageIO brings 250 libraries, which take a third of a second to load.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include "picture_modules.h"
#include "subvol/detail/picture_size.h"
#include "subvol/raster.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

constexpr const char* kNote = "subvolPart";

using Outcome = std::optional<PictureFault>;

/// Whether so few bytes can be a picture of that size: those of a plain colour, packed, are about a thousandth.
bool can_hold(const std::string& path, const OIIO::ImageSpec& spec) {
    constexpr std::uint64_t kAnyway = std::uint64_t{1} << 26, kMostTimes = 2000;
    std::error_code error;
    const std::uint64_t bytes = spec.image_bytes(true), of_file = std::filesystem::file_size(path, error);
    return error || bytes <= kAnyway || bytes / kMostTimes <= of_file;  // an error: of a stream
}

Outcome read(const std::string& path, DecodedPicture& picture) {
    // Otherwise OpenImageIO premultiplies encoded values; alpha applies to linear light, after decoding.
    OIIO::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open(path, &wish);
    if (!input) return PictureFault{ErrorCode::InvalidInput, "is not an image: " + OIIO::geterror()};
    const OIIO::ImageSpec& spec = input->spec();
    const bool proper = spec.width > 0 && spec.height > 0 && spec.depth <= 1 && spec.nchannels > 0 && !spec.deep &&
                        static_cast<std::int64_t>(spec.width) * spec.height <= kMostPixels;
    if (!proper) return PictureFault{ErrorCode::InvalidInput, "is not a flat picture of at most 2^28 pixels"};
    const bool small = static_cast<std::int64_t>(std::max(spec.width, spec.full_width)) * spec.full_height <= kMostPixels;
    if (!small) return PictureFault{ErrorCode::InvalidInput, "is part of a picture of more than 2^28 pixels"};
    if (!can_hold(path, spec)) {
        return PictureFault{ErrorCode::InvalidInput, "is said to have " + std::to_string(spec.width) + " × " +
                                                         std::to_string(spec.height) + " pixels, too many for its few bytes"};
    }
    picture.channels = std::min(spec.nchannels, 4);
    picture.alpha = spec.alpha_channel < picture.channels ? spec.alpha_channel : -1;
    picture.integers = !spec.format.is_floating_point();
    picture.unassociated = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    picture.values.resize(static_cast<std::size_t>(picture.channels) * static_cast<std::size_t>(spec.width) *
                          static_cast<std::size_t>(spec.height));
    if (!input->read_image(0, 0, 0, picture.channels, OIIO::TypeDesc::FLOAT, picture.values.data())) {
        return PictureFault{ErrorCode::InvalidInput, "is not a complete image: " + input->geterror()};
    }
    picture.data = {spec.x, spec.y, spec.width, spec.height};
    picture.display = {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
    if (spec.full_width < 1 || spec.full_height < 1) picture.display = picture.data;
    picture.note = spec.get_string_attribute(kNote);
    if (picture.wants_depth && spec.nchannels == 5) {
        picture.depth.resize(pixel_count(spec.width, spec.height));
        if (!input->read_image(0, 0, 4, 5, OIIO::TypeDesc::FLOAT, picture.depth.data())) {
            return PictureFault{ErrorCode::InvalidInput, "is not a complete image: " + input->geterror()};
        }
    }
    return {};
}

OIIO::ImageBuf as_buffer(const Image& image) {
    // The buffer refers to the pixels and only reads them; its constructor has no const variant in OpenImageIO 2.4.
    OIIO::ImageSpec spec(image.width, image.height, 4, OIIO::TypeDesc::FLOAT);
    return OIIO::ImageBuf(spec, const_cast<float*>(image.rgba.data()));
}

Outcome write(const std::string& path, const std::string& format, int width, int height, std::span<const std::uint8_t> rgb) {
    const auto output = OIIO::ImageOutput::create(format);
    if (!output) return PictureFault{ErrorCode::MissingCapability, "cannot be written: this OpenImageIO has no ." + format};
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("Compression", format == "webp" ? "webp:92" : "jpeg:92");
    const bool written = output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) && output->close();
    if (written) return std::nullopt;
    return PictureFault{ErrorCode::Io, "cannot be written: " + output->geterror()};
}

OiioMetrics compare(const Image& a, const Image& b, const OiioOptions& options) {
    const auto result = OIIO::ImageBufAlgo::compare(as_buffer(a), as_buffer(b), options.fail, options.warn,
                                                    options.fail_relative, options.warn_relative);
    // `error` is also set by failures; for pictures of one size and format other errors cannot happen.
    return {result.meanerror, result.rms_error, result.PSNR, result.maxerror, result.nwarn, result.nfail};
}

std::size_t compare_yee(const Image& a, const Image& b, float luminance, float field_of_view_deg) {
    OIIO::ImageBufAlgo::CompareResults result{};
    return static_cast<std::size_t>(
        OIIO::ImageBufAlgo::compare_Yee(as_buffer(a), as_buffer(b), result, luminance, field_of_view_deg));
}

}  // namespace

}  // namespace subvol::detail

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::OpenImageIo* subvol_openimageio() {
    using namespace subvol::detail;
    static constexpr OpenImageIo kFunctions{&read, &write, &compare, &compare_yee};
    return &kFunctions;
}
}
