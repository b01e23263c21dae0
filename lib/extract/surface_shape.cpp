// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

constexpr double kSmallAngle_deg = 25;  // triangles with a smaller one are looked at
constexpr int kMostPasses = 6;

/// Collapses edges, one after the other: the result depends on the order alone, which is that of the triangles.
class Collapser {
public:
    Collapser(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, std::span<const std::uint8_t> fixed,
              double slack, std::vector<std::array<Index, 3>>& triangles)
        : points_(points), normals_(normals), fixed_(fixed), slack_(slack), triangles_(triangles), around_(points.size()) {
        for (Index t = 0; t < triangles.size(); ++t) {
            for (const Index p : triangles[t]) around_[p].push_back(t);
        }
        alive_.assign(triangles.size(), 1);
        border_.assign(points.size(), 0);
        for (Index p = 0; p < points.size(); ++p) border_[p] = has_border(p) ? 1 : 0;
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

    [[nodiscard]] bool has_border(Index p) {
        neighbors_of(p, first_);
        for (std::size_t i = 0; i < first_.size();) {
            std::size_t end = i;
            while (end < first_.size() && first_[end] == first_[i]) ++end;
            if (end - i != 2) return true;
            i = end;
        }
        return false;
    }

    /// The least angle about `to` after `from` has been moved there; −1 if that must not be.
    [[nodiscard]] double outcome(Index from, Index to) {
        if (fixed_[from] != 0) return -1;
        std::size_t shared = 0;
        for (const Index t : around_[from]) shared += contains(triangles_[t], to) ? 1 : 0;
        if (border_[from] != 0 && shared != 1) return -1;  // a border moves along itself only
        if (shared != (border_[from] != 0 ? 1U : 2U)) return -1;
        // The link condition: the ends have no neighbours in common but those of the triangles that vanish.
        neighbors_of(from, first_);
        neighbors_of(to, second_);
        first_.erase(std::unique(first_.begin(), first_.end()), first_.end());
        second_.erase(std::unique(second_.begin(), second_.end()), second_.end());
        common_.clear();
        std::ranges::set_intersection(first_, second_, std::back_inserter(common_));
        if (common_.size() != shared || first_.size() <= 3 || second_.size() <= 3) return -1;
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
                if (fixed_[p] == 0 && glm::dot(normal, normals_[p]) < 0.5 * size) return -1;
            }
            // A face may turn by no more than it bends anyway.
            const auto& before = triangles_[t];
            const Vec3 old = glm::cross(points_[before[1]] - points_[before[0]], points_[before[2]] - points_[before[0]]);
            if (glm::dot(old, normal) < 0.5 * glm::length(old) * size) return -1;
            least = std::min(least, angle_of(moved));
        }
        for (const Index p : first_) {
            if (p == to || fixed_[p] != 0 || fixed_[to] != 0) continue;
            if (bend(points_[p], points_[to], normals_[p], normals_[to]) > slack_) return -1;
        }
        return least;
    }

    static bool contains(const std::array<Index, 3>& t, Index p) { return t[0] == p || t[1] == p || t[2] == p; }

    void collapse(Index from, Index to) {
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
    std::span<const std::uint8_t> fixed_;
    double slack_;
    std::vector<std::array<Index, 3>>& triangles_;
    std::vector<std::vector<Index>> around_;  // the triangles of each point, ascending
    std::vector<std::uint8_t> alive_, border_;
    std::vector<Index> first_, second_, common_;
};

}  // namespace

std::size_t collapse_slivers(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                             std::span<const std::uint8_t> fixed, double slack_world,
                             std::vector<std::array<Index, 3>>& triangles) {
    return Collapser(points, normals, fixed, slack_world, triangles).run();
}

}  // namespace subvol::detail
