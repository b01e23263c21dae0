// SPDX-License-Identifier: Apache-2.0
#include "extreme_bounds.h"

#include <algorithm>
#include <cmath>

#include "grid_measure.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kNodes = 27;

/// How far a node lies from the trilinear piece.
double largest_step(std::span<const double> nodes) {
    std::array<double, kNodes> piece;
    std::ranges::copy(nodes, piece.begin());
    const std::array<double, kNodes> flat = trilinear(piece);
    double largest = 0;
    for (std::size_t n = 0; n < kNodes; ++n) largest = std::max(largest, std::abs(nodes[n] - flat[n]));
    return largest;
}

/// By how much nodes of the finest level differ from the parabolas through those of the level before, in the piece of that
/// level that begins at `first`: the largest difference along each axis, summed.
double bend_of_lines(std::span<const double> grid, std::size_t side, std::size_t first) {
    const std::array<std::size_t, 3> strides{1, side, side * side};
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t step = strides[axis], other = strides[(axis + 1) % 3], third = strides[(axis + 2) % 3];
        double largest = 0;
        for (std::size_t line = 0; line < 25; ++line) {
            const double* f = &grid[first + line % 5 * other + line / 5 * third];
            const double middle = 6 * f[2 * step], ends[2] = {f[0], f[4 * step]};
            largest = std::max({largest, std::abs((3 * ends[0] + middle - ends[1]) / 8 - f[step]),
                                std::abs((3 * ends[1] + middle - ends[0]) / 8 - f[3 * step])});
        }
        sum += largest;
    }
    return sum;
}

/// The quadratic through a node and its 26 neighbours by central differences in steps of the grid.
struct NodeQuadratic {
    double value;
    Vec3 slope{0.0};
    Mat3 bend{0.0};

    NodeQuadratic(const double* f, std::size_t side) : value(*f) {
        const std::array<std::ptrdiff_t, 3> strides{1, static_cast<std::ptrdiff_t>(side),
                                                    static_cast<std::ptrdiff_t>(side * side)};
        for (int d = 0; d < 3; ++d) {
            const std::ptrdiff_t i = strides[static_cast<std::size_t>(d)];
            slope[d] = (f[i] - f[-i]) / 2;
            bend[d][d] = f[i] - 2 * f[0] + f[-i];
            for (int e = 0; e < d; ++e) {
                const std::ptrdiff_t j = strides[static_cast<std::size_t>(e)];
                bend[d][e] = bend[e][d] = (f[i + j] - f[i - j] - f[j - i] + f[-i - j]) / 4;
            }
        }
    }
    [[nodiscard]] double at(const Vec3& place) const {
        return value + glm::dot(slope, place) + glm::dot(place, bend * place) / 2;
    }
    /// The best place, from -1 to 1, along one axis after the other.
    [[nodiscard]] Vec3 peak(Vec3 place) const {
        constexpr int kRounds = 24;
        for (int round = 0; round < kRounds; ++round) {
            const Vec3 before = place;
            for (int d = 0; d < 3; ++d) {
                const double rise = slope[d] + bend[0][d] * place.x + bend[1][d] * place.y + bend[2][d] * place.z;
                if (bend[d][d] < 0) {
                    place[d] = std::clamp(place[d] - rise / bend[d][d], -1.0, 1.0);
                } else if (rise != 0) {
                    place[d] = rise > 0 ? 1 : -1;
                }
            }
            if (place == before) break;
        }
        return place;
    }
};

/// The largest value of the quadratic of the piece around a node, and what it lacks by its 27 nodes, and by how the finest
/// level differs from the one before.
double piece_bound(std::span<const double> grid, std::size_t side, std::size_t u, std::size_t v, std::size_t w) {
    const double* middle = &grid[u + side * (v + side * w)];
    const NodeQuadratic quadratic(middle, side);
    const double bend = bend_of_lines(grid, side, u / 4 * 4 + side * (v / 4 * 4 + side * (w / 4 * 4))) / 2;
    double highest = -HUGE_VAL, off = 0;
    Vec3 best(0.0);
    const auto row = static_cast<std::ptrdiff_t>(side);
    for (int n = 0; n < static_cast<int>(kNodes); ++n) {
        const std::array<int, 3> step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        const Vec3 at(step[0], step[1], step[2]);
        const double value = middle[step[0] + row * (step[1] + row * step[2])];
        if (value > highest) best = at;
        highest = std::max(highest, value);
        off = std::max(off, std::abs(quadratic.at(at) - value));
    }
    return std::max(highest, quadratic.at(quadratic.peak(best))) + bend + off / 2;
}

}  // namespace

/// Half of how far a node of the piece lies from the trilinear one between its corners is what the limit goes beyond the nodes
/// at most: where it is smooth it is a quarter, and twice that is for its kinks.
double first_bound(std::span<const double> grid, double known) {
    constexpr double kReach = 0.5;
    const auto [low, high] = std::ranges::minmax(grid);
    if (high + kReach * (high - low) < known) return -HUGE_VAL;  // no node is farther from the corners than the two
    return high + kReach * largest_step(grid);
}

double finer_bound(std::span<const double> grid, std::size_t side, double known) {
    const auto [low, high] = std::ranges::minmax(grid);
    if (high + (high - low) < known) return -HUGE_VAL;
    double bound = -HUGE_VAL;
    for (std::size_t w = 1; w < side; w += 2) {
        for (std::size_t v = 1; v < side; v += 2) {
            for (std::size_t u = 1; u < side; u += 2) bound = std::max(bound, piece_bound(grid, side, u, v, w));
        }
    }
    return bound;
}

std::array<double, 8> octant_bounds(std::span<const double, 125> grid) {
    std::array<double, 8> bounds;
    for (std::size_t k = 0; k < 8; ++k)
        bounds[k] = piece_bound(grid, 5, 1 + 2 * (k & 1), 1 + 2 * (k >> 1 & 1), 1 + 2 * (k >> 2));
    return bounds;
}

Vec3 peak_near(std::span<const double> grid, std::size_t side, std::size_t node) {
    const std::array<std::size_t, 3> at{node % side, node / side % side, node / side / side};
    std::array<std::size_t, 3> middle;
    Vec3 place(0.0);
    for (std::size_t d = 0; d < 3; ++d) {
        middle[d] = std::clamp<std::size_t>(at[d], 1, side - 2);
        place[static_cast<int>(d)] = static_cast<double>(at[d]) - static_cast<double>(middle[d]);
    }
    const NodeQuadratic quadratic(&grid[middle[0] + side * (middle[1] + side * middle[2])], side);
    return (Vec3(middle[0], middle[1], middle[2]) + quadratic.peak(place)) / static_cast<double>(side - 1);
}

}  // namespace subvol::detail
