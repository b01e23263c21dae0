// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/camera.h"

namespace subvol::detail {

/// Turns v about a unit axis.
[[nodiscard]] Vec3 turned(const Vec3& v, const Vec3& axis, double angle_deg);

/// Turns a camera about its target: to the right about its up axis, and upwards, at most to 89.9° from the plane across it.
[[nodiscard]] Camera orbited(Camera camera, double right_deg, double up_deg);

/// Moves a camera and its target in the plane of the picture, so that what is at the target moves by (right, up) in heights of
/// the picture.
[[nodiscard]] Camera panned(Camera camera, double right, double up);

/// Makes what is at the target larger by a factor, about a place of the picture, which stays where it is.
///
/// about: right and up from the middle of the picture, in heights of it
[[nodiscard]] Camera zoomed(Camera camera, double factor, const Vec2& about = Vec2(0.0));

/// Moves a camera without turning it, so that it looks at a place.
[[nodiscard]] Camera aimed(Camera camera, const Vec3& place);

/// The same camera with parallel rays, or with perspective: what is at the target keeps its size.
[[nodiscard]] Camera with_parallel_rays(Camera camera, bool parallel);

}  // namespace subvol::detail
