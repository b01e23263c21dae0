// SPDX-License-Identifier: Apache-2.0
// Pictures in files. In memory they are linear, with colours that are multiplied by alpha.
//
//     write   .exr   the values as they are, with depths, the camera, and the data window inside the display window
//             .png   8 bits of sRGB: over a background, c + (1 − α) b, or without one with c / α and α
//             .jpg, .webp   the same over a background, which they need
//     read    OpenEXR first, OpenImageIO for what it does not take; whole numbers are sRGB and become linear
//
// The byte of a linear value is found in a table of the least value of each byte, which bisection of the exact curve gives: a
// bin of [0, 1] tells where to begin, and a step or more leads to the byte. Files are written beside their place and take
// their name when they are complete. Two pictures are compared where their data windows overlap, if they have the same display
// window.
#include "subvol/image_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "picture_modules.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/picture_part.h"
#include "subvol/error.h"
#include "subvol/placed_image.h"
#include "subvol/srgb.h"

namespace subvol {

using namespace detail;

namespace fs = std::filesystem;

namespace {

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

/// Bytes of linear values, looked up: a power for each channel of each pixel takes longer than the compression of the file.
class EncodedBytes {
public:
    EncodedBytes() {
        least_.front() = 0;
        for (std::size_t byte = 1; byte < 256; ++byte) {
            double low = 0, high = 1;  // the byte of `low` is below this one
            for (double middle = 0.5; middle > low && middle < high; middle = 0.5 * (low + high)) {
                (rounded(middle) < byte ? low : high) = middle;
            }
            least_[byte] = high;
        }
        for (std::size_t i = 0; i <= kBins; ++i) start_[i] = rounded(static_cast<double>(i) / kBins);
    }

    [[nodiscard]] std::uint8_t operator()(double linear) const {
        if (!(linear > 0)) return 0;  // NaN too
        std::size_t byte = start_[static_cast<std::size_t>(std::min(linear, 1.0) * kBins)];
        while (byte < 255 && linear >= least_[byte + 1]) ++byte;
        return static_cast<std::uint8_t>(byte);
    }

private:
    static constexpr std::size_t kBins = 4096;

    static std::uint8_t rounded(double linear) {
        return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(linear)));
    }

    std::array<double, 256> least_;  // values with each byte
    std::array<std::uint8_t, kBins + 1> start_;
};

const EncodedBytes& encoder() {
    static const EncodedBytes encoded;
    return encoded;
}

/// write: to the path that it is given
void write_file(const fs::path& path, const std::function<std::optional<PictureFault>(const std::string&)>& write) {
    AtomicFile file(path);
    if (const auto fault = write(file.path().string())) throw Error(fault->code, fault->why, path.string());
    file.commit();
}

// Which of the channels are red, green, blue and alpha (-1: opaque); a file with one or two colours is grey.
std::array<int, 4> channels_of(const DecodedPicture& picture) {
    const int alpha = picture.alpha;
    std::vector<int> colors;
    for (int c = 0; c < picture.channels; ++c) {
        if (c != alpha) colors.push_back(c);
    }
    if (colors.empty()) return {alpha, alpha, alpha, alpha};
    if (colors.size() < 3) return {colors[0], colors[0], colors[0], alpha};
    return {colors[0], colors[1], colors[2], alpha};
}

Image linear_image(const DecodedPicture& picture) {
    const auto channels = channels_of(picture);
    Image image(picture.data.width, picture.data.height);
    for (std::size_t i = 0; i < image.rgba.size() / 4; ++i) {
        const float* pixel = picture.values.data() + i * static_cast<std::size_t>(picture.channels);
        float* rgba = image.rgba.data() + 4 * i;
        rgba[3] = channels[3] < 0 ? 1.0f : pixel[channels[3]];
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = pixel[channels[c]];
            rgba[c] = picture.integers ? static_cast<float>(linear_from_srgb(static_cast<double>(value))) : value;
            if (picture.unassociated && channels[3] >= 0) rgba[c] *= rgba[3];
        }
    }
    return image;
}

