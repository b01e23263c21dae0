// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "subvol/detail/compositor.h"
#include "tet_walk.h"

namespace subvol::detail {

/// What lies behind less transmittance than this is not followed.
inline constexpr double kOpaque = 1e-6;

/// What has been integrated, up to depth t: every depth counts once, even where a mesh folds over itself.
struct LitDepth {
    Segment light;
    double t = 0;
};

/// Backwards: the end lies before the start. Beyond: cells reach further than the end, so they are inverted.
enum class WalkOutcome { Through, Backwards, Beyond, Opaque, Lost };

/// The boundary face at the end of a walk, and its depth.
struct WalkEnd {
    TetFace face;
    double t;
};

/// Walks from a boundary face and composites what lies beyond state.t.
///
/// speed:    world length of a unit of t
/// limit:    depth beyond which nothing is integrated
/// segments: grows by the tetrahedra crossed
template <class Mesh>
WalkOutcome integrate_walk(const Mesh& mesh, const RayPlane& plane, TetFace start, double speed, double limit,
                           Compositor& compositor, LitDepth& state, WalkEnd& last, std::size_t& segments) {
    const auto face = cross_face(mesh, plane, start);
    if (!face) return WalkOutcome::Lost;
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
            compositor.add(front, back, (to - from) * speed);
            state.t = to;
            reached = to;
        }
        previous = next;
        return ++steps <= mesh.tet_count() && !compositor.opaque();
    };
    compositor.start(state.light);
    const auto end = walk(mesh, plane, start, *face, visit);
    state.light = compositor.finish();
    segments += steps;
    if (!end) return steps > mesh.tet_count() ? WalkOutcome::Lost : WalkOutcome::Opaque;
    last = {*end, previous.t};
    if (last.t < first.t) return WalkOutcome::Backwards;
    return reached > last.t ? WalkOutcome::Beyond : WalkOutcome::Through;
}

/// Walks between two boundary faces, from whichever is the entry; other: the one that is not `start`.
template <class Mesh>
WalkOutcome walk_between(const Mesh& mesh, const RayPlane& plane, TetFace start, double speed, Compositor& compositor,
                         LitDepth& state, TetFace& other, std::size_t& segments) {
    const LitDepth before = state;
    WalkEnd last{start, 0};
    TetFace entry = start;
    const auto follow = [&](double limit) {
        state = before;
        return integrate_walk(mesh, plane, entry, speed, limit, compositor, state, last, segments);
    };
    WalkOutcome outcome = follow(std::numeric_limits<double>::infinity());
    other = last.face;
    if (outcome == WalkOutcome::Backwards) {
        entry = other;
        outcome = follow(std::numeric_limits<double>::infinity());
    }
    // Inverted cells lie outside the boundary: the volume ends where the boundary is.
    if (outcome == WalkOutcome::Beyond) outcome = follow(last.t);
    return outcome;
}

}  // namespace subvol::detail
