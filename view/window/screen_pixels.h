// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// A picture over a background as 8-bit sRGB RGBA, opaque: the same bytes as those of a .png file.
[[nodiscard]] std::vector<std::uint8_t> screen_pixels(const Image& image, const Vec3& background);

}  // namespace subvol::detail