void write_pixels(const fs::path& path, const Image& image, const PixelWindow& data, const PixelWindow& display,
                  const std::optional<Vec3>& background, std::span<const float> depth, const std::string& camera = {}) {
    check_image(image);
    if (!depth.empty() && 4 * depth.size() != image.rgba.size()) {
        throw Error(ErrorCode::InvalidInput, "the number of depths is not the number of pixels", path.string());
    }
    const std::string extension = extension_of(path);
    if (extension == ".exr") {
        const PictureValues picture{.data = data,
                                    .display = display,
                                    .rgba = image.rgba.data(),
                                    .depth = depth.empty() ? nullptr : depth.data(),
                                    .camera = camera.empty() ? nullptr : camera.c_str()};
        write_file(path, [&](const std::string& name) { return openexr().write(name, picture); });
    } else if (extension == ".png") {
        const std::vector<std::uint8_t> bytes = background ? srgb_bytes(image, *background) : srgba_bytes(image);
        write_file(path, [&](const std::string& name) { return write_png(name, image.width, image.height, bytes); });
    } else if (extension == ".jpg" || extension == ".jpeg" || extension == ".webp") {
        if (!background)
            throw Error(ErrorCode::InvalidInput, "a transparent picture is not written as " + extension, path.string(),
                        ".png or .exr");
        const std::vector<std::uint8_t> rgb = srgb_bytes(image, *background);
        write_file(path, [&](const std::string& name) {
            return openimageio().write(name, extension.substr(1), image.width, image.height, rgb);
        });
    } else {
        throw Error(ErrorCode::InvalidInput, "images are not written as \"" + extension + "\" files", path.string(),
                    ".exr, .png, .jpg or .webp");
    }
}

}  // namespace

DecodedPicture detail::read_picture(const fs::path& path, bool wants_depth) {
    DecodedPicture picture;
    picture.wants_depth = wants_depth;
    bool taken = false;
    std::optional<PictureFault> fault;
    if (extension_of(path) == ".exr") fault = openexr().read(path.string(), picture, taken);
    if (!taken) fault = openimageio().read(path.string(), picture);
    if (fault) throw Error(fault->code, fault->why, path.string());
    return picture;
}

std::vector<std::uint8_t> srgba_bytes(const Image& image) {
    const EncodedBytes& encoded_byte = encoder();
    check_image(image);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.rgba.size());
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const double alpha = std::clamp(static_cast<double>(image.rgba[i + 3]), 0.0, 1.0);
        for (std::size_t c = 0; c < 3; ++c) bytes.push_back(encoded_byte(alpha > 0 ? image.rgba[i + c] / alpha : 0));
        bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * alpha)));
    }
    return bytes;
}

std::vector<std::uint8_t> srgb_bytes(const Image& image, const Vec3& background) {
    const EncodedBytes& encoded_byte = encoder();
    check_image(image);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const double through = 1.0 - static_cast<double>(image.rgba[i + 3]);
        for (std::size_t c = 0; c < 3; ++c) {
            const double behind = background[static_cast<int>(c)], color = image.rgba[i + c];
            bytes.push_back(encoded_byte(behind == 0 ? color : color + through * behind));
        }
    }
    return bytes;
}

std::string png_bytes(const Image& image, const std::optional<Vec3>& background) {
    return encoded_png(image.width, image.height, background ? srgb_bytes(image, *background) : srgba_bytes(image));
}

void write_image(const fs::path& path, const Image& image, const std::optional<Vec3>& background, std::span<const float> depth,
                 const std::string& camera) {
    const PixelWindow whole{0, 0, image.width, image.height};
    write_pixels(path, image, whole, whole, background, depth, camera);
}

void write_placed_image(const fs::path& path, const PlacedImage& picture, const Vec3& background,
                        std::span<const float> depth) {
    const PixelWindow& data = picture.data_window;
    if (data.width != picture.image.width || data.height != picture.image.height) {
        throw Error(ErrorCode::InvalidInput, "the data window is not that of the image", path.string());
    }
    write_pixels(path, picture.image, data, picture.display_window, background, depth);
}

PlacedImage read_placed_image(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) throw Error(ErrorCode::Io, "cannot be read: no such file", path.string());
    const DecodedPicture picture = read_picture(path);
    return {linear_image(picture), picture.data, picture.display, path.string()};
}

Image read_image(const fs::path& path) {
    return read_placed_image(path).image;
}

std::string camera_of_image(const fs::path& path) {
    std::error_code ignored;
    const bool may_have_one = extension_of(path) == ".exr" && fs::is_regular_file(path, ignored);
    return may_have_one ? openexr().camera(path.string()) : std::string();
}

