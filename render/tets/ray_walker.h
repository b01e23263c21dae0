// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "subvol/detail/compositor.h"
#include "subvol/detail/ray_clip.h"
#include "tet_walk.h"

namespace subvol::detail {

/// What a tracer counts, over all rays that met the volume.
struct TraceCounts {
    std::size_t rays = 0;
    std::size_t segments = 0;   // tetrahedra crossed
    std::size_t lost_rays = 0;  // that could not be followed to the other side

    TraceCounts& operator+=(const TraceCounts& other) {
        rays += other.rays;
        segments += other.segments;
        lost_rays += other.lost_rays;
        return *this;
    }
};

/// What has been integrated, up to depth t: every depth counts once, even where a mesh folds over itself. slice: the value on
/// the slice that ends the ray
struct LitDepth {
    Segment light;
    double t = 0;
    std::optional<double> slice{};
};

/// What is left of a ray, and whether its slices are drawn alone.
struct WalkCut {
    RayCut ray;
    bool slices_alone = false;
};

/// Through:   the walk arrived at another boundary face
/// Backwards: that face lies in front of the first one
/// Beyond:    cells reach further than that face, so they are inverted
/// Opaque:    the light is used up
/// Lost:      the ray does not cross the first face, or the walk took more steps than there are tetrahedra
enum class WalkOutcome { Through, Backwards, Beyond, Opaque, Lost };

/// A walk from a boundary face: the boundary face at its other end (the first one if there is none), and that face's depth.
struct Walk {
    WalkOutcome outcome;
    TetFace end;
    double end_t = 0;
};

/// Integrates one ray, walk after walk, in one mesh or in several.
class RayWalker {
public:
    /// Keeps references to plane, cut, compositor and counts.
    RayWalker(const Ray& ray, const RayPlane& plane, const WalkCut& cut, Compositor& compositor, TraceCounts& counts)
        : plane_(plane), speed_(glm::length(ray.direction)), cut_(cut), compositor_(compositor), counts_(counts) {}

    /// The light, with the slice that ends the ray.
    [[nodiscard]] Segment light(const Optics& optics) const {
        Segment light = lit_.light;
        if (lit_.slice) composite(light, {optics.color(*lit_.slice), 0});
        return light;
    }

    /// Walks between two boundary faces, from whichever of them is the entry, and composites what has not been integrated yet.
    ///
    /// start:   either of the two
    /// returns: the outcome; the face that is not `start`
    template <class Mesh>
    Walk between(const Mesh& mesh, TetFace start) {
        constexpr double kNoLimit = std::numeric_limits<double>::infinity();
        const LitDepth before = lit_;
        Walk walk = integrate(mesh, start, kNoLimit);
        const TetFace other = walk.end;
        TetFace entry = start;
        if (walk.outcome == WalkOutcome::Backwards) {
            lit_ = before;
            entry = other;
            walk = integrate(mesh, entry, kNoLimit);
        }
        if (walk.outcome == WalkOutcome::Beyond) {  // inverted cells lie outside: the volume ends where the boundary is
            lit_ = before;
            walk = integrate(mesh, entry, walk.end_t);
        }
        walk.end = other;
        return walk;
    }

private:
    /// Where a stretch ends: at its first slice, if it has one.
    [[nodiscard]] std::optional<double> first_slice(double from, double to) const {
        for (const RaySlice& slice : cut_.ray.slices) {
            if (slice.meets(from, to)) return slice.within(from, to);
        }
        return std::nullopt;
    }

    /// Walks from a boundary face and composites what lies between lit_.t and `limit`.
    template <class Mesh>
    Walk integrate(const Mesh& mesh, TetFace start, double limit) {
        const auto face = cross_face(mesh, plane_, start);
        if (!face) return {WalkOutcome::Lost, start};
        const Crossing first = face->crossing();
        Crossing previous = first;
        lit_.t = std::max(lit_.t, first.t);
        double reached = first.t;
        std::size_t steps = 0;
        const auto visit = [&](const Crossing& next) {
            const double from = std::max({previous.t, lit_.t, cut_.ray.near});
            double to = std::min({next.t, limit, cut_.ray.far});
            const std::optional<double> slice = next.t > previous.t ? first_slice(from, to) : std::nullopt;
            if (slice) to = *slice;
            if (to > from || slice) {
                const double slope = (next.value - previous.value) / (next.t - previous.t);
                const double front = from == previous.t ? previous.value : previous.value + (from - previous.t) * slope;
                const double back = to == next.t ? next.value : previous.value + (to - previous.t) * slope;
                if (!cut_.slices_alone && to > from) compositor_.add(front, back, (to - from) * speed_);
                if (slice) lit_.slice = back;
                lit_.t = to;
                reached = to;
            }
            previous = next;
            return ++steps <= mesh.tet_count() && !compositor_.opaque() && !lit_.slice;
        };
        compositor_.start(lit_.light);
        const auto end = walk(mesh, plane_, start, *face, visit);
        lit_.light = compositor_.finish();
        counts_.segments += steps;
        if (!end) return {steps > mesh.tet_count() ? WalkOutcome::Lost : WalkOutcome::Opaque, start};
        if (previous.t < first.t) return {WalkOutcome::Backwards, *end, previous.t};
        return {reached > previous.t ? WalkOutcome::Beyond : WalkOutcome::Through, *end, previous.t};
    }

    const RayPlane& plane_;
    double speed_;
    const WalkCut& cut_;
    Compositor& compositor_;
    TraceCounts& counts_;
    LitDepth lit_;
};

}  // namespace subvol::detail
