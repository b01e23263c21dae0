// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pixel_tiles.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A grid that can be seen, and its rectangle in the picture.
struct SeenGrid {
    Index cell;
    PixelRect rect;
};

/// A part of the picture, and the cells of all grids that its rays may meet.
struct DensePass {
    PixelRect rect;
    std::vector<Index> cells;
};

/// The pixels whose rays may meet a box: nothing if it lies outside the picture or behind the eye, all pixels if it reaches
/// behind the eye.
[[nodiscard]] std::optional<PixelRect> pixels_of(const Box& box, const View& view);

/// Halves the picture until each part has at most `at_once` grids. A part of 16 × 16 pixels is not halved, whatever it needs.
[[nodiscard]] std::vector<DensePass> plan_passes(const View& view, const std::vector<SeenGrid>& grids, std::size_t at_once);

}  // namespace subvol::detail
