// SPDX-License-Identifier: Apache-2.0
// Removes triangles with small angles from a surface without moving points. Each triangle with an angle below a limit is looked
// at: its shortest edge that may be collapsed is, to that of its ends which leaves the larger least angle; if no edge may be,
// the longest one that may be flipped is.
//
//     collapse   a point goes to its neighbour: the triangles stay a surface, none turns too far or away from the limit's
//                normals, and the surface bends by no more than the slack; where normals do not show that, it
//                passes near the point
//     flip       the other diagonal of two triangles: the least angle grows, and both diagonals are as near as the slack
//
// Points of sharp lines go along their line only, if what is left of it stays within the slack; fixed points stay. Passes, of
// which there is a most, follow until one changes nothing, and look at triangles about which something has changed. Edges are
// collapsed and flipped one after the other: the result depends on the order alone, which is that of the triangles.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "subvol/detail/triangle_distance.h"
#include "surface_shape.h"

namespace subvol::detail {

/// The least angle is opposite the shortest side.
double least_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::array<Vec3, 3> sides{c - b, a - c, b - a};  // opposite a, b, c
    const auto least = static_cast<std::size_t>(
        std::ranges::min_element(sides, {}, [](const Vec3& side) { return glm::dot(side, side); }) - sides.begin());
    const Vec3 u = sides[(least + 2) % 3], v = -sides[(least + 1) % 3];
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 180 / std::numbers::pi;
}

namespace {

constexpr double kSmallAngle_deg = 25;  // triangles with a smaller one are looked at
constexpr double kSameSide = 0.8;       // cosine
constexpr int kMostPasses = 16;

class SliverMender {
public:
    SliverMender(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, SharpLines lines, const MendSlack& slack,
                 std::vector<std::array<Index, 3>>& triangles)
        : points_(points),
          normals_(normals),
          lines_(std::move(lines)),
          slack_(slack.world),
          near_(slack.near_world),
          by_normals_(slack.by_normals),
          triangles_(triangles),
          around_(points.size()),
          ways_(points.size(), 0),
          alive_(triangles.size(), 1),
          changed_(triangles.size(), 1) {
        for (Index t = 0; t < triangles.size(); ++t) {
            for (const Index p : triangles[t]) around_[p].push_back(t);
        }
    }

    std::size_t run() {
        std::size_t mended = 0;
        for (int pass = 0; pass < kMostPasses; ++pass) {
            const std::size_t before = mended;
            for (Index t = 0; t < triangles_.size(); ++t) mended += alive_[t] != 0 && changed_[t] != 0 && mend(t) ? 1 : 0;
            if (mended == before) break;
        }
        std::size_t kept = 0;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            if (alive_[t] != 0) triangles_[kept++] = triangles_[t];
        }
        triangles_.resize(kept);
        return mended;
    }

private:
    [[nodiscard]] double angle_of(const std::array<Index, 3>& t) const {
        return least_angle_deg(points_[t[0]], points_[t[1]], points_[t[2]]);
    }

    /// Collapses the shortest edge of a triangle with a small angle if it may be, else flips the longest that may be.
    bool mend(Index t) {
        changed_[t] = 0;
        const auto corners = triangles_[t];
        const double angle = angle_of(corners);
        if (angle > kSmallAngle_deg) return false;
        std::array<std::size_t, 3> order{0, 1, 2};
        const auto length = [&](std::size_t k) { return glm::distance(points_[corners[k]], points_[corners[(k + 1) % 3]]); };
        std::ranges::sort(order, {}, length);
        for (const std::size_t k : order) {
            const Index a = corners[k], b = corners[(k + 1) % 3];
            const double to_b = outcome(a, b), to_a = outcome(b, a);  // the least angle afterwards
            const bool may_a = to_b > angle || (to_b >= 0 && to_b >= least_about(a));
            const bool may_b = to_a > angle || (to_a >= 0 && to_a >= least_about(b));
            if (!may_a && !may_b) continue;
            if (may_a && (!may_b || to_b >= to_a)) {
                collapse(a, b);
            } else {
                collapse(b, a);
            }
            return true;
        }
        for (std::size_t k = 3; k-- > 0;) {
            if (flip(t, corners[order[k]], corners[(order[k] + 1) % 3], corners[(order[k] + 2) % 3])) return true;
        }
        return false;
    }

    [[nodiscard]] double least_about(Index p) const {
        double least = 180;
        for (const Index t : around_[p]) least = std::min(least, angle_of(triangles_[t]));
        return least;
    }

