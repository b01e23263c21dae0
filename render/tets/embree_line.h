// SPDX-License-Identifier: Apache-2.0
#pragma once

#if SUBVOL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <optional>
#include <string>

#include "subvol/camera.h"
#include "subvol/error.h"

namespace subvol::detail {

/// throws: Error(MissingCapability) if the device reports an error
inline void check_embree(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw Error(ErrorCode::MissingCapability, error == RTC_ERROR_OUT_OF_MEMORY
                                                  ? "Embree has not enough memory"
                                                  : "Embree failed with error " + std::to_string(static_cast<int>(error)));
}

#if SUBVOL_EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
#else
using EmbreeContext = RTCIntersectContext;
#endif

/// Calls the functions of the scene's geometry for the line of `query`, with `context`.
inline void intersect(RTCScene scene, EmbreeContext& context, RTCRayHit& query) {
#if SUBVOL_EMBREE_MAJOR >= 4
    rtcInitRayQueryContext(&context);
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &query, &arguments);
#else
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &query);
#endif
}

/// A query along the whole line of a ray, for a scene that was translated by −center and scaled into the ball of radius 1;
/// nothing if the line misses that ball.
[[nodiscard]] inline std::optional<RTCRayHit> embree_line(const Ray& ray, const Vec3& center, double scale) {
    constexpr double kReach = 1.1;  // the volume lies in a ball of radius 1; the rest is for rounding
    const Vec3 d = glm::normalize(ray.direction);
    Vec3 nearest = scale * (ray.origin - center);
    nearest -= dot(nearest, d) * d;
    if (!(dot(nearest, nearest) <= kReach)) return std::nullopt;
    const Vec3 origin = nearest - kReach * d;

    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x);
    query.ray.org_y = static_cast<float>(origin.y);
    query.ray.org_z = static_cast<float>(origin.z);
    query.ray.dir_x = static_cast<float>(d.x);
    query.ray.dir_y = static_cast<float>(d.y);
    query.ray.dir_z = static_cast<float>(d.z);
    query.ray.tfar = static_cast<float>(2 * kReach);
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return query;
}

}  // namespace subvol::detail
