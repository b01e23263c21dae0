// SPDX-License-Identifier: Apache-2.0
// Straight stars of cells about an edge, and the rules of segments as the definitions of the schemes have them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "edge_kind.h"
#include "lib/subdivision/certificate/scheme_definition.h"
#include "subvol/refine.h"

namespace subvol::detail::edge_kind_test {

using Eigen::MatrixXd;

constexpr double kPi = 3.14159265358979323846;

inline std::string name_of(Scheme scheme, std::size_t cells) {
    return (scheme == Scheme::Bsxw ? "bsxw " : "cc ") + std::to_string(cells);
}

// A star: sectors of reach × reach cells about an edge, in layers. Sectors are as wide as each other.
struct StarMesh {
    Star star;
    std::size_t layers;
    HexMesh mesh;

    [[nodiscard]] std::size_t point(std::size_t s, int i, int j, std::size_t layer) const {
        return layer * star.points() + star.number(s, i, j);
    }
};

inline StarMesh make_star(std::size_t cells, std::size_t reach, std::size_t layers) {
    StarMesh made{{cells, reach}, layers, {}};
    made.mesh.points.resize(made.star.points() * (layers + 1));
    const double turn = 2 * kPi / static_cast<double>(cells);
    const int last = static_cast<int>(reach);
    for (std::size_t l = 0; l <= layers; ++l) {
        for (std::size_t s = 0; s < cells; ++s) {
            const double a = turn * static_cast<double>(s), b = a + turn;
            for (int i = 0; i <= last; ++i) {
                for (int j = 0; j <= last; ++j) {
                    made.mesh.points[made.point(s, i, j, l)] = {i * std::cos(a) + j * std::cos(b),
                                                                i * std::sin(a) + j * std::sin(b), static_cast<double>(l)};
                    if (i == last || j == last || l == layers) continue;
                    std::array<Index, 8> cell{};
                    for (std::size_t k = 0; k < 8; ++k) {
                        const int u = k == 1 || k == 2 || k == 5 || k == 6 ? 1 : 0, v = k % 4 >= 2 ? 1 : 0;
                        cell[k] = static_cast<Index>(made.point(s, i + u, j + v, l + k / 4));
                    }
                    made.mesh.cells.push_back(cell);
                }
            }
        }
    }
    return made;
}

inline void move_at_random(HexMesh& mesh, double amount, unsigned seed) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> off(-amount, amount);
    for (Vec3& x : mesh.points) x += Vec3(off(dice), off(dice), off(dice));
}

// The cells at the segment that starts at a layer.
inline std::vector<Index> cells_at_segment(const StarMesh& star, std::size_t layer) {
    std::vector<Index> cells;
    for (Index c = 0; c < star.mesh.cells.size(); ++c) {
        const auto& cell = star.mesh.cells[c];
        const auto has = [&](std::size_t p) { return std::ranges::find(cell, static_cast<Index>(p)) != cell.end(); };
        if (has(star.point(0, 0, 0, layer)) && has(star.point(0, 0, 0, layer + 1))) cells.push_back(c);
    }
    return cells;
}

// Two steps along the star are one in the definition's mesh.
inline EdgeRules defined_rules(Scheme scheme, std::size_t cells) {
    constexpr std::size_t kFirst = 2;
    const StarMesh mesh = make_star(cells, 3, 5);
    const test::Definition definition(mesh.mesh.cells);
    const Star window{cells, EdgeWindow::kReach};
    const auto columns = static_cast<Eigen::Index>(EdgeWindow::kLayers * window.points());
    std::map<Index, Eigen::Index> column;
    std::vector<std::array<int, 4>> places;  // s, i, j, layer of each point of the window
    places.resize(static_cast<std::size_t>(columns));
    for (int l = -1; l <= 2; ++l) {
        for (std::size_t s = 0; s < cells; ++s) {
            for (int i = 0; i <= 2; ++i) {
                for (int j = 0; j <= 2; ++j) {
                    const std::size_t p = static_cast<std::size_t>(l + 1) * window.points() + window.number(s, i, j);
                    column[static_cast<Index>(mesh.point(s, i, j, static_cast<std::size_t>(l + 2)))] =
                        static_cast<Eigen::Index>(p);
                    places[p] = {static_cast<int>(s), i, j, l};
                }
            }
        }
    }
    // The weights of the point (s, i, j) in a layer, in half steps from the segment's start.
    const auto put = [&](MatrixXd& rows, Eigen::Index row, int s, int i, int j, int layer) {
        if (j < 0) return std::tuple(s == 0 ? static_cast<int>(cells) - 1 : s - 1, -j, i, layer, &rows, row);
        return std::tuple(s, i, j, layer, &rows, row);
    };
    const auto fill = [&](const auto& at) {
        const auto& [s, i, j, layer, rows, row] = at;
        std::set<Index> corners;
        for (int k = 0; k < 8; ++k) {
            const auto half = [&](int x, int up) {
                return (x + (x % 2 != 0 && up != 0 ? 1 : 0) - (x % 2 != 0 && up == 0 ? 1 : 0)) / 2;
            };
            corners.insert(static_cast<Index>(mesh.point(static_cast<std::size_t>(s), half(i, k & 1), half(j, k & 2),
                                                         static_cast<std::size_t>(half(layer + 4, k & 4)))));
        }
        rows->row(row).setZero();
        for (const auto& [p, weight] : definition.weights(scheme, corners)) {
            if (weight != 0) (*rows)(row, column.at(p)) = weight;
        }
    };
    static_assert(kFirst == 2);
    EdgeRules rules{cells, {}, {}};
    for (int h = 0; h < 2; ++h) {
        MatrixXd& rows = rules.halves[static_cast<std::size_t>(h)];
        rows.resize(columns, columns);
        for (Eigen::Index k = 0; k < columns; ++k) {
            const auto& [s, i, j, l] = places[static_cast<std::size_t>(k)];
            fill(put(rows, k, s, i, j, h + l));
        }
        MatrixXd& ring = rules.ring[static_cast<std::size_t>(h)];
        ring.resize(64, columns);
        for (int p = 0; p < 64; ++p) fill(put(ring, p, 0, p / 16, h - 1 + p / 4 % 4, p % 4 - 1));
    }
    return rules;
}

}  // namespace subvol::detail::edge_kind_test
