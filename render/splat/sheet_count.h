// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "splat_scene.h"

namespace subvol::detail {

// The steps of `make_sheets`, for pictures whose kernels are in several processes, or not all in memory.

/// The eye depths between which there is something to be seen; nothing before `near` is.
struct DepthRange {
    double min, max, near;
};
[[nodiscard]] DepthRange depth_range_of(const SplatScene& scene, const View& view);

/// The distance in depth from a kernel's middle to where it ends.
[[nodiscard]] float depth_reach(const SplatScene& scene, const View& view, const Symmetric3& frame);

/// The distances in depth from the kernels' middles to where they end, one for each kernel.
[[nodiscard]] std::vector<float> depth_reaches(const SplatScene& scene, const View& view);

/// The number of sheets that kernels need: that of the reach which one kernel in twenty has, or a smaller one.
///
/// kernels:  how many there are, in all processes
/// in_place: the reach in a place, from 0, of all reaches in ascending order
template <class InPlace>
[[nodiscard]] int sheets_needed(std::size_t kernels, double depth_range, const InPlace& in_place) {
    // A kernel's section changes over its reach like (1−e)³: linear interpolation between sheets this far apart is right to
    // about 1e-3 of what the kernel adds (measured against the dense grid, see docs/science.md).
    constexpr double kSheetsPerReach = 4;
    constexpr double kFinestShare = 0.05;  // of the kernels: these may have fewer sheets, so that a few slivers do not decide
    constexpr int kFewestSheets = 64, kMostSheets = 2048;
    if (kernels == 0) return kFewestSheets;
    const double finest = double{in_place(static_cast<std::size_t>(kFinestShare * static_cast<double>(kernels - 1)))};
    const double needed = kSheetsPerReach * depth_range / std::max(finest, 1e-9 * depth_range);
    return static_cast<int>(std::clamp(std::ceil(needed) + 1, double{kFewestSheets}, double{kMostSheets}));
}

}  // namespace subvol::detail
