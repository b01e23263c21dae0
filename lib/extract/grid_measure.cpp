// SPDX-License-Identifier: Apache-2.0
// Sums over a piece by tensor products. With the three nodes of a quadratic at 0, ½ and 1, and three Gauss points g along each
// axis, a value at the 27 Gauss points is
//
//     f(g_u, g_v, g_w) = Σ_k B[g_w][k] Σ_j B[g_v][j] Σ_i B[g_u][i] f_ijk
//
// one pass of 27 sums of three terms along each axis. Derivatives have the slopes D in place of B along their axis; the eight
// passes of a coordinate share what is equal. The volume element is the determinant of the three derivatives. The integral of f
// is Σ_g W_g f(g), W_g the weight of the Gauss point times the volume element. By the passes' transposes it is a sum over
// nodes:
//
//     Σ_ijk w_ijk f_ijk,   w_ijk = Σ_g W_g B[g_u][i] B[g_v][j] B[g_w][k]
//
// so the passes are made once for all channels.
#include "grid_measure.h"

#include <algorithm>
#include <cmath>

#include "piece_tree.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

using Piece = std::array<double, 27>;
using Matrix = std::array<std::array<double, 3>, 3>;  // of a pass: row g, the weights of the nodes

constexpr std::array<double, 3> kGaussPlaces{0.11270166537925831, 0.5, 0.88729833462074169};
constexpr std::array<double, 3> kGaussWeights{5.0 / 18, 8.0 / 18, 5.0 / 18};

struct Passes {
    Matrix values, slopes, transposed;
};

Passes make_passes() {
    Passes passes{};
    for (std::size_t g = 0; g < 3; ++g) {
        const QuadraticWeights at(kGaussPlaces[g]);
        passes.values[g] = at.values;
        passes.slopes[g] = at.slopes;
        for (std::size_t n = 0; n < 3; ++n) passes.transposed[n][g] = at.values[n];
    }
    return passes;
}

const Passes kPasses = make_passes();

/// A pass along the slowest axis, which becomes the fastest: three of them restore the order.
inline void pass(const Matrix& by, const Piece& from, Piece& to) {
    Piece rows;
    for (std::size_t g = 0; g < 3; ++g) {
        for (std::size_t r = 0; r < 9; ++r) {
            rows[9 * g + r] = by[g][0] * from[r] + by[g][1] * from[9 + r] + by[g][2] * from[18 + r];
        }
    }
    for (std::size_t r = 0; r < 9; ++r) {
        for (std::size_t g = 0; g < 3; ++g) to[3 * r + g] = rows[9 * g + r];
    }
}

/// The same pass along all three axes.
void pass_thrice(const Matrix& by, const Piece& from, Piece& to) {
    Piece one, two;
    pass(by, from, one);
    pass(by, one, two);
    pass(by, two, to);
}

/// The derivatives along u, v, w.
void slopes_at_gauss_points(const Piece& nodes, std::array<Piece, 3>& to) {
    Piece along_w, slope_w, two;
    pass(kPasses.values, nodes, along_w);
    pass(kPasses.slopes, nodes, slope_w);
    pass(kPasses.values, along_w, two);
    pass(kPasses.slopes, two, to[0]);
    pass(kPasses.slopes, along_w, two);
    pass(kPasses.values, two, to[1]);
    pass(kPasses.values, slope_w, two);
    pass(kPasses.values, two, to[2]);
}

/// The nodes of the trilinear piece with the same corners: means along u, then v, then w.
Piece trilinear(Piece nodes) {
    for (const std::size_t n : {1u, 7u, 19u, 25u}) nodes[n] = (nodes[n - 1] + nodes[n + 1]) / 2;
    for (std::size_t first = 3; first < 27; first += 9) {
        for (std::size_t n = first; n < first + 3; ++n) nodes[n] = (nodes[n - 3] + nodes[n + 3]) / 2;
    }
    for (std::size_t n = 9; n < 18; ++n) nodes[n] = (nodes[n - 9] + nodes[n + 9]) / 2;
    return nodes;
}

/// What the weights of the nodes of a trilinear piece are for its corners: the transpose of `trilinear`.
void move_to_corners(Piece& weights) {
    const auto halve = [&](std::size_t n, std::size_t step) {
        weights[n - step] += weights[n] / 2;
        weights[n + step] += weights[n] / 2;
        weights[n] = 0;
    };
    for (std::size_t n = 9; n < 18; ++n) halve(n, 9);
    for (std::size_t first = 3; first < 27; first += 9) {
        for (std::size_t n = first; n < first + 3; ++n) halve(n, 3);
    }
    for (const std::size_t n : {1u, 7u, 19u, 25u}) halve(n, 1);
}

