// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "splat_scene.h"
#include "subvol/detail/reach_counts.h"

namespace subvol::detail {

// The steps of `make_sheets`, for pictures whose kernels are in several processes, or not all in memory.

/// The eye depths between which there is something to be seen; nothing before `near` is.
struct DepthRange {
    double min, max, near;
};
[[nodiscard]] DepthRange depth_range_of(const SplatScene& scene, const View& view);

/// Counts a kernel by its reach: the distance in depth from its middle to where it ends.
void count_reach(const SplatScene& scene, const View& view, const Symmetric3& frame, ReachCounts& counts);

/// The number of sheets that kernels need for the tolerance of the scene.
[[nodiscard]] int sheets_needed(const SplatScene& scene, const DepthRange& depths, const ReachCounts& counts);

}  // namespace subvol::detail
