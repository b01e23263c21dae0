#pragma once

#include "subvol/optics.h"
#include "tet_walk.h"

namespace subvol {

/// What has been integrated, up to depth t: every depth counts once, even where a mesh folds over itself.
struct LitDepth {
    Segment light;
    double t = 0;
};

enum class WalkOutcome { Through, Backwards, Opaque, Lost };

/// Walks from a boundary face and composites what lies beyond state.t.
///
/// speed:    world length of a unit of t
/// last:     the boundary face at the end
/// segments: grows by the tetrahedra crossed
template <class Mesh>
WalkOutcome integrate_walk(const Mesh& mesh, const RayPlane& plane, TetFace start, double speed, const Optics& optics,
                           LitDepth& state, TetFace& last, std::size_t& segments) {
    constexpr double kOpaque = 1e-6;  // what lies behind less transmittance than this is not followed
    const auto face = cross_face(mesh, plane, start);
    if (!face) return WalkOutcome::Lost;
    const Crossing first = face->crossing();
    Crossing previous = first;
    std::size_t steps = 0;
    const auto visit = [&](const Crossing& next) {
        const double from = std::max(previous.t, state.t);
        if (next.t > from) {
            const double slope = (next.value - previous.value) / (next.t - previous.t);
            const double value = from == previous.t ? previous.value : previous.value + (from - previous.t) * slope;
            composite(state.light, optics.integrate(value, next.value, (next.t - from) * speed));
            state.t = next.t;
        }
        previous = next;
        return ++steps <= mesh.tet_count() && state.light.transmittance >= kOpaque;
    };
    const auto end = walk(mesh, plane, start, *face, visit);
    segments += steps;
    if (!end) return steps > mesh.tet_count() ? WalkOutcome::Lost : WalkOutcome::Opaque;
    last = *end;
    return previous.t < first.t ? WalkOutcome::Backwards : WalkOutcome::Through;
}

}  // namespace subvol
