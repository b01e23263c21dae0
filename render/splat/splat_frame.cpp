// SPDX-License-Identifier: Apache-2.0
#include "splat_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clip_intervals.h"
#include "subvol/raster.h"
#include "tile_finder.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kChunksOfSplats = 64;

/// The first batch of sheets and the last that a kernel may touch.
std::array<std::uint16_t, 2> batches_of(const EyeSplat& s, const SheetStack& sheets, float behind) {
    const float reach = 1.0f / std::sqrt(s.inv_szz), per_sheet = 1.0f / sheets.distance;
    const auto sheet = [&](float z) {
        return std::clamp((z - sheets.first) * per_sheet, -1.0f, static_cast<float>(sheets.count));
    };
    // Half a sheet more on each side, so that rounding does not lose one.
    constexpr float kMore = 0.5f;
    const int first = std::max(static_cast<int>(sheet(s.depth - reach) - kMore), 0);
    const int last = std::min(static_cast<int>(sheet(s.depth + reach) + kMore + behind), sheets.count - 1);
    return {static_cast<std::uint16_t>(first / kBatch), static_cast<std::uint16_t>(last / kBatch)};
}

/// A counting sort in a fixed number of chunks: within a tile kernels keep their order, whatever the number of threads.
void list_tiles(SplatFrame& frame) {
    const auto& splats = frame.kernels.splats;
    const auto tiles = static_cast<std::size_t>(frame.tiles_x) * static_cast<std::size_t>(frame.tiles_y);
    const TileFinder finder(frame);
    // What is behind a sheet belongs to the next one where there are more between them.
    const float behind = frame.finer.any() ? 1.0f : 0.0f;
    std::vector<TileRect> rects(splats.size());
    frame.batches.resize(splats.size());
    const std::size_t chunks = std::clamp<std::size_t>(splats.size() / 4096, 1, kChunksOfSplats);
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
        frame.batches[i] = batches_of(splats[i], frame.sheets, behind);
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

/// Whether the values of all pixels on all sheets of a frame are few enough to be kept. Values of lit volumes are not.
bool fits_in_memory(const SplatFrame& frame) {
    constexpr double kMost_bytes = 256e6;
    constexpr double kSheetsAround = 3;  // of an interval
    if (!frame.scene->plain() || frame.intervals.offsets.empty()) return false;
    const auto& depths = frame.intervals.depths;
    double inside = 0;
    for (std::size_t i = 0; i < depths.size(); i += 2) inside += static_cast<double>(depths[i + 1] - depths[i]);
    const double sheets =
        inside / static_cast<double>(frame.sheets.distance) + kSheetsAround * static_cast<double>(depths.size() / 2);
    return sheets * sizeof(float) <= kMost_bytes;
}

/// Places the light volume of the scene, if there is one.
void set_light(SplatFrame& frame) {
    const SplatScene& scene = *frame.scene;
    if (scene.light) frame.to_light = eye_to_nodes(*scene.light, *frame.view, frame.view->to_eye(scene.middle).z);
}

}  // namespace

bool SplatFrame::meets_intervals(int x0, int y0) const {
    if (intervals.offsets.empty()) return true;
    const int x1 = std::min(x0 + kTile_px, view->width()), y1 = std::min(y0 + kTile_px, view->height());
    for (int y = y0; y < y1; ++y) {
        const std::size_t row = pixel_index(view->width(), x0, y);
        if (intervals.offsets[row] != intervals.offsets[row + static_cast<std::size_t>(x1 - x0)]) return true;
    }
    return false;
}

void prepare_kernels(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                     int sheets, Progress* progress) {
    frame.scene = &scene;
    frame.view = &view;
    frame.classification = &classification;
    frame.kept.clear();
    frame.sheets = make_sheets(scene, view, sheets);
    frame.tiles_x = (view.width() + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
    frame.tiles_y = (view.height() + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
    report_progress(progress, "prepare splats", 0);
    eye_splats(frame.kernels, scene, view, classification);
    frame.finer = sheets == 0 ? finer_sheets(frame) : FinerSheets{};
    report_progress(progress, "prepare splats", 0.3);
    list_tiles(frame);
    report_progress(progress, "prepare splats", 0.6);
}

void set_transfer_function(SplatFrame& frame, const View& view, const Classification& classification, int sheets) {
    frame.view = &view;
    frame.classification = &classification;
    const bool finer = frame.finer.any();
    frame.finer = sheets == 0 ? finer_sheets(frame) : FinerSheets{};
    if (frame.finer.any() != finer) list_tiles(frame);
    if (frame.kept.empty() && fits_in_memory(frame)) {
        frame.kept.resize(static_cast<std::size_t>(frame.tiles_x * frame.tiles_y) *
                          static_cast<std::size_t>(frame.sheets.batches()));
    }
    set_light(frame);
}

void prepare_frame(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                   int sheets, Progress* progress) {
    prepare_kernels(frame, scene, view, classification, sheets, progress);
    frame.intervals = scene_intervals(scene, view, frame.sheets);
    if (scene.shading && !frame.intervals.offsets.empty()) frame.entry_lights = entry_lights(frame.intervals, scene, view);
    set_light(frame);
    report_progress(progress, "prepare splats", 1);
}

}  // namespace subvol::detail
