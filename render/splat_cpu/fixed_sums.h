// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "splat_frame.h"
#include "subvol/fixed_sums.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// The kinds of sums: Σw, Σwv, Σwv of the colour's channel and the three parts of Σw∇v.
inline constexpr std::size_t kKindsOfSums = 6;

/// How many steps a unit of each kind has: powers of two, so large that no sum of all kernels overflows.
///
/// most: terms beyond are taken for this much, which rounding alone can bring about
/// slot: the place among the sums that are made; −1: this kind is not
struct FixedScale {
    std::array<double, kKindsOfSums> per_unit{};
    std::array<float, kKindsOfSums> most{};
    std::array<int, kKindsOfSums> slot{};
    std::size_t sums = 0;
};

/// The sums of a tile. batches: of each batch of sheets, [sheet][sum][pixel of the tile]; empty: nothing was added. ends: of
/// the ends of the intervals of its pixels, [end][sum]; empty: nothing was added.
struct TileSums {
    static constexpr std::size_t kPixels = static_cast<std::size_t>(SplatFrame::kTile_px) * SplatFrame::kTile_px;

    std::vector<std::vector<std::int64_t>> batches;
    std::vector<std::int64_t> ends;
};

/// Marks the batches with sheets between two depths, and with the next sheet on either side.
inline void want_batches(const SheetStack& sheets, float enter, float exit, std::vector<char>& wanted) {
    const auto batch = [&](float z, float more) {
        const float sheet = std::clamp((z - sheets.first) / sheets.distance + more, 0.0f, static_cast<float>(sheets.count - 1));
        return static_cast<std::size_t>(sheet) / kBatch;
    };
    for (std::size_t b = batch(enter, -1.01f); b <= batch(exit, 1.01f); ++b) wanted[b] = 1;
}

/// Bounds of kernels in eye space.
[[nodiscard]] SumBounds bounds_of_sums(const SplatScene& scene, const EyeSplats& kernels);

/// throws: Error(InvalidInput) if the steps would be too coarse: values or gradients are too large for so many kernels
[[nodiscard]] FixedScale scale_of_sums(const SplatScene& scene, const SumBounds& bounds);

/// Sums the kernels of a tile on all sheets that its rays need, and at the ends of its intervals.
void sum_tile(const SplatFrame& frame, const FixedScale& scale, int tile, TileSums& sums);

/// Draws a tile of sums. frame: gets the ends of its intervals
void draw_summed_tile(SplatFrame& frame, const FixedScale& scale, const TileSums& sums, int tile, Drawn& drawn);

/// Draws a frame by sums in fixed point, with other processes or alone. frame: as `prepare_frame` leaves it, with the kernels
/// of this process and the boundary of all
///
/// samples: along each side of a pixel of the picture
/// throws:  Error(InvalidInput) without a boundary, for shadows and ambient occlusion, for too many sheets, and as
///          `scale_of_sums`
[[nodiscard]] Drawn draw_fixed(SplatFrame& frame, const FixedSums& how, int samples, Progress* progress,
                               FixedSumsReport& report);

}  // namespace subvol::detail
