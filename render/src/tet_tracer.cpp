#include "tet_tracer.h"

#include <algorithm>
#include <limits>

namespace subvol {

namespace {

constexpr double kOpaque = 1e-6;  // what lies behind less transmittance than this is not followed

}  // namespace

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

TetTracer::Outcome TetTracer::walk_from(const RayPlane& plane, TetFace start, double speed, double limit, State& state,
                                        End& last) {
    const auto face = cross_face(mesh_, plane, start);
    if (!face) return Outcome::Lost;
    const Crossing first = face->crossing();
    Crossing previous = first;
    state.t = std::max(state.t, first.t);
    double reached = first.t;
    std::size_t steps = 0;
    const auto visit = [&](const Crossing& next) {
        const double from = std::max(previous.t, state.t), to = std::min(next.t, limit);
        if (to > from) {
            const double slope = (next.value - previous.value) / (next.t - previous.t);
            const double front = from == previous.t ? previous.value : previous.value + (from - previous.t) * slope;
            const double back = to == next.t ? next.value : previous.value + (to - previous.t) * slope;
            composite(state.light, optics_.integrate(front, back, (to - from) * speed));
            state.t = to;
            reached = to;
        }
        previous = next;
        return ++steps <= mesh_.tets.size() && state.light.transmittance >= kOpaque;
    };
    const auto end = walk(mesh_, plane, start, *face, visit);
    counts_.segments += steps;
    if (!end) return steps > mesh_.tets.size() ? Outcome::Lost : Outcome::Opaque;
    last = {*end, previous.t, true};
    if (last.t < first.t) return Outcome::Backwards;
    return reached > last.t ? Outcome::Beyond : Outcome::Through;
}

TetTracer::Outcome TetTracer::walk_between(const RayPlane& plane, TetFace start, double speed, State& state, TetFace& other) {
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    const State before = state;
    End last{start, 0, false};
    Outcome outcome = walk_from(plane, start, speed, kNoLimit, state, last);
    other = last.face;
    TetFace entry = start;
    if (outcome == Outcome::Backwards) {
        entry = other;
        state = before;
        outcome = walk_from(plane, entry, speed, kNoLimit, state, last);
    }
    if (outcome == Outcome::Beyond) {  // inverted cells lie outside the boundary: the volume ends where the boundary is
        state = before;
        outcome = walk_from(plane, entry, speed, last.t, state, last);
    }
    return outcome;
}

Segment TetTracer::trace(const Ray& ray) {
    const RayPlane plane(ray);
    find_ends(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    const double speed = glm::length(ray.direction);
    State state;
    while (const End* next = first_unwalked()) {
        const TetFace start = next->face;
        TetFace other = start;
        const Outcome outcome = walk_between(plane, start, speed, state, other);
        if (outcome == Outcome::Lost) ++counts_.lost_rays;
        if (outcome == Outcome::Lost || outcome == Outcome::Opaque) break;
        mark_walked(plane, start, other);
    }
    return state.light;
}

}  // namespace subvol
