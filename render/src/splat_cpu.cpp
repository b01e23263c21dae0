// The readable splatter: a tile at a time, a batch of sheets at a time, front to back. The shader does the same step by step.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "splat_backend.h"

namespace subvol::detail {

namespace {

using Entry = std::array<float, 4>;  // optical depth and emission integrals

class Classifier {
public:
    explicit Classifier(const PreintegratedTable& table)
        : table_(table),
          min_(static_cast<float>(table.min)),
          max_(static_cast<float>(table.max)),
          scale_(static_cast<float>((PreintegratedTable::kSize - 1) / (table.max - table.min))),
          least_(kLeastDifference * static_cast<float>(table.max - table.min)) {}

    /// A stretch of ray from value f0 to f1: optical depth and emitted colour, given its world length.
    void interval(float f0, float f1, float length, float& depth, std::array<float, 3>& color) const {
        if (std::abs(f1 - f0) < least_) {
            const Entry middle = lookup(table_.points, 0.5f * (f0 + f1));
            depth = length * std::max(middle[0], 0.0f);
            const float opacity = 1.0f - std::exp(-depth);
            for (std::size_t c = 0; c < 3; ++c) color[c] = opacity * middle[c + 1];
            return;
        }
        const Entry a = prefix(f0), b = prefix(f1);
        const float difference = b[0] - a[0];
        depth = std::max(length * difference / (f1 - f0), 0.0f);
        const float emission = difference != 0.0f ? 1.0f / difference : 0.0f;
        const float opacity = 1.0f - std::exp(-depth);
        for (std::size_t c = 0; c < 3; ++c) color[c] = opacity * (b[c + 1] - a[c + 1]) * emission;
    }

private:
    [[nodiscard]] Entry lookup(const std::vector<Entry>& rows, float f) const {
        const float at = std::clamp((f - min_) * scale_, 0.0f, static_cast<float>(PreintegratedTable::kSize - 1));
        const float cell = std::min(std::floor(at), static_cast<float>(PreintegratedTable::kSize - 2));
        const auto& low = rows[static_cast<std::size_t>(cell)];
        const auto& high = rows[static_cast<std::size_t>(cell) + 1];
        Entry entry;
        for (std::size_t c = 0; c < 4; ++c) entry[c] = low[c] + (at - cell) * (high[c] - low[c]);
        return entry;
    }

    /// Beyond the table's ends extinction and colour are constant and the integrals go on with them.
    [[nodiscard]] Entry prefix(float f) const {
        Entry entry = lookup(table_.prefixes, f);
        const float beyond = f - std::clamp(f, min_, max_);
        if (beyond == 0.0f) return entry;
        const Entry& end = beyond < 0.0f ? table_.points.front() : table_.points.back();
        entry[0] += beyond * end[0];
        for (std::size_t c = 1; c < 4; ++c) entry[c] += beyond * end[0] * end[c];
        return entry;
    }

    const PreintegratedTable& table_;
    float min_, max_, scale_, least_;
};

struct PixelState {
    float transmittance = 1;
    std::array<float, 3> color{};
    float value = 0;     // on the last sheet
    bool known = false;  // whether the last sheet had a value
    std::uint32_t interval = 0, intervals_end = 0;
};

/// Sums of one batch over one tile.
class BatchSums {
public:
    explicit BatchSums(int tile_px)
        : row_(static_cast<std::size_t>(tile_px)),
          weight_(SplatFrame::kBatch * row_ * row_),
          weighted_(weight_.size()),
          a_(row_),
          b_(row_) {}

    void start_tile(const View& view, int x0, int y0) {
        for (std::size_t i = 0; i < row_; ++i) {
            const Vec2 s = view.slopes(x0 + static_cast<int>(i) + 0.5, y0 + static_cast<int>(i) + 0.5);
            a_[i] = static_cast<float>(s.x);
            b_[i] = static_cast<float>(s.y);
        }
    }

    void clear() {
        std::fill(weight_.begin(), weight_.end(), 0.0f);
        std::fill(weighted_.begin(), weighted_.end(), 0.0f);
    }

