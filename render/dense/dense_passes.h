// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pixel_tiles.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A grid that can be seen: where it lies in the picture, and what it takes.
struct SeenGrid {
    Index cell;
    PixelRect rect;
};

/// A part of the picture with all the grids that its rays may meet.
struct DensePass {
    PixelRect rect;
    std::vector<Index> cells;
};

/// The pixels whose rays may meet a box: none if it lies outside the picture or behind the eye; all if it
/// reaches behind.
[[nodiscard]] std::optional<PixelRect> pixels_of(const Box& box, const View& view);

/// Halves the picture until the grids of each part are at most `at_once`, or the part is a tile of 16 pixels: that one takes
/// what it needs.
[[nodiscard]] std::vector<DensePass> plan_passes(const View& view, const std::vector<SeenGrid>& grids, std::size_t at_once);

}  // namespace subvol::detail
