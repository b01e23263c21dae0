// SPDX-License-Identifier: Apache-2.0
// Sums of kernels over one tile and one batch of sheets. Included once for every instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_SUMS_INL_H
#undef SUBVOL_SPLAT_SUMS_INL_H
#else
#define SUBVOL_SPLAT_SUMS_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "splat_frame.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using IntLanes = hn::RebindToSigned<Lanes>;
using Floats = hn::Vec<Lanes>;
using Ints = hn::Vec<IntLanes>;
using Mask = hn::Mask<Lanes>;

/// Pixels are handled in blocks of one vector, which are as square as possible.
constexpr std::size_t kBlock = hn::MaxLanes(Lanes());
constexpr std::size_t kBlockWidth = kBlock < 4 ? kBlock : 4, kBlockHeight = kBlock / kBlockWidth;
constexpr std::size_t kTile = SplatFrame::kTile_px;
constexpr std::size_t kColumns = kTile / kBlockWidth, kRows = kTile / kBlockHeight, kBlocks = kColumns * kRows;

/// The sums for each pixel and sheet: Σw, Σwv, and if needed Σwv of the colour's channel and Σw∇v.
constexpr std::size_t kWeight = 0, kValue = 1, kColor = 2, kGradient = 3, kSums = kGradient + 3;

/// Lists kernels by the groups that `each_group` visits for a kernel, in their order: a counting sort. offsets: of each group's
/// list in `lists`, and the end
inline void list_by(std::size_t groups, std::span<const std::uint32_t> kernels, std::vector<std::size_t>& offsets,
                    std::vector<std::uint32_t>& lists, const auto& each_group) {
    offsets.assign(groups + 1, 0);
    for (const std::uint32_t id : kernels) each_group(id, [&](std::size_t g) { ++offsets[g + 1]; });
    for (std::size_t g = 1; g < offsets.size(); ++g) offsets[g] += offsets[g - 1];
    lists.resize(offsets.back());
    for (const std::uint32_t id : kernels) each_group(id, [&](std::size_t g) { lists[offsets[g]++] = id; });
    std::rotate(offsets.begin(), offsets.end() - 1, offsets.end());  // each offset has become that of the next group
    offsets.front() = 0;
}

/// The places of the pixels of a tile: the slopes of their rays, which do not depend on the division into tiles.
struct TilePixels {
    HWY_ALIGN float x[kColumns * kBlock];
    HWY_ALIGN float y[kRows * kBlock];
    float left = 0, top = 0;  // of the tile, in pixels
};

/// Sets the places of the pixels of the tile whose first pixel is (x0, y0).
HWY_ATTR inline void place_pixels(const View& view, int x0, int y0, TilePixels& tile) {
    const auto pixel = static_cast<float>(view.pixel());
    const float mid_x = 0.5f * static_cast<float>(view.width()), mid_y = 0.5f * static_cast<float>(view.height());
    tile.left = static_cast<float>(x0);
    tile.top = static_cast<float>(y0);
    for (std::size_t column = 0; column < kColumns; ++column) {
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const float x = tile.left + static_cast<float>(column * kBlockWidth + lane % kBlockWidth) + 0.5f;
            tile.x[column * kBlock + lane] = (x - mid_x) * pixel;
        }
    }
    for (std::size_t row = 0; row < kRows; ++row) {
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const std::size_t down = row * kBlockHeight + lane / kBlockWidth;
            const float y = tile.top + static_cast<float>(down) + 0.5f;
            tile.y[row * kBlock + lane] = (mid_y - y) * pixel;
        }
    }
}

/// The sections of a kernel with the sheets of a batch, and the blocks that they may touch.
struct Cuts {
    HWY_ALIGN float zs[kBatch], x[kBatch], y[kBatch], e[kBatch], v[kBatch];
    std::int32_t column0[kBatch], column1[kBatch], row0[kBatch], row1[kBatch];
};

struct BatchView {
    HWY_ALIGN float depth[kBatch];
    HWY_ALIGN float across[kBatch];  // world length of a unit of slope
    HWY_ALIGN float to_pixels[kBatch];
    float mid_x, mid_y;
    int begin = 0, end = kBatch;  // the sheets of the batch that are summed
    // For each sheet, the blocks of each row whose sums are needed, the last one included.
    std::int32_t first_column[kBatch][kRows], last_column[kBatch][kRows];

    void need_all() {
        std::fill_n(first_column[0], kBatch * kRows, 0);
        std::fill_n(last_column[0], kBatch * kRows, static_cast<std::int32_t>(kColumns) - 1);
    }

    /// sheets: of each block of a row, one bit for each sheet on which it is needed
    void need(std::size_t row, const std::uint8_t* sheets) {
        for (int k = 0; k < kBatch; ++k) {
            first_column[k][row] = static_cast<std::int32_t>(kColumns);
            last_column[k][row] = -1;
        }
        std::uint32_t left = 0, right = 0;  // the sheets whose first block, and last block, was found
        for (std::size_t i = 0; i < kColumns; ++i) {
            for (std::uint32_t bits = sheets[i] & ~left; bits != 0; bits &= bits - 1) {
                first_column[std::countr_zero(bits)][row] = static_cast<std::int32_t>(i);
            }
            left |= sheets[i];
            const std::size_t j = kColumns - 1 - i;
            for (std::uint32_t bits = sheets[j] & ~right; bits != 0; bits &= bits - 1) {
                last_column[std::countr_zero(bits)][row] = static_cast<std::int32_t>(j);
            }
            right |= sheets[j];
        }
    }
};

