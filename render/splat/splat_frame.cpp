// SPDX-License-Identifier: Apache-2.0
#include "splat_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clip_intervals.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kChunks = 64;

struct TileRect {
    int x0, x1, y0, y1;  // inclusive; empty if x1 < x0
};

/// The tiles that a kernel may touch on the sheets of a frame: those of a box around its ellipsoid.
class TileFinder {
public:
    TileFinder(const SplatFrame& frame)
        : frame_(frame),
          perspective_(frame.view->perspective()),
          per_pixel_(static_cast<float>(1 / frame.view->pixel())),
          mid_x_(0.5f * static_cast<float>(frame.view->width())),
          mid_y_(0.5f * static_cast<float>(frame.view->height())) {}

    [[nodiscard]] TileRect find(const EyeSplat& s) const {
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
        const auto [x0, x1] = tiles(mid_x_ + left, mid_x_ + right, frame_.tiles_x, frame_.view->width());
        const auto [y0, y1] = tiles(mid_y_ - high, mid_y_ - low, frame_.tiles_y, frame_.view->height());
        return x1 < x0 || y1 < y0 ? kNone : TileRect{x0, x1, y0, y1};
    }

private:
    /// Pixels from the middle that an interval of eye space spans between two depths.
    [[nodiscard]] std::pair<float, float> pixels(float low, float high, float front, float back) const {
        if (!perspective_) return {low * per_pixel_, high * per_pixel_};
        const float a = per_pixel_ / (frame_.sheets.middle + front), b = per_pixel_ / (frame_.sheets.middle + back);
        return {std::min(low * a, low * b), std::max(high * a, high * b)};
    }
    [[nodiscard]] static std::pair<int, int> tiles(float low, float high, int count, int size) {
        if (!(high > -1) || !(low < static_cast<float>(size) + 1)) return {0, -1};
        // One pixel more on each side, so that rounding does not lose a kernel's rim.
        const auto tile = [&](float px) {
            return static_cast<int>(std::clamp(px / SplatFrame::kTile_px, 0.0f, static_cast<float>(count - 1)));
        };
        return {tile(low - 1), tile(high + 1)};
    }

    const SplatFrame& frame_;
    bool perspective_;
    float per_pixel_, mid_x_, mid_y_;
};

/// A counting sort in a fixed number of chunks: within a tile kernels keep their order, whatever the number of threads.
void list_tiles(SplatFrame& frame) {
    const auto& splats = frame.kernels.splats;
    const auto tiles = static_cast<std::size_t>(frame.tiles_x) * static_cast<std::size_t>(frame.tiles_y);
    const TileFinder finder(frame);
    std::vector<TileRect> rects(splats.size());
    const std::size_t chunks = std::clamp<std::size_t>(splats.size() / 4096, 1, kChunks);
    std::vector<std::size_t> next(tiles * chunks);
    const auto each = [&](const auto& visit) {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
            for (std::size_t i = splats.size() * chunk / chunks; i < splats.size() * (chunk + 1) / chunks; ++i) {
                visit(i, [&](const auto& slot) {
                    const TileRect& r = rects[i];
                    for (int y = r.y0; y <= r.y1; ++y) {
                        for (int x = r.x0; x <= r.x1; ++x) {
                            slot(next[static_cast<std::size_t>(y * frame.tiles_x + x) * chunks + chunk]);
                        }
                    }
                });
            }
        });
    };
    each([&](std::size_t i, const auto& each_slot) {
        rects[i] = finder.find(splats[i]);
        each_slot([](std::size_t& slot) { ++slot; });
    });
    frame.tile_offsets.resize(tiles + 1);
    std::size_t sum = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        frame.tile_offsets[tile] = sum;
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) sum += std::exchange(next[tile * chunks + chunk], sum);
    }
    frame.tile_offsets[tiles] = sum;
    frame.tile_splats.resize(sum);
    each([&](std::size_t i, const auto& each_slot) {
        each_slot([&](std::size_t& slot) { frame.tile_splats[slot++] = static_cast<std::uint32_t>(i); });
    });
}

}  // namespace

void prepare_frame(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                   int sheets, Progress* progress) {
    report_progress(progress, "prepare splats", 0);
    frame.scene = &scene;
    frame.view = &view;
    frame.classification = &classification;
    frame.sheets = make_sheets(scene, view, sheets);
    frame.tiles_x = (view.width() + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
    frame.tiles_y = (view.height() + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
    frame.intervals = scene_intervals(scene, view, frame.sheets);
    if (scene.shading && !frame.intervals.offsets.empty()) frame.entry_lights = entry_lights(frame.intervals, scene, view);
    report_progress(progress, "prepare splats", 0.4);
    eye_splats(frame.kernels, scene, view, classification);
    report_progress(progress, "prepare splats", 0.7);
    list_tiles(frame);
    report_progress(progress, "prepare splats", 1);
}

}  // namespace subvol::detail
