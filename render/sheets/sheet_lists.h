// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pixel_tiles.h"
#include "splat_frame.h"

namespace subvol::detail {

/// The kernels that sheets cut, in their order, and the pixels that they may touch: sheet first + k has
/// splats[offsets[k] .. offsets[k + 1]).
struct SheetLists {
    std::vector<PixelRect> rects;
    std::vector<std::size_t> offsets;
    std::vector<std::uint32_t> splats;
};

/// A rectangle around the pixels whose rays meet the boundary; the whole picture if there is no boundary.
[[nodiscard]] PixelRect seen_pixels(const SplatFrame& frame);

/// Lists the kernels of a frame that touch `window` by the sheets first..last − 1 (a counting sort). The result is the same for
/// any number of threads.
[[nodiscard]] SheetLists list_sheets(const SplatFrame& frame, const PixelRect& window, int first, int last);

}  // namespace subvol::detail