constexpr auto kTile_px = static_cast<std::int32_t>(kTile);
constexpr auto kBlockWidth_px = static_cast<std::int32_t>(kBlockWidth),
               kBlockHeight_px = static_cast<std::int32_t>(kBlockHeight);

/// The pixel that a place is in; one before the tile's first or behind its last if it is not in the tile.
HWY_ATTR inline std::int32_t pixel_in_tile(float p) {
    return static_cast<std::int32_t>(std::min(std::max(p, -1.0f), kTile + 0.0f) + 1.0f) - 1;
}

/// Finds the sections of a kernel, and the blocks with pixels whose centres are in boxes around them.
HWY_ATTR inline void cut(const EyeSplat& s, const BatchView& batch, const TilePixels& tile, Cuts& cuts) {
    for (std::size_t k = 0; k < kBatch; ++k) {
        const float zs = batch.depth[k] - s.depth, left = 1.0f - zs * zs * s.inv_szz;
        const float root = std::sqrt(std::max(left, 0.0f)), margin = left > 0 ? kPastCenter_px : 1e9f;
        const float x = s.center_x + s.shear_x * zs, y = s.center_y + s.shear_y * zs;
        cuts.zs[k] = zs;
        cuts.x[k] = x;
        cuts.y[k] = y;
        cuts.e[k] = zs * zs * s.inv_szz;
        cuts.v[k] = s.value + zs * s.value_slope;
        const float scale = batch.to_pixels[k];  // pixels from the tile's corner
        const float px = x * scale + (batch.mid_x - tile.left), hx = s.extent_x * root * scale - margin;
        const float py = (batch.mid_y - tile.top) - y * scale, hy = s.extent_y * root * scale - margin;
        const std::int32_t x0 = pixel_in_tile(px - hx), x1 = pixel_in_tile(px + hx);
        const std::int32_t y0 = pixel_in_tile(py - hy), y1 = pixel_in_tile(py + hy);
        const bool some = x0 <= x1 && y0 <= y1;
        cuts.column0[k] = std::max(x0, 0) / kBlockWidth_px;
        cuts.column1[k] = (some ? std::min(x1, kTile_px - 1) + kBlockWidth_px : 0) / kBlockWidth_px - 1;
        cuts.row0[k] = std::max(y0, 0) / kBlockHeight_px;
        cuts.row1[k] = (some ? std::min(y1, kTile_px - 1) + kBlockHeight_px : 0) / kBlockHeight_px - 1;
    }
}

/// Adds a compact kernel with one value: the loop in which most pictures spend their time.
HWY_ATTR inline void add_plain(const EyeSplat& s, const BatchView& batch, const TilePixels& tile, Cuts& cuts, float* sums) {
    const Lanes d;
    cut(s, batch, tile, cuts);
    const auto rxx = hn::Set(d, s.root_xx), gx = hn::Set(d, s.gradient_x), moment = hn::Set(d, s.moment);
    const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d);
    for (int k = batch.begin; k < batch.end; ++k) {
        const auto across = hn::Set(d, batch.across[k]), x = hn::Set(d, cuts.x[k]), y = hn::Set(d, cuts.y[k]);
        for (auto row = cuts.row0[k]; row <= cuts.row1[k]; ++row) {
            const auto c0 = std::max(cuts.column0[k], batch.first_column[k][row]);
            const auto c1 = std::min(cuts.column1[k], batch.last_column[k][row]);
            if (c0 > c1) continue;
            const auto dy = hn::MulSub(hn::Load(d, tile.y + static_cast<std::size_t>(row) * kBlock), across, y);
            const auto across_row = hn::Mul(hn::Set(d, s.root_yy), dy);
            const auto e_row = hn::MulAdd(across_row, across_row, hn::Set(d, cuts.e[k]));
            const auto e_slope = hn::Mul(hn::Set(d, s.root_xy), dy);
            const auto v_row = hn::MulAdd(hn::Set(d, s.gradient_y), dy, hn::Set(d, cuts.v[k]));
            float* to = sums + ((static_cast<std::size_t>(k) * kRows + static_cast<std::size_t>(row)) * kColumns +
                                static_cast<std::size_t>(c0)) *
                                   (2 * kBlock);
            for (auto column = c0; column <= c1; ++column, to += 2 * kBlock) {
                const auto dx = hn::MulSub(hn::Load(d, tile.x + static_cast<std::size_t>(column) * kBlock), across, x);
                const auto along_row = hn::MulAdd(rxx, dx, e_slope);
                const auto e = hn::MulAdd(along_row, along_row, e_row);
                const auto left = hn::Max(hn::Sub(one, e), zero);
                const auto w = hn::Mul(hn::Mul(left, left), left);
                const auto v = hn::MulAdd(moment, e, hn::MulAdd(gx, dx, v_row));
                hn::Store(hn::Add(hn::Load(d, to), w), d, to);
                hn::Store(hn::MulAdd(w, v, hn::Load(d, to + kBlock)), d, to + kBlock);
            }
        }
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
