// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol {

/// Writes `.exr` (linear float RGBA, premultiplied; with depths a fifth channel Z), `.png` (8-bit sRGB RGB over the background,
/// no depth), or the same as `.jpg` or `.webp`. The file appears whole under its name or not at all.
///
/// background: linear RGB; none: a `.png` has an alpha, which its colours are not multiplied by
/// depth:      one per pixel, +infinity where nothing is; empty: no channel Z
/// camera:     its numbers (`camera_text`), which an .exr has in its header as subvolCamera; empty: none
/// throws:     Error(InvalidInput) for another extension, another number of depths or a transparent `.jpg` or `.webp`,
/// Error(Io)
void write_image(const std::filesystem::path& path, const Image& image, const std::optional<Vec3>& background = Vec3(0.0),
                 std::span<const float> depth = {}, const std::string& camera = {});

/// 8-bit sRGB over a background of linear RGB: three bytes per pixel, rows from the top. Values above 1, infinity too, become
/// 255; those below 0 and NaN become 0.
///
/// throws: Error(InvalidInput) if the image has no pixels, or its number of values does not match its size
[[nodiscard]] std::vector<std::uint8_t> srgb_bytes(const Image& image, const Vec3& background = Vec3(0.0));

/// 8-bit sRGB with alpha, which the colours are not multiplied by: four bytes per pixel, rows from the top.
///
/// throws: Error(InvalidInput) as `srgb_bytes`
[[nodiscard]] std::vector<std::uint8_t> srgba_bytes(const Image& image);

/// The bytes of a `.png` as `write_image` writes it.
///
/// throws: Error(InvalidInput) as `srgb_bytes`
[[nodiscard]] std::string png_bytes(const Image& image, const std::optional<Vec3>& background = Vec3(0.0));

/// Reads an image of any format that OpenImageIO reads as linear premultiplied RGBA; integer samples are decoded from sRGB. A
/// channel Z is ignored. Of a part of a larger picture it has the pixels alone: `read_placed_image` knows where they are.
///
/// throws: Error(Io) if there is no such file, Error(InvalidInput) if it is not a complete image or has more than 2²⁸ pixels
[[nodiscard]] Image read_image(const std::filesystem::path& path);

/// The camera in the header of an .exr; empty if there is none, or no such file.
[[nodiscard]] std::string camera_of_image(const std::filesystem::path& path);

}  // namespace subvol
