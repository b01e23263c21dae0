// SPDX-License-Identifier: Apache-2.0
// How a ray decides which face of a tetrahedron it crosses.
//
// Seen along the ray, space is a plane and the ray is its origin, *. An edge a→b has * on its left or on its right: the sign of
// the area a.x·b.y − b.x·a.y. The ray crosses a triangle if * is on the same side of all three edges:
//
//            c          All three signs are alike: the ray crosses the triangle. The areas of (*,b,c), (*,c,a) and (*,a,b)
//           / \         are the barycentric weights of the crossing, so depth and value follow by interpolation.
//          / * \        Otherwise it passes beside the triangle.
//         a-----b
//
// Plane tests in floating point contradict each other at vertices, edges and in flat cells, and the ray is lost. A sign belongs
// to an edge, not to a cell: it is computed in the same way for all cells about the edge, exactly where it is close to zero,
// and is never zero (ties by simulation of simplicity [em1990]). Hence a tetrahedron that a ray enters through one face has
// exactly one other crossed face, and `walk` needs only the signs of the edges to the fourth corner to find it.
// The walk from cell to cell is that of [garrity1990]; docs/adr/0005 says why signs, docs/adr/0013 how rays go side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "subvol/camera.h"
#include "subvol/detail/compositor.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/hex_mesh.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// A mesh point in the coordinates of a ray: (x,y) is its offset from the ray in the plane across the dominant axis, t its
/// place along the ray.
struct SeenPoint {
    Index id = kNone;
    double x = 0, y = 0, t = 0;
    double value = 0;
};

/// Twice the signed area of (ray, a, b), and its sign: on which side of the edge ab the ray passes. The sign is exact for the
/// seen coordinates and never zero: ties are decided as if the ray were moved by (ε, ε²) [em1990], and by ids between points
/// that coincide for the ray. So the signs of all edges are consistent, and every ray crosses the inside of faces, even through
/// a vertex or along an edge.
struct EdgeSide {
    double area = 0;
    bool left = false;

    [[nodiscard]] EdgeSide reversed() const { return {-area, !left}; }
};

/// Shears space so that the ray becomes the t axis.
class RayPlane {
public:
    explicit RayPlane(const Ray& ray) : origin_(ray.origin) {
        const Vec3 size = glm::abs(ray.direction);
        z_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        per_depth_ = 1 / ray.direction[z_];
        slope_x_ = ray.direction[x_] * per_depth_;
        slope_y_ = ray.direction[y_] * per_depth_;
    }

    [[nodiscard]] SeenPoint see(Index id, const Vec3& position, double value) const {
        const Vec3 p = position - origin_;
        return {id, p[x_] - slope_x_ * p[z_], p[y_] - slope_y_ * p[z_], p[z_] * per_depth_, value};
    }

    /// False if the line certainly misses a box that is widened by `margin`.
    [[nodiscard]] bool may_meet(const Vec3& center, const Vec3& half, double margin) const {
        const Vec3 p = center - origin_;
        const double x = p[x_] - slope_x_ * p[z_], y = p[y_] - slope_y_ * p[z_];
        const double size_x = std::abs(slope_x_), size_y = std::abs(slope_y_);
        return std::abs(x) <= half[x_] + size_x * half[z_] + margin && std::abs(y) <= half[y_] + size_y * half[z_] + margin &&
               std::abs(x * slope_y_ - y * slope_x_) <= half[x_] * size_y + half[y_] * size_x + margin;
    }
    [[nodiscard]] const Vec3& origin() const { return origin_; }

    /// The axes of space that become x, y and depth, and their shear.
    [[nodiscard]] std::array<int, 3> axes() const { return {x_, y_, z_}; }
    [[nodiscard]] double slope_x() const { return slope_x_; }
    [[nodiscard]] double slope_y() const { return slope_y_; }
    [[nodiscard]] double per_depth() const { return per_depth_; }

private:
    Vec3 origin_;
    int x_, y_, z_;
    double slope_x_, slope_y_, per_depth_;
};

/// a·d − b·c with a relative error of at most two roundings, hence with the right sign: Kahan's algorithm (Jeannerod, Louvet,
/// Muller 2013).
[[nodiscard]] inline double exact_difference(double a, double d, double b, double c) {
    const double bc = b * c;
    return std::fma(a, d, -bc) + std::fma(-b, c, bc);
}

/// An area larger than this share of its terms is used as it was rounded, a smaller one is computed exactly. For the sign alone
/// 3.4e-16 would do ((3 + 16ε)ε of Shewchuk's 2-D orientation test). But areas are also the weights of a crossing: without
/// right digits the crossing would lie beside the ray, by up to the whole face where it is seen almost edge on.
inline constexpr double kSideError = 1e-7;