    /// Adds a kernel's section by one sheet of the batch.
    void add(const EyeSplat& s, int sheet_in_batch, float depth, bool perspective) {
        const Section cut = section(s, depth, perspective);
        if (cut.half_x < 0) return;
        const auto [x0, x1] = covered(a_, cut.x - cut.half_x, cut.x + cut.half_x);
        const auto [y1, y0] = covered_down(b_, cut.y - cut.half_y, cut.y + cut.half_y);
        const float zs = depth - s.depth, across = perspective ? depth : 1.0f;
        const float center_x = s.center_x + s.shear_x * zs, center_y = s.center_y + s.shear_y * zs;
        const float e0 = zs * zs * s.inv_szz, v0 = s.value + zs * (s.value_slope + s.bend_zz * zs);
        const float slope_x = s.gradient_x + s.bend_zx * zs, slope_y = s.gradient_y + s.bend_zy * zs;
        for (std::size_t y = y0; y < y1; ++y) {
            const float dy = b_[y] * across - center_y;
            const float e_row = e0 + s.conic_yy * dy * dy, e_slope = 2 * s.conic_xy * dy;
            const float v_row = v0 + dy * (slope_y + s.bend_yy * dy), v_slope = slope_x + 2 * s.bend_xy * dy;
            float* weight = &weight_[(static_cast<std::size_t>(sheet_in_batch) * row_ + y) * row_];
            float* weighted = &weighted_[(static_cast<std::size_t>(sheet_in_batch) * row_ + y) * row_];
            for (std::size_t x = x0; x < x1; ++x) {
                const float dx = a_[x] * across - center_x;
                const float e = e_row + dx * (e_slope + s.conic_xx * dx);
                const float left = std::max(1.0f - e, 0.0f), w = left * left * left;
                weight[x] += w;
                weighted[x] += w * (v_row + dx * (v_slope + s.bend_xx * dx));
            }
        }
    }

    [[nodiscard]] float weight(int sheet, std::size_t y, std::size_t x) const { return weight_[at(sheet, y, x)]; }
    [[nodiscard]] float weighted(int sheet, std::size_t y, std::size_t x) const { return weighted_[at(sheet, y, x)]; }

private:
    [[nodiscard]] std::size_t at(int sheet, std::size_t y, std::size_t x) const {
        return (static_cast<std::size_t>(sheet) * row_ + y) * row_ + x;
    }
    /// The pixels of ascending (descending) slopes that lie in [low, high].
    static std::pair<std::size_t, std::size_t> covered(const std::vector<float>& slopes, float low, float high) {
        const auto first = std::lower_bound(slopes.begin(), slopes.end(), low);
        const auto last = std::upper_bound(first, slopes.end(), high);
        return {static_cast<std::size_t>(first - slopes.begin()), static_cast<std::size_t>(last - slopes.begin())};
    }
    static std::pair<std::size_t, std::size_t> covered_down(const std::vector<float>& slopes, float low, float high) {
        const auto first = std::lower_bound(slopes.begin(), slopes.end(), high, std::greater<>());
        const auto last = std::upper_bound(first, slopes.end(), low, std::greater<>());
        return {static_cast<std::size_t>(last - slopes.begin()), static_cast<std::size_t>(first - slopes.begin())};
    }

    std::size_t row_;
    std::vector<float> weight_, weighted_;
    std::vector<float> a_, b_;  // slopes of the tile's columns and rows
};

/// Advances one pixel from the sheet at `near` to the sheet at `far`, cut to what lies inside the boundary.
void composite_interval(PixelState& pixel, const SplatFrame& frame, const Classifier& classifier, float near, float far,
                        float value, bool known, float ray_length) {
    const auto& depths = frame.intervals.depths;
    while (pixel.interval < pixel.intervals_end && depths[2 * pixel.interval] < far) {
        const float enter = std::max(depths[2 * pixel.interval], near), exit = std::min(depths[2 * pixel.interval + 1], far);
        if (exit > enter && (known || pixel.known)) {
            const float step = 1.0f / (far - near);
            const float front = pixel.known ? pixel.value : value, back = known ? value : pixel.value;
            const float f0 = front + (back - front) * (enter - near) * step, f1 = front + (back - front) * (exit - near) * step;
            float depth = 0;
            std::array<float, 3> color{};
            classifier.interval(f0, f1, (exit - enter) * ray_length, depth, color);
            for (std::size_t c = 0; c < 3; ++c) pixel.color[c] += pixel.transmittance * color[c];
            pixel.transmittance *= std::exp(-depth);
        }
        if (depths[2 * pixel.interval + 1] > far) return;  // the interval goes on behind this sheet
        ++pixel.interval;
    }
}

class TileRenderer {
public:
    TileRenderer(const SplatFrame& frame, const View& view, const PreintegratedTable& table)
        : frame_(frame),
          view_(view),
          classifier_(table),
          sums_(frame.tile_px),
          pixels_(static_cast<std::size_t>(frame.tile_px) * static_cast<std::size_t>(frame.tile_px)) {}

