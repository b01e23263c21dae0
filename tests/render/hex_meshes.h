// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <span>
#include <tuple>
#include <vector>

#include "lib/random_vector.h"
#include "subvol/hex_mesh.h"

namespace subvol::test {

/// A lattice of n.x × n.y × n.z cells over [0,1]³.
///
/// keep: whether the cell with that lower corner is there
inline HexMesh lattice(
    std::array<Index, 3> n, const std::function<bool(Index, Index, Index)>& keep = [](Index, Index, Index) { return true; }) {
    HexMesh mesh;
    for (Index k = 0; k <= n[2]; ++k) {
        for (Index j = 0; j <= n[1]; ++j) {
            for (Index i = 0; i <= n[0]; ++i) mesh.points.push_back(Vec3(i, j, k) / Vec3(n[0], n[1], n[2]));
        }
    }
    const auto id = [&](Index i, Index j, Index k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
    for (Index k = 0; k < n[2]; ++k) {
        for (Index j = 0; j < n[1]; ++j) {
            for (Index i = 0; i < n[0]; ++i) {
                if (!keep(i, j, k)) continue;
                mesh.cells.push_back({id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k),  //
                                      id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)});
            }
        }
    }
    return mesh;
}

inline HexMesh box(Index n) {
    return lattice({n, n, n});
}

/// A box whose inner points are moved by up to `amount` cell widths.
inline HexMesh jittered_box(Index n, double amount, unsigned seed) {
    HexMesh mesh = box(n);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> move(-amount / double(n), amount / double(n));
    for (Vec3& p : mesh.points) {
        const bool inside = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 && p.z > 0 && p.z < 1;
        if (inside) p += random_vector(move, random);
    }
    return mesh;
}

/// The cells of a box with x < ½ or z < ½. The mesh is not convex: rays along the top leave it.
inline HexMesh l_shape(Index n) {
    return lattice({n, n, n}, [n](Index i, Index, Index k) { return 2 * i < n || 2 * k < n; });
}

/// The ball of radius 1 around the origin: concentric cubes are mapped to concentric spheres.
inline HexMesh ball(Index n) {
    HexMesh mesh = box(n);
    for (Vec3& p : mesh.points) {
        const Vec3 q = 2.0 * p - 1.0;
        const double cube = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
        const double radius = glm::length(q);
        p = radius > 0 ? q * (cube / radius) : q;
    }
    return mesh;
}

/// The mesh with its points numbered by position, as in dense grids, so that both split cells alike.
inline HexMesh numbered_by_position(const HexMesh& mesh) {
    std::vector<Index> order(mesh.points.size()), rank(mesh.points.size());
    std::iota(order.begin(), order.end(), Index{0});
    const auto key = [&](Index p) { return std::tuple(mesh.points[p].x, mesh.points[p].y, mesh.points[p].z, p); };
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
    for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = static_cast<Index>(r);
    HexMesh sorted = mesh;
    for (std::size_t p = 0; p < rank.size(); ++p) {
        sorted.points[rank[p]] = mesh.points[p];
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            sorted.attributes[a].values[rank[p]] = mesh.attributes[a].values[p];
        }
    }
    for (auto& cell : sorted.cells) {
        for (Index& p : cell) p = rank[p];
    }
    return sorted;
}

inline std::vector<double> evaluate(const HexMesh& mesh, const std::function<double(const Vec3&)>& field) {
    std::vector<double> values;
    for (const Vec3& p : mesh.points) values.push_back(field(p));
    return values;
}

/// The mesh with these values as its only attribute.
inline HexMesh valued(HexMesh mesh, std::span<const double> values) {
    mesh.attributes = {{"value", 1, {values.begin(), values.end()}}};
    return mesh;
}
inline HexMesh valued(const HexMesh& mesh, double value) {
    return valued(mesh, std::vector<double>(mesh.points.size(), value));
}
inline HexMesh valued(const HexMesh& mesh, const std::function<double(const Vec3&)>& field) {
    return valued(mesh, evaluate(mesh, field));
}

}  // namespace subvol::test