/// How far a node lies from the trilinear piece.
double largest_step(const Piece& nodes) {
    const Piece flat = trilinear(nodes);
    double largest = 0;
    for (std::size_t n = 0; n < 27; ++n) largest = std::max(largest, std::abs(nodes[n] - flat[n]));
    return largest;
}

}  // namespace

GridMeasure::GridMeasure(std::vector<double> origins) : origins_(std::move(origins)), at_gauss_(origins_.size()) {
}

/// Positions are relative to the first node, so that sums keep their digits.
void GridMeasure::load(const DenseCell& grid, const Nodes& nodes) {
    const Vec3 origin = grid.points[nodes[0]];
    for (std::size_t n = 0; n < kNodes; ++n) {
        const Vec3 p = grid.points[nodes[n]] - origin;
        for (std::size_t d = 0; d < 3; ++d) positions_[d][n] = p[static_cast<int>(d)];
    }
}

void GridMeasure::weigh() {
    std::array<std::array<Piece, 3>, 3> slopes;
    for (std::size_t d = 0; d < 3; ++d) slopes_at_gauss_points(positions_[d], slopes[d]);
    const auto& [x, y, z] = slopes;
    for (std::size_t g = 0; g < kNodes; ++g) {
        const double determinant = x[0][g] * (y[1][g] * z[2][g] - y[2][g] * z[1][g]) -
                                   x[1][g] * (y[0][g] * z[2][g] - y[2][g] * z[0][g]) +
                                   x[2][g] * (y[0][g] * z[1][g] - y[1][g] * z[0][g]);
        weights_[g] = kGaussWeights[g % 3] * kGaussWeights[g / 3 % 3] * kGaussWeights[g / 9] * determinant;
    }
    if (!origins_.empty()) pass_thrice(kPasses.transposed, weights_, node_weights_);
}

/// Values are relative to their origins, so that sums keep their digits.
void GridMeasure::add(const DenseCell& grid, const Nodes& nodes, std::span<double> sums) const {
    double volume = 0;
    for (const double weight : weights_) volume += weight;
    sums[0] += volume;
    std::size_t c = 0;
    for (const auto& values : grid.values) {
        const std::size_t count = values.size() / grid.points.size();
        for (std::size_t k = 0; k < count; ++k, ++c) {
            double sum = 0;
            for (std::size_t n = 0; n < kNodes; ++n) {
                if (node_weights_[n] != 0) sum += node_weights_[n] * (values[nodes[n] * count + k] - origins_[c]);
            }
            sums[1 + c] += sum;
        }
    }
}

void GridMeasure::find_values(const DenseCell& grid, const Nodes& nodes) {
    Piece at_nodes;
    std::size_t c = 0;
    for (const auto& values : grid.values) {
        const std::size_t count = values.size() / grid.points.size();
        for (std::size_t k = 0; k < count; ++k, ++c) {
            for (std::size_t n = 0; n < kNodes; ++n) at_nodes[n] = values[nodes[n] * count + k] - origins_[c];
            pass_thrice(kPasses.values, at_nodes, at_gauss_[c]);
        }
    }
}

void GridMeasure::add_sums(const DenseCell& grid, std::size_t step, std::span<double> sums) {
    each_piece(grid, step, [&](const Nodes& nodes) {
        load(grid, nodes);
        weigh();
        add(grid, nodes, sums);
    });
}

void GridMeasure::add_trilinear_sums(const DenseCell& grid, std::span<double> sums) {
    const Nodes nodes(grid.side, 0, (grid.side - 1) / 2);
    load(grid, nodes);
    for (Piece& axis : positions_) axis = trilinear(axis);
    weigh();
    move_to_corners(node_weights_);
    add(grid, nodes, sums);
}

namespace {

/// The nodes of a side: first + i·along + j·across, so that along × across points outwards; turned: it points inwards.
struct SideNodes {
    std::size_t first = 0, along, across;
    bool turned;

