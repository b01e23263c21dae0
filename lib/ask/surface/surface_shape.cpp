// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace subvol::detail {

namespace {

constexpr double kSharp = 0.8;  // cosine: triangles of the hull that bend by more meet at a crease

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
    double area = 0, least = 180;
    std::size_t small = 0;
    for (const auto& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
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
    report.volume = enclosed_volume(surface);
    report.watertight = watertight;
    report.euler = static_cast<long>(points) - static_cast<long>(edge_count) + static_cast<long>(surface.triangles.size());
    report.components = components;
    report.min_angle_deg = surface.triangles.empty() ? 0 : least;
    report.small_angles =
        surface.triangles.empty() ? 0 : static_cast<double>(small) / static_cast<double>(surface.triangles.size());
}

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

}  // namespace subvol::detail
