#pragma once

#include <cstdint>
#include <vector>

#include "splat_frame.h"

namespace subvol::detail {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1; (0,0) is the top left.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
    /// The least rectangle about two.
    [[nodiscard]] PixelRect with(const PixelRect& other) const;
};

/// The kernels that sheets cut, in their order, and the pixels that they may touch there: sheet first + k has
/// splats[offsets[k] .. offsets[k + 1]).
struct SheetLists {
    std::vector<PixelRect> rects;
    std::vector<std::size_t> offsets;
    std::vector<std::uint32_t> splats;
};

/// The pixels whose rays meet the boundary: a rectangle about them. The whole picture if there is no boundary.
[[nodiscard]] PixelRect seen_pixels(const SplatFrame& frame);

/// A counting sort of the kernels of a frame by the sheets first..last − 1, as far as they touch `window`. The same for any
/// number of threads.
[[nodiscard]] SheetLists list_sheets(const SplatFrame& frame, const PixelRect& window, int first, int last);

}  // namespace subvol::detail
