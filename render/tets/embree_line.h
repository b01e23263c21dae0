// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <embree3/rtcore.h>

#include <optional>

#include "subvol/camera.h"

namespace subvol::detail {

/// throws: Error(MissingCapability) if the device reports an error
void check_embree(RTCDevice device);

/// A query along the whole line of a ray, for a scene that was translated by −center and scaled into the ball of radius 1;
/// nothing if the line misses that ball.
[[nodiscard]] std::optional<RTCRayHit> embree_line(const Ray& ray, const Vec3& center, double scale);

}  // namespace subvol::detail
