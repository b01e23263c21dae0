// SPDX-License-Identifier: Apache-2.0
// Sums of kernels in 64-bit fixed point, whose bits do not depend on the order of the kernels. Included once for every
// instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_FIXED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_FIXED_INL_H
#undef SUBVOL_SPLAT_FIXED_INL_H
#else
#define SUBVOL_SPLAT_FIXED_INL_H
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "fixed_sums.h"
#include "splat_general-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

static_assert(kSums == kKindsOfSums);

/// Adds what a kernel has at one block of pixels to sums in fixed point.
///
/// to: the sum of weights at the first pixel; row and sum: how far the next row of pixels is and the next sum
struct FixedSink {
    const FixedScale& scale;
    std::int64_t* to;
    std::size_t row, sum;

    HWY_ATTR void weight(Floats w) const { put(kWeight, w); }
    HWY_ATTR void product(std::size_t which, Floats w, Floats term) const { put(which, hn::Mul(w, term)); }

private:
    HWY_ATTR void put(std::size_t which, Floats term) const {
        // A double from 2⁵² to 2⁵³ is a whole number, and so are the differences of their bits.
        constexpr double kWhole = 0x1.8p52;
        const Lanes d;
        const auto most = hn::Set(d, scale.most[which]);
        const auto known = hn::IfThenElseZero(hn::Eq(term, term), term);  // beyond the support of a huge kernel is NaN
        HWY_ALIGN float lanes[kBlock];
        hn::Store(hn::Min(hn::Max(known, hn::Neg(most)), most), d, lanes);
        const double per_unit = scale.per_unit[which];
        std::int64_t* sums = to + static_cast<std::size_t>(scale.slot[which]) * sum;
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const double shifted = static_cast<double>(lanes[lane]) * per_unit + kWhole;  // the product is exact
            sums[lane / kBlockWidth * row + lane % kBlockWidth] +=
                std::bit_cast<std::int64_t>(shifted) - std::bit_cast<std::int64_t>(kWhole);
        }
    }
};

/// Sums the kernels of a tile on the sheets that its rays need.
class TileSummer {
public:
    TileSummer(const SplatFrame& frame, const FixedScale& scale) : frame_(frame), scale_(scale), general_(frame) {}

    HWY_ATTR void sum(int tile, TileSums& sums) {
        x0_ = tile % frame_.tiles_x * SplatFrame::kTile_px;
        y0_ = tile / frame_.tiles_x * SplatFrame::kTile_px;
        sums.batches.assign(static_cast<std::size_t>(frame_.sheets.batches()), {});
        const auto first = frame_.tile_offsets[static_cast<std::size_t>(tile)];
        const auto end = frame_.tile_offsets[static_cast<std::size_t>(tile) + 1];
        if (first == end) return;
        place_pixels(*frame_.view, x0_, y0_, tile_);
        find_wanted();
        for (std::size_t i = first; i < end; ++i) {
            const std::uint32_t id = frame_.tile_splats[i];
            const auto [b0, b1] = batches_of(frame_.sheets, frame_.kernels.splats[id]);
            for (int b = b0; b <= b1; ++b) {
                if (wanted_[static_cast<std::size_t>(b)]) add(id, b, sums.batches[static_cast<std::size_t>(b)]);
            }
        }
    }

private:
    /// Finds the batches that rays of the tile need, and the blocks with such rays.
    void find_wanted() {
        const View& view = *frame_.view;
        wanted_.assign(static_cast<std::size_t>(frame_.sheets.batches()), 0);
        met_.assign(kBlocks, 0);
        for (int y = y0_; y < std::min(y0_ + SplatFrame::kTile_px, view.height()); ++y) {
            for (int x = x0_; x < std::min(x0_ + SplatFrame::kTile_px, view.width()); ++x) {
                const auto ray =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) + static_cast<std::size_t>(x);
                const std::size_t first = frame_.intervals.offsets[ray], end = frame_.intervals.offsets[ray + 1];
                for (std::size_t i = first; i < end; ++i) {
                    want_batches(frame_.sheets, frame_.intervals.depths[2 * i], frame_.intervals.depths[2 * i + 1], wanted_);
                }
                if (first == end) continue;
                const auto row = static_cast<std::size_t>(y - y0_) / kBlockHeight;
                met_[row * kColumns + static_cast<std::size_t>(x - x0_) / kBlockWidth] = 1;
            }
        }
        views_.resize(wanted_.size());
        for (std::size_t b = 0; b < views_.size(); ++b) {
            if (wanted_[b]) set_batch(frame_, static_cast<int>(b), views_[b]);
        }
    }

    HWY_ATTR void add(std::uint32_t id, int batch, std::vector<std::int64_t>& sums) {
        constexpr std::size_t kPixels = TileSums::kPixels;
        const EyeSplat& s = frame_.kernels.splats[id];
        general_.each_block(s, views_[static_cast<std::size_t>(batch)], tile_, cuts_,
                            [&](std::size_t k, std::size_t row, std::size_t column, const Offsets& at) HWY_ATTR {
                                if (!met_[row * kColumns + column]) return;
                                if (sums.empty()) sums.assign(kBatch * scale_.sums * kPixels, 0);
                                std::int64_t* to =
                                    sums.data() + k * scale_.sums * kPixels + row * kBlockHeight * kTile + column * kBlockWidth;
                                general_.each_sum(id, s, at, FixedSink{scale_, to, kTile, kPixels});
                            });
    }

    const SplatFrame& frame_;
    const FixedScale& scale_;
    GeneralSums general_;
    TilePixels tile_;
    Cuts cuts_;
    std::vector<char> wanted_, met_;
    std::vector<BatchView> views_;
    int x0_ = 0, y0_ = 0;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
