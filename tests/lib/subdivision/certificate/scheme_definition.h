// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "subvol/index.h"
#include "subvol/scheme.h"

namespace subvol::test {

/// The rules of Catmull-Clark and BSXW inside a mesh, from their definitions; no code of the library. A point of the next level
/// is known by the corners of the vertex, edge, face or cell that it is made from.
class Definition {
public:
    explicit Definition(const std::vector<std::array<Index, 8>>& cells) {
        for (const auto& cell : cells) {
            for (std::size_t k = 0; k < 8; ++k) {
                const std::array<int, 3> at{k == 1 || k == 2 || k == 5 || k == 6, k % 4 >= 2, k / 4 == 1};
                for (std::size_t n = 0; n < 8; ++n) {
                    const std::array<int, 3> other{n == 1 || n == 2 || n == 5 || n == 6, n % 4 >= 2, n / 4 == 1};
                    apart_[{cell[k], cell[n]}] =
                        std::abs(at[0] - other[0]) + std::abs(at[1] - other[1]) + std::abs(at[2] - other[2]);
                }
            }
            cells_.push_back({cell.begin(), cell.end()});
        }
    }

    using Weights = std::map<Index, double>;

    [[nodiscard]] Weights weights(Scheme scheme, const std::set<Index>& corners) const {
        return scheme == Scheme::Bsxw ? averaged(corners) : catmull_clark(corners);
    }

private:
    [[nodiscard]] static bool contains(const std::set<Index>& all, const std::set<Index>& some) {
        return std::ranges::includes(all, some);
    }

    static void add(Weights& to, const std::set<Index>& mean, double weight) {
        for (const Index p : mean) to[p] += weight / static_cast<double>(mean.size());
    }

    // The mean of the centroids of the small hexahedra at the point: each is a trilinear point a quarter of the way in.
    [[nodiscard]] Weights averaged(const std::set<Index>& corners) const {
        Weights sum;
        double count = 0;
        for (const auto& cell : cells_) {
            if (!contains(cell, corners)) continue;
            for (const Index corner : corners) {
                ++count;
                for (const Index p : cell)
                    sum[p] += std::pow(0.75, 3 - apart_.at({corner, p})) * std::pow(0.25, apart_.at({corner, p}));
            }
        }
        for (auto& [p, weight] : sum) weight /= count;
        return sum;
    }

    // The faces (or edges) of a cell that contain some corners.
    [[nodiscard]] std::set<std::set<Index>> sides(const std::set<Index>& corners, std::size_t size) const {
        std::set<std::set<Index>> all;
        for (const auto& cell : cells_) {
            if (!contains(cell, corners)) continue;
            for (const Index a : cell) {
                for (const Index b : cell) {
                    if (apart_.at({a, b}) != (size == 4 ? 2 : 1)) continue;
                    std::set<Index> side;  // the points between two corners of it
                    for (const Index p : cell) {
                        if (apart_.at({a, p}) + apart_.at({p, b}) == apart_.at({a, b})) side.insert(p);
                    }
                    if (contains(side, corners)) all.insert(side);
                }
            }
        }
        return all;
    }

    [[nodiscard]] Weights catmull_clark(const std::set<Index>& corners) const {
        Weights sum;
        std::set<std::set<Index>> cells;
        for (const auto& cell : cells_) {
            if (contains(cell, corners)) cells.insert(cell);
        }
        const auto add_means = [&](const std::set<std::set<Index>>& means, double weight) {
            for (const auto& mean : means) add(sum, mean, weight / static_cast<double>(means.size()));
        };
        const auto faces = sides(corners, 4), edges = sides(corners, 2);
        const auto n = static_cast<double>(faces.size());
        switch (corners.size()) {
            case 8:
                add_means(cells, 1);
                break;
            case 4:  // (C̄ + A)/2
                add_means(cells, 0.5);
                add(sum, corners, 0.5);
                break;
            case 2:  // (C̄ + 2Ā + (n − 3)M)/n
                add_means(cells, 1 / n);
                add_means(faces, 2 / n);
                add(sum, corners, (n - 3) / n);
                break;
            default:  // (C̄ + 3Ā + 3M̄ + V)/8
                add_means(cells, 1.0 / 8);
                add_means(faces, 3.0 / 8);
                add_means(edges, 3.0 / 8);
                add(sum, corners, 1.0 / 8);
        }
        return sum;
    }

    std::vector<std::set<Index>> cells_;
    std::map<std::pair<Index, Index>, int> apart_;
};

}  // namespace subvol::test
