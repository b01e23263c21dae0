// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "subvol/detail/triangle_distance.h"

namespace subvol::detail {

namespace {

double least_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
    double least = 180;
    const std::array<Vec3, 3> p{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
        const double angle = std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
        least = std::min(least, angle * 180 / std::numbers::pi);
    }
    return least;
}

Index root_of(std::vector<Index>& parents, Index p) {
    while (parents[p] != p) p = parents[p] = parents[parents[p]];
    return p;
}

}  // namespace

void measure_surface(const Surface& surface, SurfaceReport& report) {
    struct Edge {
        Index a, b;
        bool forward;
        auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * surface.triangles.size());
    std::vector<Index> parents(surface.points.size());
    std::iota(parents.begin(), parents.end(), Index{0});
    std::vector<std::uint8_t> used(surface.points.size(), 0);
    const Vec3 origin = surface.points.empty() ? Vec3(0.0) : surface.points.front();
    double area = 0, volume = 0, least = 180;
    std::size_t small = 0;
    for (const auto& t : surface.triangles) {
        const Vec3 a = surface.points[t[0]] - origin, b = surface.points[t[1]] - origin, c = surface.points[t[2]] - origin;
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
        volume += glm::dot(a, glm::cross(b, c)) / 6;
        const double angle = least_angle_deg(a, b, c);
        least = std::min(least, angle);
        small += angle < 10 ? 1 : 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index from = t[k], to = t[(k + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), from < to});
            used[from] = 1;
            parents[root_of(parents, from)] = root_of(parents, to);
        }
    }
    tbb::parallel_sort(edges.begin(), edges.end());
    std::size_t edge_count = 0;
    bool watertight = !edges.empty();
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i;
        while (end < edges.size() && edges[end].a == edges[i].a && edges[end].b == edges[i].b) ++end;
        watertight = watertight && end - i == 2 && edges[i].forward != edges[i + 1].forward;
        ++edge_count;
        i = end;
    }
    std::size_t points = 0, components = 0;
    for (Index p = 0; p < parents.size(); ++p) {
        if (used[p] == 0) continue;
        ++points;
        components += root_of(parents, p) == p ? 1 : 0;
    }
    report.area = area;
    report.volume = volume;
    report.watertight = watertight;
    report.euler = static_cast<long>(points) - static_cast<long>(edge_count) + static_cast<long>(surface.triangles.size());
    report.components = components;
    report.min_angle_deg = surface.triangles.empty() ? 0 : least;
    report.small_angles =
        surface.triangles.empty() ? 0 : static_cast<double>(small) / static_cast<double>(surface.triangles.size());
}

namespace {

constexpr double kSharp = 0.8;  // cosine: triangles of the hull that bend by more meet at a crease

constexpr double kSmallAngle_deg = 25;  // triangles with a smaller one are looked at
constexpr int kMostPasses = 6;

/// Collapses edges, one after the other: the result depends on the order alone, which is that of the triangles.
class Collapser {
public:
    Collapser(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, SharpLines lines, double slack,
              std::vector<std::array<Index, 3>>& triangles)
        : points_(points),
          normals_(normals),
          lines_(std::move(lines)),
          slack_(slack),
          triangles_(triangles),
          around_(points.size()),
          alive_(triangles.size(), 1) {
        for (Index t = 0; t < triangles.size(); ++t) {
            for (const Index p : triangles[t]) around_[p].push_back(t);
        }
    }

    std::size_t run() {
        std::size_t collapsed = 0;
        for (int pass = 0; pass < kMostPasses; ++pass) {
            const std::size_t before = collapsed;
            for (Index t = 0; t < triangles_.size(); ++t) collapsed += alive_[t] != 0 && mend(t) ? 1 : 0;
            if (collapsed == before) break;
        }
        std::size_t kept = 0;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            if (alive_[t] != 0) triangles_[kept++] = triangles_[t];
        }
        triangles_.resize(kept);
        return collapsed;
    }

private:
    [[nodiscard]] double angle_of(const std::array<Index, 3>& t) const {
        return least_angle_deg(points_[t[0]], points_[t[1]], points_[t[2]]);
    }