[[nodiscard]] inline EdgeSide side_of(const SeenPoint& a, const SeenPoint& b) {
    const double left = a.x * b.y, right = b.x * a.y;
    const double area = left - right;
    if (std::abs(area) > kSideError * (std::abs(left) + std::abs(right))) return {area, area > 0};
    const double exact = exact_difference(a.x, b.y, b.x, a.y);
    if (exact != 0) return {exact, exact > 0};
    if (a.y != b.y) return {0, a.y > b.y};
    if (a.x != b.x) return {0, b.x > a.x};
    return {0, a.id < b.id};
}

/// Where a ray crosses a face: depth along the ray and the value there.
struct Crossing {
    double t = 0;
    double value = 0;
};

/// A face that the ray crosses: its corners in the ray's coordinates, counter-clockwise about it, and the sides of its edges.
struct CrossedFace {
    std::array<SeenPoint, 3> corner;
    std::array<EdgeSide, 3> side;  // of edges 0→1, 1→2, 2→0; all left

    /// Linear interpolation: the three areas are the barycentric weights.
    [[nodiscard]] Crossing crossing() const {
        double w0 = std::max(0.0, side[1].area), w1 = std::max(0.0, side[2].area), w2 = std::max(0.0, side[0].area);
        if (!(w0 + w1 + w2 > 0)) w0 = w1 = w2 = 1;  // seen edge on, to the last bit
        const double scale = 1 / (w0 + w1 + w2);
        return {scale * (w0 * corner[0].t + w1 * corner[1].t + w2 * corner[2].t),
                scale * (w0 * corner[0].value + w1 * corner[1].value + w2 * corner[2].value)};
    }
};

/// The triangle if the ray crosses it.
[[nodiscard]] std::optional<CrossedFace> cross_triangle(const std::array<SeenPoint, 3>& corners);

template <class Mesh>
[[nodiscard]] SeenPoint see(const Mesh& mesh, const RayPlane& plane, Index id) {
    const auto& point = mesh.point(id);
    return plane.see(id, point.position, point.value);
}

template <class Mesh>
[[nodiscard]] std::optional<CrossedFace> cross_face(const Mesh& mesh, const RayPlane& plane, TetFace face) {
    const auto [a, b, c] = mesh.corners(face);
    return cross_triangle({see(mesh, plane, a), see(mesh, plane, b), see(mesh, plane, c)});
}

/// Follows a ray from a boundary face through the mesh to another boundary face. Because the signs of edges are consistent, a
/// tetrahedron that is entered has exactly one other face that the ray crosses. So the walk cannot fail or turn in circles, not
/// even in flat or inverted tetrahedra (there t stands still or runs back).
///
/// face:    `start` as the ray crosses it
/// visit:   bool(Crossing), called at every face crossed after the first; false ends the walk
/// returns: the boundary face at the end; nothing if visit ended the walk
template <class Mesh, class Visit>
std::optional<TetFace> walk(const Mesh& mesh, const RayPlane& plane, TetFace start, CrossedFace face, const Visit& visit) {
    Index tet = start / 4;
    for (;;) {
        auto& [a, b, c] = face.corner;
        const auto& corner = mesh.corners_of_tet(tet);
        const Index apex = corner[0] ^ corner[1] ^ corner[2] ^ corner[3] ^ a.id ^ b.id ^ c.id;
        const SeenPoint d = see(mesh, plane, apex);
        const EdgeSide ad = side_of(a, d);
        Index dropped;
        if (!ad.left) {
            if (const EdgeSide bd = side_of(b, d); bd.left) {  // a b d
                dropped = c.id;
                c = d;
                face.side[1] = bd;
                face.side[2] = ad.reversed();
            } else {  // b c d
                dropped = a.id;
                a = d;
                face.side[0] = bd.reversed();
                face.side[2] = side_of(c, d);
            }
        } else if (const EdgeSide cd = side_of(c, d); cd.left) {  // b c d
            dropped = a.id;
            a = d;
            face.side[0] = side_of(b, d).reversed();
            face.side[2] = cd;
        } else {  // c a d
            dropped = b.id;
            b = d;
            face.side[0] = ad;
            face.side[1] = cd.reversed();
        }
        if (!visit(face.crossing())) return std::nullopt;
        const auto k = static_cast<Index>(std::find(corner.begin(), corner.end() - 1, dropped) - corner.begin());
        const Index next = mesh.neighbor(tet, k);
        if (next == kNone) return 4 * tet + k;
        tet = next;
    }
}

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

/// What has been integrated, up to depth t: every depth counts once, even where a mesh folds over itself.
struct LitDepth {
    Segment light;
    double t = 0;
    std::optional<double> slice{};  ///< the value on the slice that ends the ray
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
