// SPDX-License-Identifier: Apache-2.0
// Pictures by sums in fixed point. Each process sums its own kernels on the tiles of all bands, a round of tiles at a time;
// what belongs to another's band is sent there, if there is something; owners add up and draw.
//
//     round 1: | tiles of band 0 | tiles of band 1 | ...    all are summed by every process, and sent to their owners
//     round 2: | next of band 0  | next of band 1  | ...
#include "fixed_sums.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBytesOfRound = std::size_t{128} << 20;  // of the tiles that are summed at once
constexpr std::size_t kTilesOfRound = 64;                      // of one owner
constexpr int kBitsOfTerm = 51, kBitsOfSum = 62;
constexpr double kFinestNeeded = 0x1p-8;  // the largest step of a value, in cells; of a gradient, in its least change

/// A kernel's bounds: on its ellipsoid each part of its sums is largest where its own term is.
SumBounds bounds_of(const EyeSplat& s, const EyeBend* bend) {
    const double reach = 1 / std::sqrt(static_cast<double>(s.inv_szz));
    const double x = static_cast<double>(s.extent_x), y = static_cast<double>(s.extent_y);
    const auto size = [](float v) { return std::abs(static_cast<double>(v)); };
    SumBounds most;
    most.value = size(s.value) + size(s.value_slope) * reach + size(s.gradient_x) * x + size(s.gradient_y) * y + size(s.moment);
    const double twice = 2 * size(s.moment);
    double gx = twice * size(s.root_xx) + size(s.gradient_x);
    double gy = twice * (size(s.root_xy) + size(s.root_yy)) + size(s.gradient_y);
    double gz = twice / reach + size(s.value_slope);
    if (bend != nullptr) {
        most.value += size(bend->zz) * reach * reach + reach * (size(bend->zx) * x + size(bend->zy) * y) +
                      size(bend->xx) * x * x + 2 * size(bend->xy) * x * y + size(bend->yy) * y * y;
        gx += size(bend->zx) * reach + 2 * (size(bend->xx) * x + size(bend->xy) * y);
        gy += size(bend->zy) * reach + 2 * (size(bend->xy) * x + size(bend->yy) * y);
        gz += 2 * size(bend->zz) * reach + size(bend->zx) * x + size(bend->zy) * y;
    }
    gz += size(s.shear_x) * gx + size(s.shear_y) * gy;
    most.gradient = std::max({gx, gy, gz});
    return most;
}

double bound_of_color(const EyeSplat& s, const EyeColor& c, const EyeBend* bend) {
    EyeSplat as = s;
    as.value = c.value;
    as.value_slope = c.value_slope;
    as.gradient_x = c.gradient_x;
    as.gradient_y = c.gradient_y;
    as.moment = c.moment;
    return bounds_of(as, bend).value;
}

double known(double bound) {
    return std::isfinite(bound) ? bound : 0;  // of a kernel whose frame floats do not hold; it is clamped
}

/// What a weight cannot exceed.
double most_of_weight(const SplatScene& scene) {
    if (scene.form == KernelForm::Compact) return 1;
    double most = 0;
    for (const float w : scene.kernel_table) most = std::max(most, std::abs(static_cast<double>(w)));
    return scene.form == KernelForm::Separable ? most * most * most : most;
}

/// The tiles of each process's band that rays meet.
std::vector<std::vector<int>> tiles_of_bands(const SplatFrame& frame, const FixedSums& how, int samples) {
    const int height = frame.view->height();
    std::vector<int> splits{0, height};
    if (!how.splits.empty()) {
        splits.clear();
        for (const int row : how.splits) splits.push_back(std::min(row * samples, height));
    }
    std::vector<std::vector<int>> tiles(splits.size() - 1);
    for (std::size_t band = 0; band < tiles.size(); ++band) {
        const int first = (splits[band] + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
        const int end = (splits[band + 1] + SplatFrame::kTile_px - 1) / SplatFrame::kTile_px;
        for (int tile = first * frame.tiles_x; tile < end * frame.tiles_x; ++tile) {
            const auto width = static_cast<std::size_t>(frame.view->width());
            const auto x0 = static_cast<std::size_t>(tile % frame.tiles_x * SplatFrame::kTile_px);
            const auto x1 = std::min(x0 + SplatFrame::kTile_px, width);
            const int y0 = tile / frame.tiles_x * SplatFrame::kTile_px, y1 = std::min(y0 + SplatFrame::kTile_px, height);
            bool met = false;
            for (int y = y0; y < y1; ++y) {
                const std::size_t row = static_cast<std::size_t>(y) * width;
                met = met || frame.intervals.offsets[row + x0] < frame.intervals.offsets[row + x1];
            }
            if (met) tiles[band].push_back(tile);
        }
    }
    return tiles;
}

void append(std::string& bytes, const std::vector<std::int64_t>& numbers) {
    bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(std::int64_t));
}

