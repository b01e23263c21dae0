// SPDX-License-Identifier: Apache-2.0
#include "subvol/lines_in_volume.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "boundary_intervals.h"
#include "clip_intervals.h"
#include "subvol/detail/coverage.h"
#include "subvol/error.h"

// A pixel that a line covers in part is a mean of two pictures: of rays that pass the line, and of rays that end there. The
// first is the whole picture, whatever lies behind. With several lines one after the other, "whole" is what those farther away
// have left:
//
//      eye ───▶ ···│···········│·······│···········        P3 = whole
//               P1 ┘        P2 ┘    P3 ┘                   P2 = (1 − a2) P3 + a2 (ended at 2 + what it lets through · colour) …
//
// Only pixels with a line in the volume are drawn again; of a convex body's edges there is none.

namespace subvol {

using namespace detail;
namespace {

constexpr std::size_t kMostLayers = 2;
constexpr float kBefore = 1 - 2e-4F;  // of a depth: a line on a slice is seen before it

/// The parts of the rays of a picture that are in a volume.
class VolumeDepths {
public:
    VolumeDepths(const Surface& boundary, const View& view, const Clip& clip) : slices_alone_(clip.slices_alone()) {
        Box box;
        for (const Vec3& point : boundary.points) box.add(point);
        const View whole(view.camera(), view.width(), view.height());
        middle_ = whole.to_eye(box.center()).z;
        intervals_ = boundary_intervals(boundary, whole, nearest_depth(whole, box.diagonal()), middle_);
        const RayClip cuts(clip, box.diagonal());
        if (!cuts.empty()) intervals_ = clip_intervals(intervals_, whole, cuts, middle_);
    }

    /// −1: before all of the volume, 1: behind it, 0: within, where `depth` becomes that of a boundary nearby on which the line
    /// lies.
    [[nodiscard]] int side(const LineSample& line, float& depth) const {
        const std::uint32_t first = intervals_.offsets[line.pixel], end = intervals_.offsets[line.pixel + 1];
        if (first == end) return -1;
        const double z = double{line.depth} - middle_;
        const double slack = double{line.slack};
        if (!slices_alone_) {
            if (z - (line.faces_eye ? slack : 0) <= double{intervals_.depths[2 * first]}) return -1;
            if (z + (line.faces_eye ? 0 : slack) >= double{intervals_.depths[2 * end - 1]}) return 1;
        }
        for (std::uint32_t i = first; i < end; ++i) {
            const double at = double{intervals_.depths[2 * i + (line.faces_eye ? 0 : 1)]};
            if (line.faces_eye ? at <= z && z - slack <= at : at >= z && z + slack >= at) {
                depth = static_cast<float>(at + middle_);
                if (line.faces_eye) break;
            }
        }
        return 0;
    }

private:
    bool slices_alone_;
    double middle_ = 0;
    PixelIntervals intervals_;
};

/// Puts lines within a volume into layers.
std::vector<LineLayer> layers_of(std::vector<LineSample> lines, std::size_t pixels) {
    std::sort(lines.begin(), lines.end(), [](const LineSample& a, const LineSample& b) {
        return std::tuple(a.pixel, a.depth, a.cover) < std::tuple(b.pixel, b.depth, b.cover);
    });
    std::vector<LineLayer> layers;
    for (std::size_t i = 0; i < lines.size();) {
        const std::uint32_t pixel = lines[i].pixel;
        std::size_t layer = 0;
        for (; i < lines.size() && lines[i].pixel == pixel; ++i) {
            const LineSample& line = lines[i];
            if (layer < layers.size() && layers[layer].depths[pixel] > 0 && layer + 1 < kMostLayers &&
                line.depth > layers[layer].depths[pixel] + line.slack)
                ++layer;
            if (layer == layers.size()) layers.push_back({std::vector<float>(pixels), std::vector<float>(pixels)});
            float& depth = layers[layer].depths[pixel];
            if (!(depth > 0)) depth = kBefore * line.depth;
            float& cover = layers[layer].covers[pixel];
            cover += (1 - cover) * line.cover;
        }
    }
    return layers;
}

}  // namespace

SortedLines sort_lines(std::span<const LineSample> lines, const Surface& boundary, const View& view, const Clip& clip) {
    SortedLines sorted;
    if (lines.empty()) return sorted;
    const VolumeDepths depths(boundary, view, clip);
    std::vector<LineSample> within;
    const auto width = static_cast<std::uint32_t>(view.width());
    for (LineSample line : lines) {
        const double end = view.ray_end(line.pixel % width + 0.5, static_cast<double>(line.pixel / width) + 0.5);
        if (double{line.depth} - double{line.slack} > end) continue;
        line.depth = std::min(line.depth, static_cast<float>(end));
        const int side = depths.side(line, line.depth);
        (side < 0 ? sorted.before : side > 0 ? sorted.behind : within).push_back(line);
    }
    sorted.within =
        layers_of(std::move(within), static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()));
    return sorted;
}

View ended_at(const LineLayer& layer, const View& view) {
    View ended(view.camera(), view.width(), view.height());
    ended.end_rays(layer.depths);
    return ended;
}

void draw_lines(Image& image, const SortedLines& lines, std::span<const Image> ended, const Vec3& color) {
    const auto fits = [&](const Image& other) { return other.width == image.width && other.height == image.height; };
    if (ended.size() != lines.within.size() || !std::ranges::all_of(ended, fits))
        throw Error(ErrorCode::InvalidInput, "there is not one picture for each layer, of one size", "lines");
    const auto width = static_cast<std::uint32_t>(image.width);
    const auto put = [&](const auto& how, const LineSample& line) {
        how(image, static_cast<int>(line.pixel % width), static_cast<int>(line.pixel / width), color, double{line.cover});
    };
    for (const LineSample& line : lines.behind) put(put_under, line);
    const std::array<float, 4> ink{static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), 1};
    for (std::size_t layer = ended.size(); layer-- > 0;) {
        for (std::size_t pixel = 0; pixel < lines.within[layer].covers.size(); ++pixel) {
            const float cover = lines.within[layer].covers[pixel];
            if (!(cover > 0)) continue;
            const float through = 1 - ended[layer].rgba[4 * pixel + 3];
            for (std::size_t c = 0; c < 4; ++c) {
                float& value = image.rgba[4 * pixel + c];
                value += cover * (ended[layer].rgba[4 * pixel + c] + through * ink[c] - value);
            }
        }
    }
    for (const LineSample& line : lines.before) put(put_over, line);
}

}  // namespace subvol
