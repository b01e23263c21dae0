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
#include <limits>

#include "extreme_bounds.h"
#include "subvol/cell.h"
#include "subvol/detail/piece_tree.h"

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

}  // namespace

/// Means along u, then v, then w.
std::array<double, 27> trilinear(std::array<double, 27> nodes) {
    for (const std::size_t n : {1u, 7u, 19u, 25u}) nodes[n] = (nodes[n - 1] + nodes[n + 1]) / 2;
    for (std::size_t first = 3; first < 27; first += 9) {
        for (std::size_t n = first; n < first + 3; ++n) nodes[n] = (nodes[n - 3] + nodes[n + 3]) / 2;
    }
    for (std::size_t n = 9; n < 18; ++n) nodes[n] = (nodes[n - 9] + nodes[n + 9]) / 2;
    return nodes;
}

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
    double least = least_;
    std::array<std::array<Piece, 3>, 3> slopes;
    for (std::size_t d = 0; d < 3; ++d) slopes_at_gauss_points(positions_[d], slopes[d]);
    const auto& [x, y, z] = slopes;
    for (std::size_t g = 0; g < kNodes; ++g) {
        const double determinant = x[0][g] * (y[1][g] * z[2][g] - y[2][g] * z[1][g]) -
                                   x[1][g] * (y[0][g] * z[2][g] - y[2][g] * z[0][g]) +
                                   x[2][g] * (y[0][g] * z[1][g] - y[1][g] * z[0][g]);
        weights_[g] = kGaussWeights[g % 3] * kGaussWeights[g / 3 % 3] * kGaussWeights[g / 9] * determinant;
        least = std::min(least, determinant);
    }
    least_ = least;
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
    least_ = std::numeric_limits<double>::infinity();
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

void GridMeasure::add_extremes(const DenseCell& grid, std::size_t channel, const std::array<double, 2>& known, double quantum,
                               std::vector<Extreme>& extremes) {
    const std::size_t side = grid.side;
    read_channel(grid, channel);
    for (const std::size_t s : {0u, 1u}) {
        for (double& value : channel_) value = -value;  // times -1, then times 1 again
        const auto [bound, alike] =
            side > 3 ? finer_bound(channel_, side, known[s], quantum) : FinerBound{first_bound(channel_, known[s]), 0};
        if (bound < known[s]) continue;
        const auto node = static_cast<std::size_t>(std::ranges::max_element(channel_) - channel_.begin());
        Extreme found{channel, s == 0 ? -1.0 : 1.0, channel_[node], bound};
        found.uvw = Vec3(node % side, node / side % side, node / side / side) / static_cast<double>(side - 1);
        found.peak = side > 3 ? peak_near(channel_, side, node) : found.uvw;
        found.alike = alike;
        extremes.push_back(found);
    }
}

}  // namespace subvol::detail