namespace {

std::string size_of(const PixelWindow& window) {
    return std::to_string(window.width) + " x " + std::to_string(window.height);
}

std::string first_of(const PixelWindow& window) {
    return "(" + std::to_string(window.left) + ", " + std::to_string(window.top) + ")";
}

std::string name_of(const PlacedImage& picture, const char* otherwise) {
    return picture.name.empty() ? otherwise : picture.name;
}

[[noreturn]] void refuse_other_display(const PlacedImage& a, const PlacedImage& b) {
    const std::string first = name_of(a, "the first picture"), second = name_of(b, "the second picture");
    const auto from_zero = [](const PlacedImage& picture) {
        return picture.whole() && picture.display_window.left == 0 && picture.display_window.top == 0;
    };
    if (from_zero(a) && from_zero(b)) {
        throw Error(ErrorCode::InvalidInput,
                    "has " + size_of(a.display_window) + " pixels, " + second + " has " + size_of(b.display_window), first,
                    "only pictures of the same size can be compared");
    }
    const auto described = [](const PlacedImage& picture) {
        return (picture.whole() ? "a picture of " : "part of a picture of ") + size_of(picture.display_window) +
               " pixels from " + first_of(picture.display_window);
    };
    throw Error(ErrorCode::InvalidInput, "is " + described(a) + ", " + second + " is " + described(b), first,
                "pictures with the same display window can be compared");
}

/// 64 bits: windows are from files, which may have any int.
std::int64_t end_of(int begin, int length) {
    return std::int64_t{begin} + length;
}

PixelWindow intersection(const PixelWindow& a, const PixelWindow& b) {
    const int left = std::max(a.left, b.left), top = std::max(a.top, b.top);
    const std::int64_t right = std::min(end_of(a.left, a.width), end_of(b.left, b.width));
    const std::int64_t bottom = std::min(end_of(a.top, a.height), end_of(b.top, b.height));
    if (right <= left || bottom <= top) return {};
    return {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
}

Image cut(PlacedImage picture, const PixelWindow& window) {
    if (picture.data_window == window) return std::move(picture.image);
    Image part(window.width, window.height);
    for (int y = 0; y < window.height; ++y) {
        const auto from = picture.image.pixel(window.left - picture.data_window.left, window.top - picture.data_window.top + y);
        std::copy_n(from.data(), 4 * static_cast<std::size_t>(window.width), part.pixel(0, y).data());
    }
    return part;
}

}  // namespace

PlacedImage whole_image(Image image, std::string name) {
    const PixelWindow window{0, 0, image.width, image.height};
    return {std::move(image), window, window, std::move(name)};
}

CommonPixels common_pixels(PlacedImage a, PlacedImage b) {
    if (a.display_window != b.display_window) refuse_other_display(a, b);
    const PixelWindow window = intersection(a.data_window, b.data_window);
    if (window.width == 0) {
        throw Error(ErrorCode::InvalidInput,
                    "its " + size_of(a.data_window) + " pixels from " + first_of(a.data_window) + " and the " +
                        size_of(b.data_window) + " from " + first_of(b.data_window) + " of " +
                        name_of(b, "the second picture") + " have no pixel in common",
                    name_of(a, "the first picture"), "parts of a picture are compared where they overlap");
    }
    return {cut(std::move(a), window), cut(std::move(b), window), window};
}

}  // namespace subvol

namespace subvol::detail {

void write_picture_part(const std::filesystem::path& path, const PicturePart& part) {
    const Image& rows = part.rows;
    const std::size_t pixels = rows.rgba.size() / 4;
    const bool within = part.first_row >= 0 && rows.height > 0 && part.first_row + rows.height <= part.whole_height;
    if (!within || (!part.depth.empty() && part.depth.size() != pixels)) {
        throw Error(ErrorCode::InvalidInput, "the rows are not within the picture", path.string());
    }
    AtomicFile file(path);
    const PictureValues picture{.data = {0, part.first_row, rows.width, rows.height},
                                .display = {0, 0, rows.width, part.whole_height},
                                .rgba = rows.rgba.data(),
                                .depth = part.depth.empty() ? nullptr : part.depth.data(),
                                .note = part.note.c_str()};
    if (const auto fault = openexr().write(file.path().string(), picture)) {
        throw Error(fault->code, fault->why, path.string());
    }
    file.commit();
}

PicturePart read_picture_part(const std::filesystem::path& path) {
    DecodedPicture picture = read_picture(path, /*wants_depth=*/true);
    const PixelWindow &data = picture.data, &display = picture.display;
    const std::int64_t first_row = std::int64_t{data.top} - display.top;
    const bool whole_rows =
        data.left == display.left && data.width == display.width && first_row >= 0 && first_row + data.height <= display.height;
    if (picture.note.empty() || picture.channels != 4 || picture.integers || !whole_rows) return {};
    PicturePart part{.rows = Image(data.width, data.height),
                     .depth = std::move(picture.depth),
                     .first_row = static_cast<int>(first_row),
                     .whole_height = display.height,
                     .note = std::move(picture.note)};
    part.rows.rgba = std::move(picture.values);
    return part;
}

}  // namespace subvol::detail