    SideNodes(std::size_t grid_side, std::size_t side) : turned(side % 2 == 0) {
        const std::array<std::size_t, 3> strides{1, grid_side, grid_side * grid_side};
        const std::size_t axis = side / 2;
        if (side % 2 != 0) first = (grid_side - 1) * strides[axis];
        along = strides[(axis + 1) % 3];
        across = strides[(axis + 2) % 3];
    }
};

/// The volume of the cone from the origin to a piece of nine nodes: a third of the integral of x · n. Two passes, as above.
double cone(const std::array<Vec3, 9>& nodes) {
    std::array<Vec3, 9> values, slopes;  // at the Gauss points along the first axis, at the nodes along the second
    const auto sum = [](const std::array<double, 3>& by, const Vec3& a, const Vec3& b, const Vec3& c) {
        return by[0] * a + by[1] * b + by[2] * c;
    };
    for (std::size_t row = 0; row < 9; row += 3) {
        for (std::size_t g = 0; g < 3; ++g) {
            values[row + g] = sum(kPasses.values[g], nodes[row], nodes[row + 1], nodes[row + 2]);
            slopes[row + g] = sum(kPasses.slopes[g], nodes[row], nodes[row + 1], nodes[row + 2]);
        }
    }
    double volume = 0;
    for (std::size_t g = 0; g < 9; ++g) {
        const std::size_t i = g % 3, j = g / 3;
        const Vec3 x = sum(kPasses.values[j], values[i], values[3 + i], values[6 + i]),
                   across = sum(kPasses.slopes[j], values[i], values[3 + i], values[6 + i]),
                   along = sum(kPasses.values[j], slopes[i], slopes[3 + i], slopes[6 + i]);
        volume += kGaussWeights[i] * kGaussWeights[j] / 3 * glm::dot(x, glm::cross(along, across));
    }
    return volume;
}

}  // namespace

double GridMeasure::swept(const DenseCell& grid, std::size_t side) {
    const SideNodes nodes(grid.side, side);
    const std::size_t last = grid.side - 1;
    const auto point = [&](std::size_t i, std::size_t j) {
        return grid.points[nodes.first + i * nodes.along + j * nodes.across];
    };
    const Vec3 middle = 0.25 * (point(0, 0) + point(last, 0) + point(0, last) + point(last, last));
    const auto cones = [&](std::size_t step) {
        double sum = 0;
        std::array<Vec3, 9> piece;
        for (std::size_t j = 0; j < last; j += 2 * step) {
            for (std::size_t i = 0; i < last; i += 2 * step) {
                for (std::size_t n = 0; n < 9; ++n) piece[n] = point(i + n % 3 * step, j + n / 3 * step) - middle;
                sum += cone(piece);
            }
        }
        return sum;
    };
    const auto bilinear = [&] {
        std::array<Vec3, 9> piece;
        for (const std::size_t n : {0u, 2u, 6u, 8u}) piece[n] = point(n % 3 * last / 2, n / 3 * last / 2) - middle;
        for (const std::size_t n : {1u, 7u}) piece[n] = 0.5 * (piece[n - 1] + piece[n + 1]);
        for (const std::size_t n : {3u, 4u, 5u}) piece[n] = 0.5 * (piece[n - 3] + piece[n + 3]);
        return cone(piece);
    };
    const double volume = cones(1) - (last > 2 ? cones(2) : bilinear());
    return nodes.turned ? -volume : volume;
}

void GridMeasure::mean_on_side(const DenseCell& grid, std::size_t side, std::span<double> means) const {
    constexpr std::array<double, 3> kSimpson{1.0 / 6, 4.0 / 6, 1.0 / 6};
    const SideNodes nodes(grid.side, side);
    const std::size_t half = (grid.side - 1) / 2;
    std::ranges::fill(means, 0);
    for (std::size_t n = 0; n < 9; ++n) {
        const std::size_t node = nodes.first + half * (n % 3 * nodes.along + n / 3 * nodes.across);
        std::size_t c = 0;
        for (const auto& values : grid.values) {
            const std::size_t count = values.size() / grid.points.size();
            for (std::size_t k = 0; k < count; ++k, ++c) {
                means[c] += kSimpson[n % 3] * kSimpson[n / 3] * (values[node * count + k] - origins_[c]);
            }
        }
    }
}

void GridMeasure::read_channel(const DenseCell& grid, std::size_t channel) {
    channel_.resize(grid.points.size());
    for (const auto& values : grid.values) {
        const std::size_t count = values.size() / grid.points.size();
        if (channel < count) {
            for (std::size_t n = 0; n < channel_.size(); ++n) channel_[n] = values[n * count + channel];
            return;
        }
        channel -= count;
    }
}

/// Half of how far a node of the piece lies from the trilinear one between its corners is what the limit goes beyond the nodes
/// at most: where it is smooth it is a quarter, and twice that is for its kinks.
double GridMeasure::first_bound(double known) const {
    constexpr double kReach = 0.5;
    const auto [low, high] = std::ranges::minmax(channel_);
    if (high + kReach * (high - low) < known) return -HUGE_VAL;  // no node is farther from the corners than the two
    Piece nodes;
    std::ranges::copy(channel_, nodes.begin());
    return high + kReach * largest_step(nodes);
}