/// A tile as bytes: for each batch, then for the ends whether there is anything; then what there is.
void append(std::string& bytes, const TileSums& sums, const FixedScale& scale, FixedSumsReport& report) {
    for (const auto& batch : sums.batches) bytes.push_back(batch.empty() ? 0 : 1);
    bytes.push_back(sums.ends.empty() ? 0 : 1);
    for (const auto& batch : sums.batches) {
        append(bytes, batch);
        report.tile_batches_sent += batch.empty() ? 0 : 1;
    }
    append(bytes, sums.ends);
    report.ends_sent += sums.ends.size() / scale.sums;
}

void add(const std::string& bytes, std::size_t& at, std::size_t count, std::vector<std::int64_t>& sums) {
    if (sums.empty()) sums.assign(count, 0);
    if (sums.size() != count || bytes.size() - at < count * sizeof(std::int64_t)) {
        throw Error(ErrorCode::InvalidInput, "sums of another process have another size than those of this one");
    }
    for (std::int64_t& sum : sums) {
        std::int64_t more = 0;
        std::memcpy(&more, bytes.data() + at, sizeof more);
        at += sizeof more;
        sum += more;
    }
}

/// Adds a tile of another process. ends: how many numbers its ends have
void add(const std::string& bytes, std::size_t& at, const FixedScale& scale, std::size_t ends, TileSums& sums) {
    const std::size_t flags = at, batches = sums.batches.size();
    if (bytes.size() - at < batches + 1) {
        throw Error(ErrorCode::InvalidInput, "sums of another process end before their tiles do");
    }
    at += batches + 1;
    for (std::size_t b = 0; b < batches; ++b) {
        if (bytes[flags + b] != 0) add(bytes, at, kBatch * scale.sums * TileSums::kPixels, sums.batches[b]);
    }
    if (bytes[flags + batches] != 0) add(bytes, at, ends, sums.ends);
}

/// How many ends the intervals of a tile's pixels have.
std::size_t ends_in(const SplatFrame& frame, int tile) {
    const int x0 = tile % frame.tiles_x * SplatFrame::kTile_px, y0 = tile / frame.tiles_x * SplatFrame::kTile_px;
    const auto width = static_cast<std::size_t>(frame.view->width());
    const std::size_t x1 = std::min(static_cast<std::size_t>(x0 + SplatFrame::kTile_px), width);
    std::size_t intervals = 0;
    for (int y = y0; y < std::min(y0 + SplatFrame::kTile_px, frame.view->height()); ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * width;
        intervals += frame.intervals.offsets[row + x1] - frame.intervals.offsets[row + static_cast<std::size_t>(x0)];
    }
    return 2 * intervals;
}

void check_fixed(const SplatFrame& frame) {
    const auto refuse = [](std::string what, const char* instead) {
        throw Error(ErrorCode::InvalidInput, std::move(what), "sums in fixed point", instead);
    };
    if (frame.scene->half_weight > 0)
        refuse("without a boundary all kernels decide where the volume ends", "a mesh, or points with a boundary");
    if (frame.scene->shadowed()) refuse("shadows and ambient occlusion need all kernels in one process", "a look without them");
    if (frame.sheets.count > kMostFixedSheets) {
        refuse("there are " + std::to_string(frame.sheets.count) + " sheets", "at most 4096");
    }
}

}  // namespace

SumBounds bounds_of_sums(const SplatScene& scene, const EyeSplats& kernels) {
    const std::size_t count = kernels.splats.size();
    SumBounds all = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, count, 4096), SumBounds{},
        [&](const auto& range, SumBounds most) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const SumBounds of = bounds_of(kernels.splats[i], scene.bent ? &kernels.bends[i] : nullptr);
                most.value = std::max(most.value, known(of.value));
                most.gradient = std::max(most.gradient, known(of.gradient));
                if (!scene.color_channel) continue;
                most.color = std::max(most.color, known(bound_of_color(kernels.splats[i], kernels.colors[i],
                                                                       scene.bent ? &kernels.color_bends[i] : nullptr)));
            }
            return most;
        },
        [](SumBounds a, const SumBounds& b) {
            a.add(b);
            return a;
        });
    all.kernels = count;
    return all;
}

