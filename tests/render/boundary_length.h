// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tet_mesh.h"
#include "tet_walk.h"

namespace subvol::test {

using namespace detail;

/// A triangle's area as seen by the ray, in parts of its distance², below which it is rounding.
inline constexpr double kThin = 1e-14;

/// Whether the corners of the cells are numbered in the opposite orientation.
inline bool left_handed(const TetMesh& mesh, std::size_t cell) {
    double volume = 0;
    for (std::size_t t = 6 * cell; t < 6 * cell + 6; ++t) {
        const auto p = [&](std::size_t k) { return mesh.points[mesh.tets[t].corner[k]].position; };
        volume += dot(cross(p(1) - p(0), p(2) - p(0)), p(3) - p(0));
    }
    return volume < 0;
}

/// The length of the ray, from its origin on, for which the boundary's winding number is not 0: from all triangles one by one,
/// without any adjacency.
inline double length_inside(const TetMesh& mesh, const Ray& ray) {
    struct Cut {
        double t;
        int sign;
    };
    std::vector<Cut> cuts;
    for (const TetFace face : mesh.boundary) {
        const auto ids = mesh.corners(face);
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.points[ids[k]].position - ray.origin;
        const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
        const double a = dot(ray.direction, cross(p[0], p[1])), b = dot(ray.direction, cross(p[1], p[2])),
                     c = dot(ray.direction, cross(p[2], p[0]));
        if ((a > 0) != (b > 0) || (b > 0) != (c > 0)) continue;
        if (std::abs(a + b + c) < kThin * glm::length(ray.direction) * dot(p[0], p[0])) continue;
        // The inner side follows from the numbering of a tetrahedron, not from its shape, so that folds cancel.
        const int parity = (face % 4 % 2 == 0 ? 1 : -1) * (left_handed(mesh, face / 24) ? -1 : 1);
        cuts.push_back({dot(p[0], normal) / dot(ray.direction, normal), (a > 0 ? 1 : -1) * parity});
    }
    std::sort(cuts.begin(), cuts.end(), [](const Cut& x, const Cut& y) { return x.t < y.t; });
    double length = 0;
    int winding = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        winding += cuts[i].sign;
        if (winding != 0) length += std::max(0.0, cuts[i + 1].t) - std::max(0.0, cuts[i].t);
    }
    return length * glm::length(ray.direction);
}

/// The offset of the rays beside a ray, in diagonals.
inline constexpr double kBeside = 1e-6;

/// The difference of a length inside, in diagonals, from that between the boundary's crossings. A ray along the boundary is
/// inside or outside or alternates: if the difference exceeds `tolerance`, the length has to lie between those of eight rays
/// beside it.
inline double length_error(const TetMesh& mesh, const Ray& ray, double length, double diagonal, double tolerance) {
    const Vec3 right = normalize(cross(ray.direction, Vec3(0.3, 0.5, 0.8))), up = normalize(cross(right, ray.direction));
    const auto error = [&](int count) {
        double least = 1e30, most = 0;
        for (int k = 0; k < count; ++k) {
            const double angle = 0.3 + k * 0.7853981633974483;
            const Vec3 aside = kBeside * diagonal * (std::cos(angle) * right + std::sin(angle) * up);
            const double inside = length_inside(mesh, {ray.origin + aside, ray.direction}) / diagonal;
            least = std::min(least, inside);
            most = std::max(most, inside);
        }
        return std::max({0.0, least - length, length - most});
    };
    const double one = error(1);
    return one > tolerance ? error(8) : one;
}

/// The 26 directions along axes, diagonals of faces and diagonals of a cube.
inline std::vector<Vec3> directions() {
    std::vector<Vec3> all;
    for (int k = 0; k < 27; ++k) {
        if (k != 13) all.emplace_back(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    }
    return all;
}

}  // namespace subvol::test
