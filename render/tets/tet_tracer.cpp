// SPDX-License-Identifier: Apache-2.0
#include "tet_tracer.h"

namespace subvol::detail {

Segment TetTracer::trace(const Ray& ray) {
    const RayPlane plane(ray);
    ends_.find(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    const double speed = glm::length(ray.direction);
    LitDepth state;
    for (TetFace start; (start = ends_.first_unwalked()) != kNone;) {
        TetFace other = start;
        const WalkOutcome outcome = walk_between(mesh_, plane, start, speed, compositor_, state, other, counts_.segments);
        if (outcome == WalkOutcome::Lost) ++counts_.lost_rays;
        if (outcome == WalkOutcome::Lost || outcome == WalkOutcome::Opaque) break;
        ends_.mark_walked(plane, start, other);
    }
    return state.light;
}

}  // namespace subvol::detail