FixedScale scale_of_sums(const SplatScene& scene, const SumBounds& bounds) {
    const double weight = most_of_weight(scene),
                 least = static_cast<double>(kLeastChange) * PreintegratedTable::kCells / scene.diagonal;
    const auto bits_of_count = static_cast<int>(std::bit_width(std::max<std::uint64_t>(bounds.kernels, 1) - 1));
    FixedScale scale;
    const auto set = [&](std::size_t kind, double bound, double coarsest) {
        int bits = 0;
        (void)std::frexp(std::max(1.01 * weight * bound, 1e-30), &bits);  // it is below 2^bits
        const int steps = std::min(kBitsOfTerm - bits, kBitsOfSum - bits - bits_of_count);
        if (std::ldexp(1.0, -steps) > coarsest) {
            throw Error(ErrorCode::InvalidInput,
                        "kernels have values or gradients of up to " + number_text(bound) +
                            " cells of the transfer function, and sums of " + std::to_string(bounds.kernels) +
                            " of them in 64 bits would be too coarse",
                        "sums in fixed point", "a wider range of the transfer function, or sums of floats");
        }
        scale.per_unit[kind] = std::ldexp(1.0, steps);
        scale.most[kind] = static_cast<float>(std::ldexp(1.0, bits));
        scale.slot[kind] = static_cast<int>(scale.sums++);
    };
    scale.slot.fill(-1);
    set(0, 1, kFinestNeeded);
    set(1, bounds.value, kFinestNeeded);
    if (scene.color_channel) set(2, bounds.color, kFinestNeeded);
    for (std::size_t axis = 0; axis < 3 && scene.shading; ++axis) set(3 + axis, bounds.gradient, kFinestNeeded * least);
    return scale;
}

Drawn draw_fixed(SplatFrame& frame, const FixedSums& how, int samples, Progress* progress, FixedSumsReport& report) {
    check_fixed(frame);
    const SumBounds own = bounds_of_sums(*frame.scene, frame.kernels);
    const FixedScale scale = scale_of_sums(*frame.scene, how.join ? how.join(own) : own);
    report.sums = scale.sums;
    const View& view = *frame.view;
    Drawn drawn{Image(view.width(), view.height()), {}};
    drawn.depth.assign(drawn.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    frame.ends.assign(frame.intervals.depths.size(), {});
    if (frame.intervals.offsets.empty()) return drawn;

    const std::vector<std::vector<int>> bands = tiles_of_bands(frame, how, samples);
    std::size_t most = 0;
    for (const auto& tiles : bands) most = std::max(most, tiles.size());
    const auto batches = static_cast<std::size_t>(frame.sheets.batches());
    const std::size_t bytes_of_tile = batches * kBatch * scale.sums * TileSums::kPixels * sizeof(std::int64_t);
    const std::size_t per_band = std::clamp<std::size_t>(kBytesOfRound / (bands.size() * bytes_of_tile), 1, kTilesOfRound);
    const auto of_round = [&](std::size_t band, std::size_t begin) {
        const auto& tiles = bands[band];
        return std::span(tiles).subspan(std::min(begin, tiles.size()),
                                        std::min(per_band, tiles.size() - std::min(begin, tiles.size())));
    };
    std::vector<std::vector<TileSums>> sums(bands.size());
    for (std::size_t begin = 0; begin < most; begin += per_band) {
        report_progress(progress, "splat", static_cast<double>(begin) / static_cast<double>(most));
        std::vector<std::pair<std::size_t, std::size_t>> work;  // a band and one of its tiles
        for (std::size_t band = 0; band < bands.size(); ++band) {
            sums[band].resize(of_round(band, begin).size());
            for (std::size_t i = 0; i < sums[band].size(); ++i) work.emplace_back(band, i);
        }
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, work.size(), 1), [&](const auto& range) {
            for (std::size_t w = range.begin(); w < range.end(); ++w) {
                const auto [band, i] = work[w];
                sum_tile(frame, scale, of_round(band, begin)[i], sums[band][i]);
            }
        });
        for (const auto& of_band : sums) {
            for (const TileSums& of : of_band) {
                for (const auto& batch : of.batches) report.tile_batches += batch.empty() ? 0 : 1;
            }
        }
        const auto mine = of_round(how.own, begin);
        if (how.exchange) {
            std::vector<std::string> to(bands.size());
            for (std::size_t band = 0; band < bands.size(); ++band) {
                if (band == how.own) continue;
                for (TileSums& of : sums[band]) {
                    append(to[band], of, scale, report);
                    of = {};
                }
            }
            const std::vector<std::string> got = how.exchange(std::move(to));
            for (std::size_t from = 0; from < got.size(); ++from) {
                std::size_t at = 0;
                for (std::size_t i = 0; from != how.own && i < mine.size(); ++i) {
                    add(got[from], at, scale, ends_in(frame, mine[i]) * scale.sums, sums[how.own][i]);
                }
            }
        }
        tbb::parallel_for(std::size_t{0}, mine.size(),
                          [&](std::size_t i) { draw_summed_tile(frame, scale, sums[how.own][i], mine[i], drawn); });
    }
    report_progress(progress, "splat", 1);
    return drawn;
}

}  // namespace subvol::detail
