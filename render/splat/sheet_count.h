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

/// What the number of sheets depends on: the sum over all kernels, whatever processes they are in.
struct SheetCounts {
    ReachCounts reaches;  // the distance in depth from a kernel's middle to where it ends
    ReachCounts bends;    // as of `count_bends`

    void add_up(const SumCounts& sum) {
        reaches.add_up(sum);
        bends.add_up(sum);
    }
};

/// Counts the reaches of kernels of the scene, which may be others than its own.
void count_reaches(const SplatScene& scene, const View& view, const RbfVolume& kernels, ReachCounts& counts);

/// Counts kernels by how much they bend: the part of their value at the end of their reach that does not change in proportion
/// to the distance, beside the part that does. It is small where many kernels show one wave of the field: 1 / (their number)
/// for the same field.
void count_bends(const SplatScene& scene, const RbfVolume& kernels, ReachCounts& counts);

/// The number of sheets that kernels need for the tolerance of the scene.
[[nodiscard]] int sheets_needed(const SplatScene& scene, const DepthRange& depths, const SheetCounts& counts);

}  // namespace subvol::detail
