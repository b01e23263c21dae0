// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "splat_frame.h"

namespace subvol::detail {

struct TileRect {
    int x0, x1, y0, y1;  // inclusive; empty if x1 < x0
};
using PixelBox = TileRect;

/// The tiles that a kernel may touch on the sheets of a frame: those with pixels whose centres are in a box around its
/// ellipsoid. Most kernels that are far smaller than a pixel touch none.
class TileFinder {
public:
    /// The frame needs its view, its sheets and its numbers of tiles; it is kept by reference.
    explicit TileFinder(const SplatFrame& frame)
        : frame_(frame),
          perspective_(frame.view->perspective()),
          per_pixel_(static_cast<float>(1 / frame.view->pixel())),
          mid_x_(0.5f * static_cast<float>(frame.view->width())),
          mid_y_(0.5f * static_cast<float>(frame.view->height())) {}

    [[nodiscard]] TileRect find(const EyeSplat& s) const {
        return places(s, SplatFrame::kTile_px, frame_.tiles_x, frame_.tiles_y);
    }
    /// The same in pixels.
    [[nodiscard]] PixelBox pixels_of(const EyeSplat& s) const {
        return places(s, 1, frame_.view->width(), frame_.view->height());
    }

private:
    /// size: of a place in pixels; columns, rows: how many there are
    [[nodiscard]] TileRect places(const EyeSplat& s, int size, int columns, int rows) const {
        constexpr TileRect kNone{0, -1, 0, -1};
        const SheetStack& sheets = frame_.sheets;
        const float reach = 1.0f / std::sqrt(s.inv_szz);
        const float front = std::max(s.depth - reach, sheets.first);
        const float back = std::min(s.depth + reach, sheets.depth(sheets.count - 1));
        // A little room, so that rounding does not lose a sheet.
        if (front > back + 1e-3f * sheets.distance) return kNone;
        const auto half = [&](float extent, float shear) { return std::sqrt(extent * extent + shear * reach * shear * reach); };
        const float hx = half(s.extent_x, s.shear_x), hy = half(s.extent_y, s.shear_y);
        const auto [left, right] = pixels(s.center_x - hx, s.center_x + hx, front, back);
        const auto [low, high] = pixels(s.center_y - hy, s.center_y + hy, front, back);
        const auto [x0, x1] = tiles(mid_x_ + left, mid_x_ + right, size, columns, frame_.view->width());
        const auto [y0, y1] = tiles(mid_y_ - high, mid_y_ - low, size, rows, frame_.view->height());
        return x1 < x0 || y1 < y0 ? kNone : TileRect{x0, x1, y0, y1};
    }

    /// Pixels from the middle that an interval of eye space spans between two depths.
    [[nodiscard]] std::pair<float, float> pixels(float low, float high, float front, float back) const {
        if (!perspective_) return {low * per_pixel_, high * per_pixel_};
        const float a = per_pixel_ / (frame_.sheets.middle + front), b = per_pixel_ / (frame_.sheets.middle + back);
        return {std::min(low * a, low * b), std::max(high * a, high * b)};
    }
    [[nodiscard]] static std::pair<int, int> tiles(float low, float high, int size_px, int count, int end_px) {
        const float first = low + kPastCenter_px, last = high - kPastCenter_px;
        if (!(last >= 0) || !(first < static_cast<float>(end_px))) return {0, -1};
        const auto pixel = [&](float px) { return static_cast<int>(std::clamp(px, 0.0f, static_cast<float>(end_px - 1))); };
        const int begin = pixel(first), end = pixel(last);
        if (begin > end) return {0, -1};
        return {begin / size_px, std::min(end / size_px, count - 1)};
    }

    const SplatFrame& frame_;
    bool perspective_;
    float per_pixel_, mid_x_, mid_y_;
};

}  // namespace subvol::detail
