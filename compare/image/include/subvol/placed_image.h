// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol {

/// A rectangle of pixels, rows from the top; the pixel at (left, top) is its first.
struct PixelWindow {
    int left = 0, top = 0, width = 0, height = 0;

    friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

/// A picture that may be a part of a larger one, as crops in `.exr` files are.
struct PlacedImage {
    Image image;
    /// The pixels that there are, those of `image`, and the pixels of the larger picture; the same if the picture is whole.
    PixelWindow data_window{}, display_window{};
    std::string name{};  ///< what messages call it

    [[nodiscard]] bool whole() const { return data_window == display_window; }
};

/// A whole picture, from pixel (0,0).
[[nodiscard]] PlacedImage whole_image(Image image, std::string name = {});

/// `read_image` with the windows of the file; a file that has none is a whole picture.
///
/// throws: as `read_image`
[[nodiscard]] PlacedImage read_placed_image(const std::filesystem::path& path);

/// `write_image` of a part: `.exr` keeps its windows, `.png` has none.
///
/// throws: as `write_image`
void write_placed_image(const std::filesystem::path& path, const PlacedImage& picture, const Vec3& background = Vec3(0.0),
                        std::span<const float> depth = {});

/// What two pictures show of the same pixels, both of the size of `window`: metrics of pictures take the same place for the
/// same pixel.
struct CommonPixels {
    Image a, b;
    PixelWindow window;
};

/// throws: Error(InvalidInput) if the display windows differ, or the data windows have no pixel in common
[[nodiscard]] CommonPixels common_pixels(PlacedImage a, PlacedImage b);

}  // namespace subvol
