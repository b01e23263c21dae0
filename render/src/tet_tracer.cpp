#include "tet_tracer.h"

#include <algorithm>

namespace subvol {

void TetTracer::add_end(const RayPlane& plane, TetFace face) {
    if (std::any_of(ends_.begin(), ends_.end(), [&](const End& end) { return end.face == face; })) return;
    if (const auto crossed = cross_face(mesh_, plane, face)) ends_.push_back({face, crossed->crossing().t, false});
}

void TetTracer::add_ends_near(const RayPlane& plane, TetFace face) {
    for (const Index point : mesh_.corners(face)) {
        for (const TetFace other : scene_.faces_at(point)) add_end(plane, other);
    }
}

void TetTracer::find_ends(const RayPlane& plane, const Ray& ray) {
    hits_.clear();
    ends_.clear();
    scene_.find_crossed(ray, hits_);
    for (const TetFace face : hits_) {
        const auto before = ends_.size();
        add_end(plane, face);
        // Single precision took the wrong side of an edge: the face that the ray does cross is a neighbour.
        if (ends_.size() == before) add_ends_near(plane, face);
    }
}

TetTracer::End* TetTracer::first_unwalked() {
    End* first = nullptr;
    for (End& end : ends_) {
        if (end.walked) continue;
        if (!first || end.t < first->t || (end.t == first->t && end.face < first->face)) first = &end;
    }
    return first;
}

void TetTracer::mark_walked(const RayPlane& plane, TetFace start, TetFace end) {
    const auto find = [&](TetFace face) {
        return std::find_if(ends_.begin(), ends_.end(), [&](const End& e) { return e.face == face; });
    };
    find(start)->walked = true;
    if (find(end) == ends_.end()) {  // single precision did not see it, nor maybe others beside it
        add_end(plane, end);
        add_ends_near(plane, start);
        add_ends_near(plane, end);
    }
    if (const auto found = find(end); found != ends_.end()) found->walked = true;
}

Segment TetTracer::trace(const Ray& ray) {
    const RayPlane plane(ray);
    find_ends(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    const double speed = glm::length(ray.direction);
    LitDepth state;
    while (const End* next = first_unwalked()) {
        const TetFace start = next->face;
        TetFace other = start;
        const WalkOutcome outcome = walk_between(mesh_, plane, start, speed, compositor_, state, other, counts_.segments);
        if (outcome == WalkOutcome::Lost) ++counts_.lost_rays;
        if (outcome == WalkOutcome::Lost || outcome == WalkOutcome::Opaque) break;
        mark_walked(plane, start, other);
    }
    return state.light;
}

}  // namespace subvol
