// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <optional>
#include <random>

#include "lib/random_vector.h"
#include "subvol/hex_mesh.h"

namespace subvol::test {

/// A mesh of points alone.
inline HexMesh only_points(std::vector<Vec3> points) {
    HexMesh mesh;
    mesh.points = std::move(points);
    return mesh;
}

/// A box of nx × ny × nz cells of size 1 from the origin; point i + (nx+1)(j + (ny+1)k).
inline HexMesh make_box(Index nx, Index ny, Index nz) {
    HexMesh mesh;
    for (Index k = 0; k <= nz; ++k) {
        for (Index j = 0; j <= ny; ++j) {
            for (Index i = 0; i <= nx; ++i) mesh.points.emplace_back(i, j, k);
        }
    }
    const auto id = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
    for (Index k = 0; k < nz; ++k) {
        for (Index j = 0; j < ny; ++j) {
            for (Index i = 0; i < nx; ++i) {
                mesh.cells.push_back({id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1),
                                      id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)});
            }
        }
    }
    return mesh;
}

/// The cube [-1,1]³ as one inner cube and six sectors of n³ cells each: 8 extraordinary points, valence-3 edges between them
/// and the corners. Points are shared by position.
inline HexMesh make_nested_cubes(Index n) {
    HexMesh mesh;
    std::vector<std::pair<std::array<long, 3>, Index>> known;
    const auto point = [&](const Vec3& x) {
        const std::array<long, 3> key{std::lround(x.x * 1e6), std::lround(x.y * 1e6), std::lround(x.z * 1e6)};
        for (const auto& [k, id] : known) {
            if (k == key) return id;
        }
        known.emplace_back(key, static_cast<Index>(mesh.points.size()));
        mesh.points.push_back(x);
        return known.back().second;
    };
    const auto block = [&](const std::array<Vec3, 8>& c) {
        const auto at = [&](Index i, Index j, Index k) {
            const double u = double(i) / double(n), v = double(j) / double(n), w = double(k) / double(n);
            const auto mix = [](const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; };
            return point(
                mix(mix(mix(c[0], c[1], u), mix(c[3], c[2], u), v), mix(mix(c[4], c[5], u), mix(c[7], c[6], u), v), w));
        };
        for (Index k = 0; k < n; ++k) {
            for (Index j = 0; j < n; ++j) {
                for (Index i = 0; i < n; ++i) {
                    mesh.cells.push_back({at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                                          at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
                }
            }
        }
    };
    const double h = 0.45;
    std::array<Vec3, 8> inner{Vec3{-h, -h, -h}, Vec3{h, -h, -h}, Vec3{h, h, -h}, Vec3{-h, h, -h},
                              Vec3{-h, -h, h},  Vec3{h, -h, h},  Vec3{h, h, h},  Vec3{-h, h, h}};
    block(inner);
    constexpr std::array<std::array<std::size_t, 4>, 6> sides{
        {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
    for (const auto& s : sides) {
        std::array<Vec3, 8> sector;
        for (std::size_t k = 0; k < 4; ++k) {
            sector[k] = inner[s[k]];
            sector[k + 4] = inner[s[k]] / h;
        }
        block(sector);
    }
    return mesh;
}

/// Moves every point by up to ±amount along each axis.
inline void jitter(HexMesh& mesh, double amount, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-amount, amount);
    for (auto& p : mesh.points) p += random_vector(shift, random);
}

/// Irregular edges and points inside, no two coordinates alike.
inline HexMesh irregular() {
    HexMesh mesh = make_nested_cubes(2);
    jitter(mesh, .03, 7);
    return mesh;
}

inline Vec3 mean(const std::vector<Vec3>& points) {
    return std::accumulate(points.begin(), points.end(), Vec3(0)) / static_cast<double>(points.size());
}

template <class Ids>
Vec3 mean_at(const std::vector<Vec3>& points, const Ids& ids) {
    Vec3 sum(0);
    for (const auto p : ids) sum += points[p];
    return sum / static_cast<double>(std::size(ids));
}

template <class Function>
void add_field(HexMesh& mesh, const std::string& name, const Function& f) {
    Attribute field{name, 1, {}};
    for (const auto& p : mesh.points) field.values.push_back(f(p));
    mesh.attributes.push_back(std::move(field));
}

/// The folder of real meshes, if the environment variable SUBVOL_DATA names one.
inline std::optional<std::filesystem::path> data_folder() {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (!folder || !std::filesystem::is_directory(folder)) return std::nullopt;
    return folder;
}

/// A folder or file beside it, if it exists.
inline std::optional<std::filesystem::path> beside_data(const std::string& name) {
    const auto folder = data_folder();
    if (!folder || !std::filesystem::exists(*folder / ".." / name)) return std::nullopt;
    return *folder / ".." / name;
}

}  // namespace subvol::test
