// SPDX-License-Identifier: Apache-2.0
#include "settled_cut.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "subvol/detail/parallel_each.h"
#include "surface_shape.h"

namespace subvol::detail {

namespace {

constexpr double kCrease = 0.9;  // cosine: normals of the limit and of the triangles that differ by more are on a crease

/// The normals of the limit, but where sides meet those of the triangles.
std::vector<Vec3> normals_of(const SettledCut& cut) {
    const std::vector<Vec3>& positions = cut.settled.positions;
    const std::vector<std::array<Index, 3>>& triangles = cut.soup.triangles;
    std::vector<Vec3> of_hull(positions.size(), Vec3(0.0)), of_iso = of_hull, normals = cut.settled.normals;
    std::vector<std::uint8_t> creased(positions.size(), 0);
    const auto facet = [&](const std::array<Index, 3>& t) {
        const Vec3& a = positions[t[0]];
        return glm::cross(positions[t[1]] - a, positions[t[2]] - a);
    };
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const Index p : triangles[t]) (cut.soup.hull[t] != 0 ? of_hull : of_iso)[p] += facet(triangles[t]);
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (cut.soup.hull[t] == 0) continue;
        const Vec3 normal = facet(triangles[t]);
        for (const Index p : triangles[t]) {
            if (glm::dot(normal, normals[p]) < kCrease * glm::length(normal)) creased[p] = 1;
        }
    }
    const auto unit = [](const Vec3& v) { return glm::length(v) > 0 ? v / glm::length(v) : Vec3(0.0); };
    for (std::size_t p = 0; p < normals.size(); ++p) {
        const bool hull = of_hull[p] != Vec3(0.0), iso = of_iso[p] != Vec3(0.0);
        if (hull && iso) {
            normals[p] = unit(unit(of_hull[p]) + (normals[p] != Vec3(0.0) ? normals[p] : unit(of_iso[p])));
        } else if (creased[p] != 0 || normals[p] == Vec3(0.0)) {
            normals[p] = unit(hull ? of_hull[p] : of_iso[p]);
        }
    }
    return normals;
}

/// One point for all parts that have it: of the first of its cells, but where it lies on the hull of one that shows it there,
/// as in one part. Returns the numbers of the parts' points in the result.
std::vector<std::vector<Index>> join_points(std::span<const SettledCut> parts, SettledCut& whole) {
    struct NamedPoint {
        VertexNumber a, b;
        bool off_hull;
        Index cell;
        std::uint32_t part;
        Index at;
        auto operator<=>(const NamedPoint&) const = default;
    };
    std::vector<NamedPoint> named;
    std::vector<std::vector<Index>> numbers;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<SurfacePoint>& points = parts[p].soup.points;
        numbers.emplace_back(points.size());
        for (Index at = 0; at < points.size(); ++at) {
            const SurfacePoint& point = points[at];
            named.push_back({point.a, point.b, point.side == 6, point.cell, static_cast<std::uint32_t>(p), at});
        }
    }
    tbb::parallel_sort(named.begin(), named.end());
    whole.settled.fields = without_points(parts[0].settled.fields);
    for (std::size_t i = 0; i < named.size(); ++i) {
        const NamedPoint& point = named[i];
        if (i == 0 || point.a != named[i - 1].a || point.b != named[i - 1].b) {
            whole.soup.points.push_back(parts[point.part].soup.points[point.at]);
            whole.settled.add(parts[point.part].settled, point.at);
        }
        numbers[point.part][point.at] = static_cast<Index>(whole.soup.points.size() - 1);
    }
    return numbers;
}

}  // namespace

SettledCut joined(std::vector<SettledCut> parts) {
    SettledCut whole{.level = parts[0].level,
                     .deviation_world = parts[0].deviation_world,
                     .converged = parts[0].converged,
                     .soup = {},
                     .settled = {}};
    const std::vector<std::vector<Index>> numbers = join_points(parts, whole);
    struct CutCell {
        Index cell;
        std::size_t part, at;
        auto operator<=>(const CutCell&) const = default;
    };
    std::vector<CutCell> cells;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        for (std::size_t at = 0; at < parts[p].soup.cells.size(); ++at) cells.push_back({parts[p].soup.cells[at], p, at});
    }
    tbb::parallel_sort(cells.begin(), cells.end());
    for (const auto& [cell, part, at] : cells) {
        if (!whole.soup.cells.empty() && whole.soup.cells.back() == cell) continue;
        const SurfaceSoup& soup = parts[part].soup;
        for (std::size_t t = at > 0 ? soup.ends[at - 1] : 0; t < soup.ends[at]; ++t) {
            const auto& [a, b, c] = soup.triangles[t];
            whole.soup.triangles.push_back({numbers[part][a], numbers[part][b], numbers[part][c]});
            whole.soup.hull.push_back(soup.hull[t]);
        }
        whole.soup.cells.push_back(cell);
        whole.soup.ends.push_back(whole.soup.triangles.size());
    }
    return whole;
}

void add_cut(const SettledCut& cut, bool improve, double slack_world, LimitSurface& all) {
    const SettledPoints& settled = cut.settled;
    const std::vector<Vec3> normals = normals_of(cut);
    std::vector<std::array<Index, 3>> triangles = cut.soup.triangles;
    if (improve) {
        const bool boundary_alone = std::ranges::all_of(cut.soup.hull, [](std::uint8_t hull) { return hull != 0; });
        const MendSlack slack{slack_world, kOfMending * slack_world, !boundary_alone};
        all.report.mended += mend_slivers(settled.positions, normals, sharp_lines(settled.positions, triangles, cut.soup.hull),
                                          slack, triangles);
    }
    if (all.fields.empty()) all.fields = without_points(settled.fields);
    std::vector<Index> numbers(settled.positions.size(), kNone);
    for (const auto& t : triangles) {
        for (const Index p : t) numbers[p] = 0;
    }
    for (Index p = 0; p < numbers.size(); ++p) {
        if (numbers[p] == kNone) continue;
        numbers[p] = static_cast<Index>(all.surface.points.size());
        all.surface.points.push_back(settled.positions[p]);
        all.normals.push_back(normals[p]);
        all.places.push_back(settled.places[p]);
        add_fields(settled.fields, p, all.fields);
    }
    for (auto t : triangles) {
        for (Index& p : t) p = numbers[p];
        all.surface.triangles.push_back(t);
    }
    all.report.level = std::max(all.report.level, cut.level);
    all.report.deviation_world = std::max(all.report.deviation_world, cut.deviation_world);
    all.report.converged = all.report.converged && cut.converged;
    all.report.cells += cut.soup.cells.size();
}

}  // namespace subvol::detail