    [[nodiscard]] bool on_line(Index a, Index b) const {
        const auto has = [&](Index p, Index q) { return lines_.next[p][0] == q || lines_.next[p][1] == q; };
        return has(a, b) || has(b, a) || (lines_.fixed[a] != 0 && lines_.fixed[b] != 0);
    }

    /// Replaces the edge from a to b of triangle t, whose third corner is c, by the other diagonal of the two triangles at it.
    ///
    /// returns: false if nothing may be changed, or no angle would grow
    bool flip(Index t, Index a, Index b, Index c) {
        if (on_line(a, b)) return false;
        Index other = kNone;
        for (const Index u : around_[a]) {
            if (u == t || !contains(triangles_[u], b)) continue;
            if (other != kNone) return false;
            other = u;
        }
        if (other == kNone) return false;
        Index d = kNone;
        for (const Index p : triangles_[other]) d = p == a || p == b ? d : p;
        for (const Index u : around_[c]) {
            if (contains(triangles_[u], d)) return false;
        }
        const std::array<Index, 3> first{a, d, c}, second{d, b, c};
        if (std::min(angle_of(first), angle_of(second)) <= std::min(angle_of(triangles_[t]), angle_of(triangles_[other]))) {
            return false;
        }
        if (!may_replace(triangles_[t], triangles_[other], first) || !may_replace(triangles_[t], triangles_[other], second)) {
            return false;
        }
        // The old and the new diagonal are as near to each other as the surface may be to the limit.
        const Vec3 across = glm::cross(points_[b] - points_[a], points_[d] - points_[c]);
        if (std::abs(glm::dot(across, points_[c] - points_[a])) > line_slack() * glm::length(across)) return false;
        triangles_[t] = first;
        triangles_[other] = second;
        std::erase(around_[a], other);
        std::erase(around_[b], t);
        insert(around_[c], other);
        insert(around_[d], t);
        for (const Index p : {a, b, c, d}) mark_about(p);
        return true;
    }

    /// What may be done to a triangle depends on the triangles about its corners: those with a corner that a changed one has
    /// are looked at again.
    void mark_about(Index p) {
        for (const Index t : around_[p]) {
            for (const Index q : triangles_[t]) {
                for (const Index u : around_[q]) changed_[u] = 1;
            }
        }
    }

    static void insert(std::vector<Index>& sorted, Index t) { sorted.insert(std::ranges::upper_bound(sorted, t), t); }

    [[nodiscard]] Vec3 facet(const std::array<Index, 3>& t) const {
        return glm::cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
    }

    /// Whether a triangle faces as both of those that it takes the place of, and as the limit at its corners.
    [[nodiscard]] bool may_replace(const std::array<Index, 3>& old, const std::array<Index, 3>& other,
                                   const std::array<Index, 3>& by) const {
        const Vec3 normal = facet(by);
        const double size = glm::length(normal);
        if (!(size > 0)) return false;
        // A sliver has hardly a direction: the sum of both has.
        const Vec3 before = facet(old) + facet(other);
        if (glm::dot(before, normal) < kSameSide * glm::length(before) * size) return false;
        return std::ranges::all_of(by, [&](Index p) { return is_sharp(p) || glm::dot(normal, normals_[p]) >= 0.5 * size; });
    }

    void neighbors_of(Index p, std::vector<Index>& found) const {
        found.clear();
        for (const Index t : around_[p]) {
            for (const Index q : triangles_[t]) {
                if (q != p) found.push_back(q);
            }
        }
        std::ranges::sort(found);
    }

    [[nodiscard]] bool is_sharp(Index p) const { return lines_.fixed[p] != 0 || lines_.next[p][0] != kNone; }

    /// A point on a line is to go to its neighbour `to`. Returns the neighbour on its other side, or kNone if it must stay.
    [[nodiscard]] Index other_end(Index from, Index to) const {
        const auto& [a, b] = lines_.next[from];
        if ((a != to && b != to) || a == b) return kNone;
        const Index other = a == to ? b : a;
        // What is left of the line must be as near to the point as the surface is to the limit.
        const double most = by_normals_ ? 0.5 * slack_ : near_;
        if (squared_distance(points_[from], points_[to], points_[other]) > most * most) return kNone;
        return other;
    }

