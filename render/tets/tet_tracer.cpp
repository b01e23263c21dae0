// SPDX-License-Identifier: Apache-2.0
#include "tet_tracer.h"

#include <algorithm>

#include "tet_walk.h"

namespace subvol::detail {

std::optional<CrossedFace> cross_triangle(const std::array<SeenPoint, 3>& corners) {
    CrossedFace crossed;
    crossed.corner = corners;
    auto& [a, b, c] = crossed.corner;
    auto& [ab, bc, ca] = crossed.side;
    ab = side_of(a, b);
    bc = side_of(b, c);
    if (ab.left != bc.left) return std::nullopt;
    ca = side_of(c, a);
    if (ca.left != ab.left) return std::nullopt;
    if (!ab.left) {  // clockwise: exchange b and c
        std::swap(b, c);
        const EdgeSide old_ab = ab;
        ab = ca.reversed();
        bc = bc.reversed();
        ca = old_ab.reversed();
    }
    return crossed;
}

void RayEnds::add(const RayPlane& plane, TetFace face) {
    if (std::any_of(ends_.begin(), ends_.end(), [&](const WalkEnd& end) { return end.face == face; })) return;
    if (const auto crossed = cross_face(*mesh_, plane, face)) ends_.push_back({face, crossed->crossing().t, false});
}

void RayEnds::add_near(const RayPlane& plane, TetFace face) {
    for (const Index point : mesh_->corners(face)) {
        for (const TetFace other : scene_->faces_at(point)) add(plane, other);
    }
}

void RayEnds::find(const RayPlane& plane, const Ray& ray) {
    hits_.clear();
    ends_.clear();
    scene_->find_crossed(ray, hits_);
    std::ranges::sort(hits_);  // so that what is found does not depend on Embree's tree, which other faces change
    hits_.erase(std::unique(hits_.begin(), hits_.end()), hits_.end());
    for (const TetFace face : hits_) {
        const auto before = ends_.size();
        add(plane, face);
        // In single precision the ray was on the wrong side of an edge: it crosses a neighbour of the face.
        if (ends_.size() == before) add_near(plane, face);
    }
}

TetFace RayEnds::first_unwalked() const {
    const WalkEnd* first = nullptr;
    for (const WalkEnd& end : ends_) {
        if (end.walked) continue;
        if (!first || end.t < first->t || (end.t == first->t && end.face < first->face)) first = &end;
    }
    return first ? first->face : kNone;
}

void RayEnds::mark_walked(const RayPlane& plane, TetFace start, TetFace end) {
    const auto find = [&](TetFace face) {
        return std::find_if(ends_.begin(), ends_.end(), [&](const WalkEnd& e) { return e.face == face; });
    };
    find(start)->walked = true;
    if (find(end) == ends_.end()) {  // missed in single precision, and maybe others beside it too
        add(plane, end);
        add_near(plane, start);
        add_near(plane, end);
    }
    if (const auto found = find(end); found != ends_.end()) found->walked = true;
}

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
