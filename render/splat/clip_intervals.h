// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "boundary_intervals.h"
#include "splat_scene.h"
#include "subvol/detail/ray_clip.h"

namespace subvol::detail {

/// Whether rays are shortened by the clip of a scene, or by the ends that a view has given them.
[[nodiscard]] bool has_cuts(const SplatScene& scene, const View& view);

/// What a clip and the ends of rays leave of intervals, with its slices as intervals without length.
///
/// middle: the depth that those of the intervals are relative to
[[nodiscard]] PixelIntervals clip_intervals(const PixelIntervals& intervals, const View& view, const RayClip& clip,
                                            double middle);

/// The same for some rows of the picture, by this thread alone.
///
/// first_row: the first of those that the intervals are of
[[nodiscard]] PixelIntervals clip_rows(const PixelIntervals& intervals, int first_row, const View& view, const RayClip& clip,
                                       double middle);

/// The intervals in which the rays of a picture are inside what is left of a scene's volume. No offsets if there is neither a
/// boundary nor a clip. Where the eye is inside a solid, a slice at the nearest depth shows the material there (Shading).
[[nodiscard]] PixelIntervals scene_intervals(const SplatScene& scene, const View& view, const SheetStack& sheets);

}  // namespace subvol::detail
