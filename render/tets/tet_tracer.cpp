// SPDX-License-Identifier: Apache-2.0
#include "tet_tracer.h"

namespace subvol::detail {

Segment TetTracer::trace(const Ray& ray) {
    clip_.cut(ray, cut_.ray);
    if (cut_.ray.empty()) return {};
    const RayPlane plane(ray);
    ends_.find(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    RayWalker walker(ray, plane, cut_, compositor_, counts_);
    for (TetFace start; (start = ends_.first_unwalked()) != kNone;) {
        const Walk walk = walker.between(mesh_, start);
        if (walk.outcome == WalkOutcome::Lost) ++counts_.lost_rays;
        if (walk.outcome == WalkOutcome::Lost || walk.outcome == WalkOutcome::Opaque) break;
        ends_.mark_walked(plane, start, walk.end);
    }
    return walker.light(optics_);
}

}  // namespace subvol::detail