    /// Tries the edges of a triangle with a small angle, the shortest first.
    bool mend(Index t) {
        const auto corners = triangles_[t];
        const double angle = angle_of(corners);
        if (angle > kSmallAngle_deg) return false;
        std::array<std::size_t, 3> order{0, 1, 2};
        const auto length = [&](std::size_t k) { return glm::distance(points_[corners[k]], points_[corners[(k + 1) % 3]]); };
        std::ranges::sort(order, {}, length);
        for (const std::size_t k : order) {
            const Index a = corners[k], b = corners[(k + 1) % 3];
            const double to_b = outcome(a, b), to_a = outcome(b, a);  // the least angle afterwards
            if (std::max(to_a, to_b) <= angle) continue;
            if (to_b >= to_a) {
                collapse(a, b);
            } else {
                collapse(b, a);
            }
            return true;
        }
        return false;
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

    /// Of a point on a line that is to go to its neighbour `to`: the neighbour on its other side, or kNone if it must stay.
    [[nodiscard]] Index other_end(Index from, Index to) const {
        const auto& [a, b] = lines_.next[from];
        if ((a != to && b != to) || a == b) return kNone;
        const Index other = a == to ? b : a;
        // What is left of the line must be as near to the point as the surface is to the limit.
        if (squared_distance(points_[from], points_[to], points_[other]) > 0.25 * slack_ * slack_) return kNone;
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
        if (common_.size() != shared || first_.size() <= 3 || second_.size() <= 3) return -1;
        if (other != kNone && std::ranges::binary_search(second_, other)) return -1;  // the line would fold
        double least = 180;
        for (const Index t : around_[from]) {
            if (contains(triangles_[t], to)) continue;
            auto moved = triangles_[t];
            for (Index& p : moved) p = p == from ? to : p;
            const Vec3 &a = points_[moved[0]], &b = points_[moved[1]], &c = points_[moved[2]];
            const Vec3 normal = glm::cross(b - a, c - a);
            const double size = glm::length(normal);
            if (!(size > 0)) return -1;
            for (const Index p : moved) {
                if (!is_sharp(p) && glm::dot(normal, normals_[p]) < 0.5 * size) return -1;
            }
            // A face may turn by no more than it bends anyway.
            const auto& before = triangles_[t];
            const Vec3 old = glm::cross(points_[before[1]] - points_[before[0]], points_[before[2]] - points_[before[0]]);
            if (glm::dot(old, normal) < 0.5 * glm::length(old) * size) return -1;
            least = std::min(least, angle_of(moved));
        }
        for (const Index p : first_) {
            if (p == to || is_sharp(p) || is_sharp(to)) continue;
            if (bend(points_[p], points_[to], normals_[p], normals_[to]) > slack_) return -1;
        }
        return least;
    }

    static bool contains(const std::array<Index, 3>& t, Index p) { return t[0] == p || t[1] == p || t[2] == p; }

    void collapse(Index from, Index to) {
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
    }

    const std::vector<Vec3>& points_;
    const std::vector<Vec3>& normals_;
    SharpLines lines_;
    double slack_;
    std::vector<std::array<Index, 3>>& triangles_;
    std::vector<std::vector<Index>> around_;  // the triangles of each point, ascending
    std::vector<std::uint8_t> alive_;
    std::vector<Index> first_, second_, common_;
};

}  // namespace

SharpLines sharp_lines(const std::vector<Vec3>& points, const std::vector<std::array<Index, 3>>& triangles,
                       std::span<const std::uint8_t> hull) {
    struct Side {
        Index a, b, triangle;
        auto operator<=>(const Side&) const = default;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (Index t = 0; t < triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t});
        }
    }
    tbb::parallel_sort(sides.begin(), sides.end());
    const auto facet = [&](Index t) {
        const Vec3& a = points[triangles[t][0]];
        return glm::cross(points[triangles[t][1]] - a, points[triangles[t][2]] - a);
    };
    SharpLines lines{std::vector<std::array<Index, 2>>(points.size(), {kNone, kNone}),
                     std::vector<std::uint8_t>(points.size(), 0)};
    const auto link = [&](Index from, Index to) {
        auto& [first, second] = lines.next[from];
        if (first == kNone) {
            first = to;
        } else if (second == kNone) {
            second = to;
        } else {
            lines.fixed[from] = 1;
        }
    };
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i;
        while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) ++end;
        bool sharp = end - i != 2;
        if (!sharp) {
            const Index s = sides[i].triangle, t = sides[i + 1].triangle;
            sharp = hull[s] != hull[t];
            if (!sharp && hull[s] != 0) {
                const Vec3 u = facet(s), v = facet(t);
                sharp = glm::dot(u, v) < kSharp * glm::length(u) * glm::length(v);
            }
        }
        if (sharp) {
            link(sides[i].a, sides[i].b);
            link(sides[i].b, sides[i].a);
        }
        i = end;
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (lines.next[p][0] != kNone && lines.next[p][1] == kNone) lines.fixed[p] = 1;  // its end
    }
    return lines;
}

std::size_t collapse_slivers(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, SharpLines lines,
                             double slack_world, std::vector<std::array<Index, 3>>& triangles) {
    return Collapser(points, normals, std::move(lines), slack_world, triangles).run();
}

}  // namespace subvol::detail
