// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "openimageio.h"

namespace subvol::detail {

/// Writes an 8-bit sRGB picture by libpng: the module of OpenImageIO takes a third of a second to load, which is a good part of
/// the time of a first picture.
///
/// rgb: three bytes a pixel, row by row from the top
[[nodiscard]] std::optional<PictureFault> write_png(const std::string& path, int width, int height,
                                                    std::span<const std::uint8_t> rgb);

}  // namespace subvol::detail
