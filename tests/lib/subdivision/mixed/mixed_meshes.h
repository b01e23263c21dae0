// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "lib/random_vector.h"
#include "lib/test_meshes.h"
#include "subvol/refine_mixed.h"

namespace subvol::test {

/// The lattice of the box spline: each cell of an n³ box in six tetrahedra along its diagonal from (0,0,0) to (1,1,1).
inline MixedMesh make_kuhn_box(Index n) {
    HexMesh box = make_box(n, n, n);
    MixedCells cells;
    constexpr std::array<std::array<std::size_t, 4>, 6> kPaths{
        {{0, 1, 2, 6}, {0, 1, 5, 6}, {0, 3, 2, 6}, {0, 3, 7, 6}, {0, 4, 5, 6}, {0, 4, 7, 6}}};
    for (const auto& c : box.cells) {
        for (const auto& path : kPaths) cells.tets.push_back({c[path[0]], c[path[1]], c[path[2]], c[path[3]]});
    }
    box.cells.clear();
    return make_mixed_mesh(box, cells);
}

/// A cube in tetrahedra, drawn to a ball of radius 1, with a little disorder inside.
inline MixedMesh make_tet_ball(Index n) {
    MixedMesh mesh = make_kuhn_box(n);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> jitter(-0.15, 0.15);
    for (Vec3& p : mesh.points) {
        p = p * (2.0 / n) - Vec3(1);
        const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (most < 0.99) p += random_vector(jitter, random) / static_cast<double>(n);
        const double length = glm::length(p);
        if (length > 0) p *= 0.5 * most / length + 0.5 * (1 - 0.4 * most * most + 0.4 * most * most * most / length);
        if (most > 0.99) p = glm::normalize(p);
    }
    return mesh;
}

/// One octahedron with its corners at distance 1.
inline MixedMesh make_octahedron() {
    MixedMesh mesh;
    mesh.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.octahedra = {{0, 1, 2, 3, 4, 5}};
    return mesh;
}

/// A hexahedron, a pyramid on it, two prisms beside it and a tetrahedron: every kind of seam between them.
inline MixedMesh make_mixed() {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},  {0, 1, 0},  {0, 0, 1},     {1, 0, 1},
                   {1, 1, 1}, {0, 1, 1}, {2, .5, 0}, {2, .5, 1}, {.5, .5, 1.8}, {1.7, .6, 2}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
    MixedCells others;
    others.prisms = {{1, 8, 2, 5, 9, 6}};
    others.pyramids = {{4, 5, 6, 7, 10}};
    others.tets = {{5, 9, 6, 11}, {5, 6, 10, 11}};
    return make_mixed_mesh(mesh, others);
}

inline Attribute sampled(const MixedMesh& mesh, const std::function<double(const Vec3&)>& f) {
    Attribute result{"f", 1, {}};
    for (const Vec3& p : mesh.points) result.values.push_back(f(p));
    return result;
}

}  // namespace subvol::test
