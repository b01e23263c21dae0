// SPDX-License-Identifier: Apache-2.0
// The number of sheets follows the kernels that take most of the volume. Kernels that are much thinner than the sheets are
// apart, as in a boundary layer, would then be seen wrongly, since the field is straight between two sheets:
//
//     value          __----  exact: rises within the layer, whose kernels reach r along the ray
//          |    _--''        straight between sheets that are h apart: off by the rise, over a length of about h,
//          |_-''             or h · h/r where the layer has several sheets
//          +---|-------|--- depth
//
// So a kernel over whose reach extinction and emission change by c is estimated to cause an error of c · h · min(1, h/r) in
// optical depth, and thereby in colours. Where that is too much, its cells get 2, 4, 8 … times as many sheets; fewer where
// little light is left, which is known when a cell is drawn.
#include "finer_sheets.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "splat_frame.h"
#include "tile_finder.h"

namespace subvol::detail {

namespace {

/// The estimate takes all of the change for an error, of which it is a small part. With up to so many tolerances for a kernel,
/// hardly a pixel of the meshes in docs/adr/0030 is off by more than one.
constexpr double kMostOfEstimate = 25;

/// The distance of sheets, in reaches, below which no kernel is thin: about that of `sheets_needed`.
float enough_reaches(const SplatScene& scene) {
    return static_cast<float>(std::sqrt(scene.image_tolerance / 1e-3) / 3);
}

/// How much extinction and emission (the one of the four that changes most) change between values.
class Variation {
public:
    explicit Variation(const PreintegratedTable& table) : sums_(table.rows.size(), 0.0f) {
        for (std::size_t i = 1; i < sums_.size(); ++i) {
            float most = 0;
            for (std::size_t c = 0; c < 4; ++c)
                most = std::max(most, std::abs(table.rows[i].mean[c] - table.rows[i - 1].mean[c]));
            sums_[i] = sums_[i - 1] + most;
        }
    }
    /// The change between values from low to high, in cells.
    [[nodiscard]] float between(float low, float high) const { return at(high) - at(low); }
    [[nodiscard]] float all() const { return sums_.back(); }

private:
    /// Row i is of the values from i − 1 to i.
    [[nodiscard]] float at(float x) const {
        const float place = std::clamp(x + 0.5f, 0.0f, static_cast<float>(sums_.size() - 1));
        const auto row = std::min(static_cast<std::size_t>(place), sums_.size() - 2);
        return std::lerp(sums_[row], sums_[row + 1], place - static_cast<float>(row));
    }
    std::vector<float> sums_;
};

class Estimate {
public:
    explicit Estimate(const SplatFrame& frame)
        : sheets_(frame.sheets),
          variation_(frame.classification->table),
          perspective_(frame.view->perspective()),
          most_(static_cast<float>(kMostOfEstimate * frame.scene->image_tolerance)),
          enough_(enough_reaches(*frame.scene)) {}

    /// The level that a kernel needs.
    [[nodiscard]] int level(const EyeSplat& s) const {
        // The ray through the middle leaves the axis of the kernel's sections by (x, y) for each unit of depth.
        const float across = perspective_ ? 1 / std::max(sheets_.middle + s.depth, sheets_.distance) : 0;
        const float x = s.center_x * across - s.shear_x, y = s.center_y * across - s.shear_y;
        const float along_row = s.root_xx * x + s.root_xy * y, across_row = s.root_yy * y;
        const float reach = 1 / std::sqrt(s.inv_szz + along_row * along_row + across_row * across_row);
        if (!exceeds(variation_.all(), sheets_.distance, reach)) return 0;
        const float slope = std::abs(s.value_slope + s.gradient_x * x + s.gradient_y * y);
        const float rise = slope * reach + std::abs(s.moment), change = variation_.between(s.value - rise, s.value + rise);
        int level = 0;
        float distance = sheets_.distance;
        for (; level < FinerSheets::kMostLevel && exceeds(change, distance, reach); distance *= 0.5f) ++level;
        return level;
    }

private:
    [[nodiscard]] bool exceeds(float change, float distance, float reach) const {
        return distance > enough_ * reach && change * distance * std::min(1.0f, distance / reach) > most_;
    }

    const SheetStack& sheets_;
    Variation variation_;
    bool perspective_;
    float most_;
    float enough_;
};

/// Raises a cell to a level.
void raise(std::atomic<std::uint8_t>& cell, std::uint8_t level) {
    std::uint8_t before = cell.load(std::memory_order_relaxed);
    while (before < level && !cell.compare_exchange_weak(before, level, std::memory_order_relaxed)) {
    }
}

}  // namespace

bool may_be_thin(const SplatScene& scene, const SheetStack& sheets) {
    return sheets.distance > enough_reaches(scene) * scene.thinnest;
}

FinerSheets finer_sheets(const SplatFrame& frame) {
    const SheetStack& sheets = frame.sheets;
    if (!may_be_thin(*frame.scene, sheets)) return {};
    const auto cells_in = [](int count, int size) { return (count + size - 1) / size; };
    FinerSheets finer{.columns = cells_in(frame.view->width(), FinerSheets::kSide_px),
                      .rows = cells_in(frame.view->height(), FinerSheets::kSide_px),
                      .layers = cells_in(sheets.count, FinerSheets::kSheets)};
    std::vector<std::atomic<std::uint8_t>> levels(static_cast<std::size_t>(finer.columns * finer.rows) *
                                                  static_cast<std::size_t>(finer.layers));
    std::atomic<bool> any = false;
    const Estimate estimate(frame);
    const TileFinder finder(frame);
    // The layer of the first sheet behind a depth, where the stretch that has this depth in it ends.
    const auto layer_of = [&](float z) {
        const float place = std::clamp((z - sheets.first) / sheets.distance, 0.0f, static_cast<float>(sheets.count - 1));
        return std::min(static_cast<int>(place) + 1, sheets.count - 1) / FinerSheets::kSheets;
    };
    const auto raise_cells = [&](const EyeSplat& s, int level) {
        const PixelBox px = finder.pixels_of(s);
        if (px.x1 < px.x0 || px.y1 < px.y0) return;
        any.store(true, std::memory_order_relaxed);
        const float reach = 1 / std::sqrt(s.inv_szz);
        const int first = layer_of(s.depth - reach), last = layer_of(s.depth + reach);
        for (int y = px.y0 / FinerSheets::kSide_px; y <= px.y1 / FinerSheets::kSide_px; ++y) {
            for (int x = px.x0 / FinerSheets::kSide_px; x <= px.x1 / FinerSheets::kSide_px; ++x) {
                for (int z = first; z <= last; ++z) {
                    raise(levels[static_cast<std::size_t>((y * finer.columns + x) * finer.layers + z)],
                          static_cast<std::uint8_t>(level));
                }
            }
        }
    };
    const auto& splats = frame.kernels.splats;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, splats.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const int level = estimate.level(splats[i]);
            if (level > 0) raise_cells(splats[i], level);
        }
    });
    if (any) finer.levels.assign(levels.begin(), levels.end());
    return finer;
}

}  // namespace subvol::detail
