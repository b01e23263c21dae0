// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "boundary_intervals.h"
#include "splat_scene.h"
#include "subvol/shading.h"

namespace subvol::detail {

/// The light on the boundary where each interval is entered, by its normals there. Unlike surfaces inside the volume, the
/// boundary has an outer side: the key light reaches that side only. Without effect where the eye is inside the volume.
///
/// scene: has shading and the boundary's normals
[[nodiscard]] std::vector<SurfaceLight> entry_lights(const PixelIntervals& intervals, const SplatScene& scene,
                                                     const View& view);

}  // namespace subvol::detail
