// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pixel_rect.h"

namespace subvol::detail {

/// Divides a picture into rectangles of whole rows, or parts of a row, that have at most so many fragments each.
///
/// counts: fragments of each pixel, rows one after the other
/// throws: Error(InvalidInput) if a single pixel has more
[[nodiscard]] std::vector<PixelRect> split_into_parts(std::span<const std::uint32_t> counts, int width, int height,
                                                      std::size_t most_fragments);

}  // namespace subvol::detail
