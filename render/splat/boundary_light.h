// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "boundary_intervals.h"
#include "splat_scene.h"

namespace subvol::detail {

/// The effect of light on a colour: a factor, and white that is added.
struct BoundaryLight {
    float diffuse = 1, specular = 0;
};

/// The light on a surface. normal, to_eye: of unit length, in eye space
/// arrives: the part of the key light, and of that from all around
[[nodiscard]] BoundaryLight surface_light(const Shading& shading, const Vec3& normal, const Vec3& to_eye,
                                          const std::array<float, 2>& arrives = {1, 1});

/// The light on the boundary where each interval is entered, by its normals there. Unlike surfaces inside the volume, the
/// boundary has an outer side: the key light reaches that side only. Without effect where the eye is inside the volume.
///
/// scene: has shading and the boundary's normals
[[nodiscard]] std::vector<BoundaryLight> entry_lights(const PixelIntervals& intervals, const SplatScene& scene,
                                                      const View& view);

}  // namespace subvol::detail
