// SPDX-License-Identifier: Apache-2.0
#include "extreme_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "grid_measure.h"
#include "subvol/detail/word_hash.h"

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
/// level that begins at `first`: along each axis, on each of its 25 lines, which are numbered along the next axis first.
using LineBends = std::array<std::array<double, 25>, 3>;
LineBends bends_of_lines(std::span<const double> grid, std::size_t side, std::size_t first) {
    const std::array<std::size_t, 3> strides{1, side, side * side};
    LineBends bends;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t step = strides[axis], other = strides[(axis + 1) % 3], third = strides[(axis + 2) % 3];
        for (std::size_t line = 0; line < 25; ++line) {
            const double* f = &grid[first + line % 5 * other + line / 5 * third];
            const double middle = 6 * f[2 * step], ends[2] = {f[0], f[4 * step]};
            bends[axis][line] = std::max(std::abs((3 * ends[0] + middle - ends[1]) / 8 - f[step]),
                                         std::abs((3 * ends[1] + middle - ends[0]) / 8 - f[3 * step]));
        }
    }
    return bends;
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

constexpr std::size_t kPlaces = 5;  // along each axis, at which a piece is looked at: its nodes and the middles between them

/// The values of the triquadratic piece around a node at 5³ places: one axis after the other.
std::array<double, kPlaces * kPlaces * kPlaces> values_at_places(const double* middle, std::size_t side) {
    const auto stretch = [](const double* f, std::size_t step, double* to, std::size_t to_step) {
        const double a = f[0], b = f[step], c = f[2 * step];
        to[0] = a;
        to[to_step] = (3 * a + 6 * b - c) / 8;
        to[2 * to_step] = b;
        to[3 * to_step] = (3 * c + 6 * b - a) / 8;
        to[4 * to_step] = c;
    };
    std::array<double, 9 * kPlaces> one;
    std::array<double, 3 * kPlaces * kPlaces> two;
    std::array<double, kPlaces * kPlaces * kPlaces> places;
    const double* first = middle - 1 - side - side * side;
    for (std::size_t n = 0; n < 9; ++n) stretch(first + side * (n % 3 + side * (n / 3)), 1, &one[kPlaces * n], 1);
    for (std::size_t u = 0; u < kPlaces; ++u) {
        for (std::size_t w = 0; w < 3; ++w) stretch(&one[u + 15 * w], kPlaces, &two[u + 25 * w], kPlaces);
    }
    for (std::size_t n = 0; n < 25; ++n) stretch(&two[n], 25, &places[n], 25);
    return places;
}

/// How far the parabola through three values rises above the middle one, if that is the largest.
double vertex_excess(double before, double middle, double after) {
    const double bend = 2 * middle - before - after;
    return middle >= before && middle >= after && bend > 0 ? (after - before) * (after - before) / (8 * bend) : 0;
}

/// The largest value of the triquadratic piece around a node, and what the limit may differ from it. That is nothing at the
/// nodes, and most half way between them: along each axis a part of by how much the finest level differs from the one before,
/// on the lines beside. So a side on which a field is constant bounds the piece, however the field bends away from it.
double piece_bound(std::span<const double> grid, std::size_t side, std::size_t u, std::size_t v, std::size_t w) {
    constexpr std::array<std::size_t, 3> kStrides{1, kPlaces, kPlaces * kPlaces};
    const auto values = values_at_places(&grid[u + side * (v + side * w)], side);
    const LineBends bends = bends_of_lines(grid, side, u / 4 * 4 + side * (v / 4 * 4 + side * (w / 4 * 4)));
    const std::array<std::size_t, 3> first{u / 2 * 2 % 4, v / 2 * 2 % 4, w / 2 * 2 % 4};  // of the piece among 5³ nodes
    double bound = -HUGE_VAL;
    for (std::size_t n = 0; n < values.size(); ++n) {
        const std::array<std::size_t, 3> at{n % kPlaces, n / kPlaces % kPlaces, n / kPlaces / kPlaces};
        double value = values[n];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (at[axis] % 2 != 0) {
                const std::size_t other = (axis + 1) % 3, third = (axis + 2) % 3;
                double bend = 0;
                for (std::size_t j = at[third] / 2; j <= (at[third] + 1) / 2; ++j) {
                    for (std::size_t i = at[other] / 2; i <= (at[other] + 1) / 2; ++i) {
                        bend = std::max(bend, bends[axis][first[other] + i + 5 * (first[third] + j)]);
                    }
                }
                value += bend / 2;
            }
            const std::size_t step = kStrides[axis];
            if (at[axis] > 0 && at[axis] + 1 < kPlaces) value += vertex_excess(values[n - step], values[n], values[n + step]);
        }
        bound = std::max(bound, value);
    }
    return bound;
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

FinerBound finer_bound(std::span<const double> grid, std::size_t side, double known, double quantum) {
    FinerBound found;
    const auto [low, high] = std::ranges::minmax(grid);
    if (high + (high - low) < known) return found;
    for (std::size_t w = 1; w < side; w += 2) {
        for (std::size_t v = 1; v < side; v += 2) {
            for (std::size_t u = 1; u < side; u += 2) {
                const double bound = piece_bound(grid, side, u, v, w), value = grid[u + side * (v + side * w)];
                found.bound = std::max(found.bound, bound);
                found.alike += mixed(std::bit_cast<std::uint64_t>(std::round(value / quantum) + 0.0) ^
                                     mixed(std::bit_cast<std::uint64_t>(std::round(bound / quantum) + 0.0)));
            }
        }
    }
    return found;
}

OctantBounds octant_bounds(std::span<const double, 125> grid) {
    OctantBounds found{};
    for (std::size_t k = 0; k < 8; ++k) {
        found.bounds[k] = piece_bound(grid, kPlaces, 1 + 2 * (k & 1), 1 + 2 * (k >> 1 & 1), 1 + 2 * (k >> 2));
    }
    const LineBends bends = bends_of_lines(grid, kPlaces, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) found.bends[axis] = std::ranges::max(bends[axis]) / 2;
    return found;
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