    void draw(int tile, Image& image) {
        x0_ = tile % frame_.tiles_x * frame_.tile_px;
        y0_ = tile / frame_.tiles_x * frame_.tile_px;
        width_ = static_cast<std::size_t>(std::min(frame_.tile_px, view_.width() - x0_));
        height_ = static_cast<std::size_t>(std::min(frame_.tile_px, view_.height() - y0_));
        sums_.start_tile(view_, x0_, y0_);
        if (!start_pixels()) return;
        for (int batch = 0; batch < frame_.batches && !done(); ++batch) {
            sum_batch(frame_.bin(tile, batch), batch);
            classify_batch(batch);
        }
        for (std::size_t y = 0; y < height_; ++y) {
            for (std::size_t x = 0; x < width_; ++x) {
                const auto& p = pixels_[y * width_ + x];
                const auto out = image.pixel(x0_ + static_cast<int>(x), y0_ + static_cast<int>(y));
                std::copy(p.color.begin(), p.color.end(), out.begin());
                out[3] = 1 - p.transmittance;
            }
        }
    }

private:
    /// Returns whether any pixel of the tile sees the volume.
    bool start_pixels() {
        bool any = false;
        for (std::size_t y = 0; y < height_; ++y) {
            for (std::size_t x = 0; x < width_; ++x) {
                const std::size_t id = (static_cast<std::size_t>(y0_) + y) * static_cast<std::size_t>(view_.width()) +
                                       static_cast<std::size_t>(x0_) + x;
                PixelState& p = pixels_[y * width_ + x] = {};
                p.interval = frame_.intervals.offsets[id];
                p.intervals_end = frame_.intervals.offsets[id + 1];
                any |= p.interval < p.intervals_end;
            }
        }
        return any;
    }

    [[nodiscard]] bool done() const {
        return std::all_of(pixels_.begin(), pixels_.begin() + static_cast<std::ptrdiff_t>(width_ * height_),
                           [](const PixelState& p) { return p.interval >= p.intervals_end || p.transmittance < kOpaque; });
    }

    void sum_batch(std::size_t bin, int batch) {
        sums_.clear();
        const int first = batch * SplatFrame::kBatch, count = std::min(SplatFrame::kBatch, frame_.sheets - first);
        for (std::uint32_t i = frame_.bin_offsets[bin]; i < frame_.bin_offsets[bin + 1]; ++i) {
            const EyeSplat& splat = frame_.splats[frame_.bin_splats[i]];
            for (int k = 0; k < count; ++k) sums_.add(splat, k, frame_.depth(first + k), view_.perspective());
        }
    }

    void classify_batch(int batch) {
        const int first = batch * SplatFrame::kBatch, count = std::min(SplatFrame::kBatch, frame_.sheets - first);
        for (std::size_t y = 0; y < height_; ++y) {
            for (std::size_t x = 0; x < width_; ++x) {
                PixelState& p = pixels_[y * width_ + x];
                if (p.interval >= p.intervals_end || p.transmittance < kOpaque) continue;
                const Vec2 s = view_.slopes(x0_ + static_cast<int>(x) + 0.5, y0_ + static_cast<int>(y) + 0.5);
                const float ray_length = view_.perspective() ? static_cast<float>(std::sqrt(1 + s.x * s.x + s.y * s.y)) : 1.0f;
                for (int k = 0; k < count; ++k) {
                    const float weight = sums_.weight(k, y, x);
                    const bool known = weight > kLeastWeight;
                    const float value = known ? sums_.weighted(k, y, x) / weight : 0.0f;
                    if (first + k > 0) {
                        composite_interval(p, frame_, classifier_, frame_.depth(first + k - 1), frame_.depth(first + k), value,
                                           known, ray_length);
                    }
                    p.value = value;
                    p.known = known;
                }
            }
        }
    }

    const SplatFrame& frame_;
    const View& view_;
    Classifier classifier_;
    BatchSums sums_;
    std::vector<PixelState> pixels_;
    int x0_ = 0, y0_ = 0;
    std::size_t width_ = 0, height_ = 0;
};

}  // namespace

Image draw_splats_cpu(const SplatFrame& frame, const View& view, const PreintegratedTable& table, Progress* progress) {
    Image image(view.width(), view.height());
    // One report and one look at the cancel flag a row of tiles.
    for (int row = 0; row < frame.tiles_y; ++row) {
        report_progress(progress, "splat", static_cast<double>(row) / frame.tiles_y);
        tbb::parallel_for(0, frame.tiles_x,
                          [&](int column) { TileRenderer(frame, view, table).draw(row * frame.tiles_x + column, image); });
    }
    report_progress(progress, "splat", 1);
    return image;
}

}  // namespace subvol::detail
