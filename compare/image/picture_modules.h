// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/oiio_compare.h"
#include "subvol/placed_image.h"

namespace subvol::detail {

/// A picture as its file has it, not yet linear.
struct DecodedPicture {
    int channels = 0;
    int alpha = -1;                 ///< which of the channels is alpha; -1: none
    bool integers = false;          ///< the file has integers
    bool unassociated = false;      ///< colours are not premultiplied
    std::vector<float> values;      ///< `channels` numbers for each pixel, at most the file's first four; integers as 0 to 1
    PixelWindow data{}, display{};  ///< the windows of the file, see PlacedImage
    bool wants_depth = false;
    std::vector<float> depth{};  ///< the channel Z, if it was asked for and the file has one
    std::string note{};          ///< a text of `PictureValues::note`
};

/// Pixels for a file: linear floats R, G, B, A, and a depth for each, if there are any.
struct PictureValues {
    PixelWindow data{}, display{};  ///< as in PlacedImage
    const float* rgba = nullptr;
    const float* depth = nullptr;
    const char* note = nullptr;    ///< a text beside the pixels
    const char* camera = nullptr;  ///< the numbers of the camera; null: none
};

struct PictureFault {
    ErrorCode code;
    std::string why;
};

/// Reads a picture of any format, a usual .exr without OpenImageIO.
///
/// throws: Error(InvalidInput) if it is malformed
[[nodiscard]] DecodedPicture read_picture(const std::filesystem::path& path, bool wants_depth = false);

/// The functions of the module that uses OpenImageIO. They throw nothing but std::bad_alloc: the module and the program may
/// have different copies of the type `Error`.
struct OpenImageIo {
    std::optional<PictureFault> (*read)(const std::string& path, DecodedPicture& picture);
    /// format: jpg or webp, by the name of its extension, as the file's may be another one; rgb: as of `write_png`
    std::optional<PictureFault> (*write)(const std::string& path, const std::string& format, int width, int height,
                                         std::span<const std::uint8_t> rgb);
    OiioMetrics (*compare)(const Image& a, const Image& b, const OiioOptions& options);
    std::size_t (*compare_yee)(const Image& a, const Image& b, float luminance, float field_of_view_deg);
};

/// Loads the module when it is called first.
///
/// throws: Error(MissingCapability) if it is not there
[[nodiscard]] const OpenImageIo& openimageio();

/// The functions of the module that uses OpenEXR, as in OpenImageIo. OpenImageIO reads every .exr there is; what this command
/// writes takes a tenth of the time without its 250 libraries.
struct OpenExr {
    std::optional<PictureFault> (*write)(const std::string& path, const PictureValues& picture);

    /// Reads a flat picture in scan lines whose channels are R, G, B, perhaps A, and then perhaps Z, as floats or halves.
    ///
    /// taken: whether it is such a picture; if not, it is for OpenImageIO
    std::optional<PictureFault> (*read)(const std::string& path, DecodedPicture& picture, bool& taken);

    /// The camera in the header; empty if there is none, or if it is another file.
    std::string (*camera)(const std::string& path);
};

/// Loads the module when it is called first.
///
/// throws: Error(MissingCapability) if it is not there
[[nodiscard]] const OpenExr& openexr();

/// Writes an 8-bit sRGB picture by libpng: the module of OpenImageIO takes a third of a second to load, which is a good part of
/// the time of a first picture.
///
/// bytes: three a pixel, or four with alpha, row by row from the top
/// bytes: as of `write_png`
[[nodiscard]] std::string encoded_png(int width, int height, std::span<const std::uint8_t> bytes);

[[nodiscard]] std::optional<PictureFault> write_png(const std::string& path, int width, int height,
                                                    std::span<const std::uint8_t> bytes);

}  // namespace subvol::detail
