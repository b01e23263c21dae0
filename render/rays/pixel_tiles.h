// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

#include "subvol/camera.h"
#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/pixel_rows.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1; (0,0) is the top left.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }

    /// The smallest rectangle that contains both.
    [[nodiscard]] PixelRect with(const PixelRect& other) const {
        if (other.empty()) return *this;
        if (empty()) return other;
        return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1), std::max(y1, other.y1)};
    }
};

/// Whole rows of a picture; none if they lie beyond it.
[[nodiscard]] inline PixelRect rect_of(const PixelRows& rows, int width, int height) {
    return {0, std::clamp(rows.first, 0, height), width, std::clamp(rows.end, 0, height)};
}

inline constexpr int kMaxSamples = 16;

/// Transmittance below which a ray ends. What lies behind can change a colour by no more than this: a fifteenth of a step of a
/// 16-bit picture.
inline constexpr double kRayCutoff = 1e-6;

/// throws: Error(InvalidInput) unless samples is in 1..16
inline void check_samples(int samples) {
    if (samples < 1 || samples > kMaxSamples) {
        throw Error(ErrorCode::InvalidInput, "samples is " + std::to_string(samples), {}, "1..16 along each side of a pixel");
    }
}

/// The mean over a regular n × n grid of rays in pixel (x,y).
template <class Trace>
Segment trace_pixel(const View& view, int x, int y, int samples, Trace& trace) {
    Segment sum{.color = Vec3(0.0), .transmittance = 0};
    for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
            const Segment one = trace(view.ray(x + (i + 0.5) / samples, y + (j + 0.5) / samples));
            sum.color += one.color;
            sum.transmittance += one.transmittance;
        }
    }
    const double rays = static_cast<double>(samples) * samples;
    return {sum.color / rays, sum.transmittance / rays};
}

/// Writes colour and opacity.
inline void write_pixel(Image& image, int x, int y, const Segment& seen) {
    const auto pixel = image.pixel(x, y);
    for (int c = 0; c < 3; ++c) pixel[static_cast<std::size_t>(c)] = static_cast<float>(seen.color[c]);
    pixel[3] = static_cast<float>(1 - seen.transmittance);
}

/// Calls draw_tile(PixelRect) for all tiles of a part of a picture, on all threads.
template <class DrawTile>
void for_each_tile(const PixelRect& part, Progress* progress, const DrawTile& draw_tile) {
    if (part.empty()) return;
    constexpr int kTile = 16;
    const int columns = (part.x1 - part.x0 + kTile - 1) / kTile;
    const int rows = (part.y1 - part.y0 + kTile - 1) / kTile;
    std::mutex reporting;
    int tiles_done = 0;
    const auto draw = [&](int column, int row) {
        const int left = part.x0 + column * kTile, top = part.y0 + row * kTile;
        draw_tile(PixelRect{left, top, std::min(left + kTile, part.x1), std::min(top + kTile, part.y1)});
        if (!progress) return;
        const std::lock_guard lock(reporting);
        report_progress(progress, "draw", static_cast<double>(++tiles_done) / (static_cast<double>(columns) * rows));
    };
    tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, 1, 0, columns, 1), [&](const auto& range) {
        for (int row = range.rows().begin(); row < range.rows().end(); ++row) {
            for (int column = range.cols().begin(); column < range.cols().end(); ++column) draw(column, row);
        }
    });
}

/// Draws a part of a picture in tiles. Every pixel depends on its own rays only, so the number of threads changes nothing.
///
/// make_tracer: returns a function from Ray to Segment; called once for each tile, so that a tracer can keep scratch memory and
///              count
template <class MakeTracer>
void draw_in_tiles(const View& view, int samples, const PixelRect& part, Image& image, Progress* progress,
                   const MakeTracer& make_tracer) {
    for_each_tile(part, progress, [&](const PixelRect& tile) {
        auto trace = make_tracer();
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) write_pixel(image, x, y, trace_pixel(view, x, y, samples, trace));
        }
    });
}

/// Draws a whole picture.
template <class MakeTracer>
Image draw_in_tiles(const View& view, int samples, Progress* progress, const MakeTracer& make_tracer) {
    Image image(view.width(), view.height());
    draw_in_tiles(view, samples, {0, 0, view.width(), view.height()}, image, progress, make_tracer);
    return image;
}

}  // namespace subvol::detail
