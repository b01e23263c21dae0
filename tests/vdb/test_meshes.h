// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::test {

inline constexpr double kPi = 3.14159265358979323846;

using Field = std::function<double(const Vec3&)>;

/// n³ cells over the box of `lower` and `upper`, in the order of the points.
inline HexMesh box_mesh(Index n, const Vec3& lower = Vec3(0.0), const Vec3& upper = Vec3(1.0)) {
    HexMesh mesh;
    const auto id = [n](Index i, Index j, Index k) { return (k * (n + 1) + j) * (n + 1) + i; };
    for (Index k = 0; k <= n; ++k) {
        for (Index j = 0; j <= n; ++j) {
            for (Index i = 0; i <= n; ++i) mesh.points.push_back(lower + (upper - lower) * (Vec3(i, j, k) / Vec3(double(n))));
        }
    }
    for (Index k = 0; k < n; ++k) {
        for (Index j = 0; j < n; ++j) {
            for (Index i = 0; i < n; ++i) {
                mesh.cells.push_back({id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1),
                                      id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)});
            }
        }
    }
    return mesh;
}

/// The unit box with inner points moved at random by up to 30 % of a cell, so that all inner faces are bent.
inline HexMesh jittered_box_mesh(Index n, unsigned seed = 1) {
    HexMesh mesh = box_mesh(n);
    std::mt19937 random(seed);
    const auto step = [&] { return 0.6 * (static_cast<double>(random()) / 4294967295.0 - 0.5) / double(n); };
    for (Vec3& p : mesh.points) {
        const Vec3 moved = p + Vec3(step(), step(), step());
        const bool inner = glm::all(glm::greaterThan(p, Vec3(1e-9))) && glm::all(glm::lessThan(p, Vec3(1.0 - 1e-9)));
        if (inner) p = moved;
    }
    return mesh;
}

/// A cube of n³ cells mapped to the unit ball; the cube's edges and corners become flat there.
inline HexMesh ball_mesh(Index n) {
    HexMesh mesh = box_mesh(n, Vec3(-1.0), Vec3(1.0));
    for (Vec3& p : mesh.points) {
        const Vec3 q = p * p;
        p *= Vec3(std::sqrt(1 - q.y / 2 - q.z / 2 + q.y * q.z / 3), std::sqrt(1 - q.z / 2 - q.x / 2 + q.z * q.x / 3),
                  std::sqrt(1 - q.x / 2 - q.y / 2 + q.x * q.y / 3));
    }
    return mesh;
}

inline void add_field(HexMesh& mesh, const std::string& name, const Field& field) {
    Attribute attribute{name, 1, {}};
    for (const Vec3& p : mesh.points) attribute.values.push_back(field(p));
    mesh.attributes.push_back(std::move(attribute));
}

inline HexMesh with_field(HexMesh mesh, const std::string& name, const Field& field) {
    add_field(mesh, name, field);
    return mesh;
}

/// Calls visit(centre) for all voxel centres h·ijk with every |i|,|j|,|k| up to n.
template <class Visit>
void for_each_centre(double h, int n, const Visit& visit) {
    for (int i = -n; i <= n; ++i) {
        for (int j = -n; j <= n; ++j) {
            for (int k = -n; k <= n; ++k) visit(h * Vec3(i, j, k));
        }
    }
}

}  // namespace subvol::test
