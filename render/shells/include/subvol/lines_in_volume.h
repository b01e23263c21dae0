// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/overlay.h"
#include "subvol/surface.h"

namespace subvol {

/// Lines within a volume, at most one in each pixel.
struct LineLayer {
    /// For each pixel the eye depth of the line, 0 if there is none, and the part of the pixel that it covers, with its alpha.
    std::vector<float> depths, covers;
};

/// Lines of a picture by where they lie: before the volume, behind it, or within, the nearest layer first.
struct SortedLines {
    std::vector<LineSample> before{}, behind{};
    std::vector<LineLayer> within{};

    [[nodiscard]] bool empty() const { return before.empty() && behind.empty() && within.empty(); }
};

/// Sorts lines by their depths in the volume. Lines beside its limit by less than their slack count as on it. Those behind the
/// end of a ray of the view are left out. Of more than two layers in a pixel the farther ones become one.
///
/// boundary: of the volume, closed, outward
/// clip:     that of the picture
[[nodiscard]] SortedLines sort_lines(std::span<const LineSample> lines, const Surface& boundary, const View& view,
                                     const Clip& clip = {});

/// A view in which rays end at the lines of a layer, and see nothing where there is none.
[[nodiscard]] View ended_at(const LineLayer& layer, const View& view);

/// Draws lines of one colour into the finished picture of a volume. Where a line covers the part a of a pixel, the pixel is
///
///     (1 − a) · whole + a · (ended + (1 − alpha of ended) · colour)
///
/// with its picture as a whole, and that of the rays which end at the line. So lines in a volume are seen as far as what is
/// before them is transparent, and their antialiased sides leave no seam.
///
/// ended:  the volume, drawn for `ended_at` of each layer within
/// throws: Error(InvalidInput) if there is not one picture for each layer, or one is of another size
void draw_lines(Image& image, const SortedLines& lines, std::span<const Image> ended, const Vec3& color);

}  // namespace subvol
