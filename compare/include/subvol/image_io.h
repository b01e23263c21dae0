#pragma once

#include <filesystem>

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol {

/// Writes `.exr` (linear float RGBA, premultiplied) or `.png` (8-bit sRGB RGB over the background). Written beside and renamed.
///
/// background: linear RGB
/// throws: Error(InvalidInput) for another extension, Error(Io)
void write_image(const std::filesystem::path& path, const Image& image, const Vec3& background = Vec3(0.0));

/// Reads an image that OpenImageIO knows into linear premultiplied RGBA; integer samples are taken as sRGB.
///
/// throws: Error(Io) if there is no such file, Error(InvalidInput) if it is no whole image or has more than 2²⁸ pixels
[[nodiscard]] Image read_image(const std::filesystem::path& path);

}  // namespace subvol