    /// The least angle about `to` after `from` has been moved there; −1 if that must not be.
    [[nodiscard]] double outcome(Index from, Index to) {
        if (lines_.fixed[from] != 0) return -1;
        const Index other = lines_.next[from][0] == kNone ? kNone : other_end(from, to);
        if (is_sharp(from) && other == kNone) return -1;
        std::size_t shared = 0;
        for (const Index t : around_[from]) shared += contains(triangles_[t], to) ? 1 : 0;
        if (shared == 0 || shared > 2) return -1;
        if (shared == 1 && other == kNone) return -1;  // the edge is on a border, the point is not
        // The link condition: the ends have no neighbours in common but those of the triangles that vanish.
        neighbors_of(from, first_);
        neighbors_of(to, second_);
        first_.erase(std::unique(first_.begin(), first_.end()), first_.end());
        second_.erase(std::unique(second_.begin(), second_.end()), second_.end());
        common_.clear();
        std::ranges::set_intersection(first_, second_, std::back_inserter(common_));
        if (common_.size() != shared || first_.size() < 3 || second_.size() <= 3) return -1;
        if (other != kNone && std::ranges::binary_search(second_, other)) return -1;  // the line would fold
        double least = 180;
        for (const Index t : around_[from]) {
            if (contains(triangles_[t], to)) continue;
            auto moved = triangles_[t];
            for (Index& p : moved) p = p == from ? to : p;
            const Vec3 normal = facet(moved);
            const double size = glm::length(normal);
            if (!(size > 0)) return -1;
            for (const Index p : moved) {
                if (!is_sharp(p) && glm::dot(normal, normals_[p]) < 0.5 * size) return -1;
            }
            // A face may turn by no more than it bends anyway.
            const Vec3 old = facet(triangles_[t]);
            if (glm::dot(old, normal) < 0.5 * glm::length(old) * size) return -1;
            least = std::min(least, angle_of(moved));
        }
        bool by_normals = by_normals_ && !is_sharp(to);
        for (const Index p : first_) {
            if (p == to) continue;
            if (is_sharp(p)) by_normals = false;
            if (is_sharp(p) || is_sharp(to)) continue;
            if (bend(points_[p], points_[to], normals_[p], normals_[to]) > slack_) return -1;
        }
        return by_normals || way_of(from, to) <= near_ ? least : -1;
    }

    /// How far the triangles about a point are from it, and from the points that went to it before, after it has gone to its
    /// neighbour `to`. Normals do not show that at sharp lines, or where triangles are as large as the tolerance allows.
    [[nodiscard]] double way_of(Index from, Index to) const {
        const Vec3& x = points_[from];
        double least = HUGE_VAL;
        for (const Index t : around_[from]) {
            if (contains(triangles_[t], to)) continue;
            std::array<Vec3, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) corners[k] = points_[triangles_[t][k] == from ? to : triangles_[t][k]];
            const Vec3 weights = nearest_in_triangle(x, corners[0], corners[1], corners[2]).weights;
            least = std::min(least, glm::distance(x, weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2]));
        }
        return ways_[from] + least;
    }

    /// How far the diagonals of two triangles may be from each other.
    [[nodiscard]] double line_slack() const { return by_normals_ ? slack_ : near_; }

    static bool contains(const std::array<Index, 3>& t, Index p) { return t[0] == p || t[1] == p || t[2] == p; }

    void collapse(Index from, Index to) {
        if (!by_normals_) ways_[to] = std::max(ways_[to], way_of(from, to));
        if (lines_.next[from][0] != kNone) {
            const Index other = other_end(from, to);
            for (Index& end : lines_.next[to]) end = end == from ? other : end;
            for (Index& end : lines_.next[other]) end = end == from ? to : end;
        }
        for (const Index t : around_[from]) {
            if (contains(triangles_[t], to)) {
                alive_[t] = 0;
                for (const Index p : triangles_[t]) {
                    if (p != from) std::erase(around_[p], t);
                }
            } else {
                for (Index& p : triangles_[t]) p = p == from ? to : p;
                around_[to].push_back(t);
            }
        }
        std::ranges::sort(around_[to]);
        around_[from].clear();
        mark_about(to);
    }

    const std::vector<Vec3>& points_;
    const std::vector<Vec3>& normals_;
    SharpLines lines_;
    double slack_, near_;
    bool by_normals_;
    std::vector<std::array<Index, 3>>& triangles_;
    std::vector<std::vector<Index>> around_;  // the triangles of each point, ascending
    std::vector<double> ways_;                // of the points that went to each, where normals do not show them
    std::vector<std::uint8_t> alive_;
    std::vector<std::uint8_t> changed_;  // about them, since they were looked at
    std::vector<Index> first_, second_, common_;
};

}  // namespace

std::size_t mend_slivers(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, SharpLines lines,
                         const MendSlack& slack, std::vector<std::array<Index, 3>>& triangles) {
    return SliverMender(points, normals, std::move(lines), slack, triangles).run();
}

}  // namespace subvol::detail
