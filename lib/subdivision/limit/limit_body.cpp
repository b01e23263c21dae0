// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_body.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/detail/boundary_level.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/detail/surface_builder.h"

namespace subvol {

namespace {

struct Body {
    double volume = 0;
    Box bounds;

    /// Adds a surface whose quads are pairs of triangles. Each is bilinear: the mean of both ways to split it.
    void add(const Surface& surface, const Vec3& origin) {
        for (const Vec3& point : surface.points) bounds.add(point);
        volume += detail::parallel_sums(1, surface.triangles.size() / 2, [&](std::size_t q, std::vector<double>& sum) {
            const auto at = [&](Index p) { return surface.points[p] - origin; };
            const auto& [i, j, k] = surface.triangles[2 * q];
            const Vec3 a = at(i), b = at(j), c = at(k), d = at(surface.triangles[2 * q + 1][2]);
            const auto six_times = [](const Vec3& x, const Vec3& y, const Vec3& z) { return glm::dot(x, glm::cross(y, z)); };
            sum[0] += (six_times(a, b, c) + six_times(a, c, d) + six_times(a, b, d) + six_times(b, c, d)) / 12;
        })[0];
    }
};

/// The last of a sequence whose differences are a quarter of those before.
double at_last(double last, double before) {
    return last + (last - before) / 3;
}

}  // namespace

double LimitBody::difference() const {
    const double of_volume = given_volume > 0 ? std::abs(volume / given_volume - 1) : 0;
    const Vec3 size = given_bounds.size();
    const double side = std::max({size.x, size.y, size.z});
    double of_box = 0;
    for (int axis = 0; axis < 3; ++axis) {
        of_box = std::max({of_box, std::abs(bounds.lower[axis] - given_bounds.lower[axis]),
                           std::abs(bounds.upper[axis] - given_bounds.upper[axis])});
    }
    return std::max(of_volume, side > 0 ? of_box / side : 0);
}

LimitBody limit_body(const HexMesh& mesh, const SchemeOptions& scheme, int levels, Progress* progress) {
    LimitBody body;
    body.given_bounds = bounds(mesh);
    const Vec3 origin = body.given_bounds.center();
    body.given_volume = detail::parallel_sums(1, mesh.cells.size(), [&](std::size_t c, std::vector<double>& sum) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[c][k]] - origin;
        sum[0] += cell_volume(corners);
    })[0];
    Body before{body.given_volume, body.given_bounds}, last;
    HexMesh hull;
    std::vector<std::uint8_t> on_hull;
    if (levels > 1) {
        hull.points = mesh.points;
        hull.cells = mesh.cells;
        hull.creases = mesh.creases;
        hull.sharp_faces = mesh.sharp_faces;
        const RefineOptions options{.scheme = scheme, .levels = levels - 1, .progress = progress};
        hull = detail::hull_before_limit(std::move(hull), options, on_hull);
        before = {};
        before.add(
            detail::boundary_surface_where(
                hull, [&](const auto& face) { return std::ranges::all_of(face, [&](Index p) { return on_hull[p] != 0; }); }),
            origin);
    }
    const HexMesh& parent = levels > 1 ? hull : mesh;
    detail::each_part_of_child(parent, on_hull, scheme, [&](const Surface& part) { last.add(part, origin); });
    body.volume = at_last(last.volume, before.volume);
    for (int axis = 0; axis < 3; ++axis) {
        body.bounds.lower[axis] = at_last(last.bounds.lower[axis], before.bounds.lower[axis]);
        body.bounds.upper[axis] = at_last(last.bounds.upper[axis], before.bounds.upper[axis]);
    }
    return body;
}

}  // namespace subvol