/// By how much nodes of the finest level differ from the parabolas through those of the level before, in the piece of that
/// level that begins at `first`: the largest difference along each axis, summed.
double GridMeasure::bend_of_lines(std::size_t first, std::size_t side) const {
    const std::array<std::size_t, 3> strides{1, side, side * side};
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t step = strides[axis], other = strides[(axis + 1) % 3], third = strides[(axis + 2) % 3];
        double largest = 0;
        for (std::size_t line = 0; line < 25; ++line) {
            const double* f = &channel_[first + line % 5 * other + line / 5 * third];
            const double middle = 6 * f[2 * step], ends[2] = {f[0], f[4 * step]};
            largest = std::max({largest, std::abs((3 * ends[0] + middle - ends[1]) / 8 - f[step]),
                                std::abs((3 * ends[1] + middle - ends[0]) / 8 - f[3 * step])});
        }
        sum += largest;
    }
    return sum;
}

namespace {

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

}  // namespace

/// From level 2 on a piece has a quadratic, whose largest value is known. What it lacks is told by its 27 nodes, and by how the
/// finest level differs from the one before.
double GridMeasure::finer_bound(std::size_t side, double known) const {
    const auto [low, high] = std::ranges::minmax(channel_);
    if (high + (high - low) < known) return -HUGE_VAL;
    double bound = -HUGE_VAL;
    for (std::size_t w = 1; w < side; w += 2) {
        for (std::size_t v = 1; v < side; v += 2) {
            for (std::size_t u = 1; u < side; u += 2) {
                const double* middle = &channel_[u + side * (v + side * w)];
                const NodeQuadratic quadratic(middle, side);
                const double bend = bend_of_lines(u / 4 * 4 + side * (v / 4 * 4 + side * (w / 4 * 4)), side) / 2;
                double highest = -HUGE_VAL, off = 0;
                Vec3 best(0.0);
                for (std::size_t n = 0; n < kNodes; ++n) {
                    const Vec3 at = Vec3(n % 3, n / 3 % 3, n / 9) - Vec3(1.0);
                    const double value = *(middle + (static_cast<std::ptrdiff_t>(n % 3) - 1) +
                                           (static_cast<std::ptrdiff_t>(n / 3 % 3) - 1) * static_cast<std::ptrdiff_t>(side) +
                                           (static_cast<std::ptrdiff_t>(n / 9) - 1) * static_cast<std::ptrdiff_t>(side * side));
                    if (value > highest) best = at;
                    highest = std::max(highest, value);
                    off = std::max(off, std::abs(quadratic.at(at) - value));
                }
                bound = std::max(bound, std::max(highest, quadratic.at(quadratic.peak(best))) + bend + off / 2);
            }
        }
    }
    return bound;
}

/// Where the quadratic through the 27 nodes around a node, or beside it at the cell's sides, has its largest value.
Vec3 GridMeasure::peak(std::size_t node, std::size_t side) const {
    const std::array<std::size_t, 3> at{node % side, node / side % side, node / side / side};
    std::array<std::size_t, 3> middle;
    Vec3 place(0.0);
    for (std::size_t d = 0; d < 3; ++d) {
        middle[d] = std::clamp<std::size_t>(at[d], 1, side - 2);
        place[static_cast<int>(d)] = static_cast<double>(at[d]) - static_cast<double>(middle[d]);
    }
    const NodeQuadratic quadratic(&channel_[middle[0] + side * (middle[1] + side * middle[2])], side);
    return (Vec3(middle[0], middle[1], middle[2]) + quadratic.peak(place)) / static_cast<double>(side - 1);
}

void GridMeasure::add_extremes(const DenseCell& grid, std::size_t channel, const std::array<double, 2>& known,
                               std::vector<Extreme>& extremes) {
    const std::size_t side = grid.side;
    read_channel(grid, channel);
    for (const std::size_t s : {0u, 1u}) {
        for (double& value : channel_) value = -value;  // times -1, then times 1 again
        const double bound = side > 3 ? finer_bound(side, known[s]) : first_bound(known[s]);
        if (bound < known[s]) continue;
        const auto node = static_cast<std::size_t>(std::ranges::max_element(channel_) - channel_.begin());
        Extreme found{channel, s == 0 ? -1.0 : 1.0, channel_[node], bound};
        found.uvw = Vec3(node % side, node / side % side, node / side / side) / static_cast<double>(side - 1);
        found.peak = side > 3 ? peak(node, side) : found.uvw;
        extremes.push_back(found);
    }
}

}  // namespace subvol::detail
