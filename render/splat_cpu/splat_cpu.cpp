// SPDX-License-Identifier: Apache-2.0
// The splatter for CPUs: tile by tile, in each tile batches of sheets from front to back, with pixels in vectors as wide as the
// machine has them. Highway compiles this file once for every instruction set; the best one is chosen at run time.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "splat_cpu.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "splat_ends-inl.h"
#include "splat_tile-inl.h"
#include "subvol/raster.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

void draw_tile(const SplatFrame& frame, int tile, Drawn& drawn) {
    if (frame.scene->plain()) {
        TileRenderer<true>(frame).draw(tile, drawn);
    } else {
        TileRenderer<false>(frame).draw(tile, drawn);
    }
}

void find_ends(const SplatFrame& frame, int tile, std::vector<IntervalEnd>& ends) {
    if (frame.scene->plain()) {
        EndFinder<true>(frame).find(tile, ends);
    } else {
        EndFinder<false>(frame).find(tile, ends);
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(draw_tile);
HWY_EXPORT(find_ends);

void find_interval_ends(SplatFrame& frame) {
    frame.ends.assign(frame.intervals.depths.size(), {});
    if (frame.ends.empty()) return;
    tbb::parallel_for(tbb::blocked_range<int>(0, frame.tiles_x * frame.tiles_y, 1), [&](const auto& range) {
        for (int tile = range.begin(); tile < range.end(); ++tile) HWY_DYNAMIC_DISPATCH(find_ends)(frame, tile, frame.ends);
    });
}

Drawn draw_splats_cpu(const SplatFrame& frame, Progress* progress) {
    const View& view = *frame.view;
    Drawn drawn{Image(view.width(), view.height()), {}};
    drawn.depth.assign(drawn.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const int tiles = frame.tiles_x * frame.tiles_y;
    std::mutex reporting;
    int done = 0;
    report_progress(progress, "splat", 0);
    tbb::parallel_for(tbb::blocked_range<int>(0, tiles, 1), [&](const auto& range) {
        for (int tile = range.begin(); tile < range.end(); ++tile) HWY_DYNAMIC_DISPATCH(draw_tile)(frame, tile, drawn);
        if (!progress) return;
        const std::lock_guard lock(reporting);
        done += range.end() - range.begin();
        report_progress(progress, "splat", static_cast<double>(done) / tiles);
    });
    return drawn;
}

std::vector<float> optical_depths_cpu(SplatFrame& frame) {
    const auto pixels = pixel_count(frame.view->width(), frame.view->height());
    std::vector<float> depths(pixels * static_cast<std::size_t>(frame.sheets.count), -1.0f);
    frame.optical_depths = depths.data();
    (void)draw_splats_cpu(frame, nullptr);
    frame.optical_depths = nullptr;
    // On sheets that were passed over nothing was added.
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels, 1024), [&](const auto& range) {
        for (std::size_t pixel = range.begin(); pixel < range.end(); ++pixel) {
            float last = 0;
            for (std::size_t at = pixel; at < depths.size(); at += pixels) last = depths[at] = std::max(depths[at], last);
        }
    });
    return depths;
}

}  // namespace subvol::detail
#endif
