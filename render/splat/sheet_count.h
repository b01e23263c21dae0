// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Which of the ascending reaches of so many kernels, at least one, decides the number of sheets.
[[nodiscard]] std::size_t place_of_finest(std::size_t kernels);

/// The number of sheets for the reach in that place.
[[nodiscard]] int sheets_for_reach(float finest, double depth_range);

}  // namespace subvol::detail
