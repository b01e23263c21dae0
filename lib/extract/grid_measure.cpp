// SPDX-License-Identifier: Apache-2.0
// Sums over a piece by tensor products. With the three nodes of a quadratic at 0, ½ and 1, and three Gauss points g along each
// axis, a value at the 27 Gauss points is
//
//     f(g_u, g_v, g_w) = Σ_k B[g_w][k] Σ_j B[g_v][j] Σ_i B[g_u][i] f_ijk
//
// one pass of 27 sums of three terms along each axis. Derivatives have the slopes D in place of B along their axis; the eight
// passes of a coordinate share what is equal. The volume element is the determinant of the three derivatives.
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
    Matrix values, slopes;
};

Passes make_passes() {
    Passes passes{};
    for (std::size_t g = 0; g < 3; ++g) {
        const QuadraticWeights at(kGaussPlaces[g]);
        passes.values[g] = at.values;
        passes.slopes[g] = at.slopes;
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

void at_gauss_points(const Piece& nodes, Piece& to) {
    Piece one, two;
    pass(kPasses.values, nodes, one);
    pass(kPasses.values, one, two);
    pass(kPasses.values, two, to);
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

/// How far a node lies from the trilinear piece.
double largest_step(const Piece& nodes) {
    const Piece flat = trilinear(nodes);
    double largest = 0;
    for (std::size_t n = 0; n < 27; ++n) largest = std::max(largest, std::abs(nodes[n] - flat[n]));
    return largest;
}

}  // namespace

GridMeasure::GridMeasure(std::vector<double> origins)
    : origins_(std::move(origins)), values_(origins_.size()), at_gauss_(origins_.size()) {
}

/// Positions are relative to the first node, and values to their origins, so that sums keep their digits.
void GridMeasure::load(const DenseCell& grid, std::size_t first, std::size_t step) {
    const Vec3 origin = grid.points[first];
    for (std::size_t n = 0; n < kNodes; ++n) {
        const std::size_t node = first + step * (n % 3 + grid.side * (n / 3 % 3 + grid.side * (n / 9)));
        const Vec3 p = grid.points[node] - origin;
        for (std::size_t d = 0; d < 3; ++d) positions_[d][n] = p[static_cast<int>(d)];
        std::size_t c = 0;
        for (const auto& values : grid.values) {
            const std::size_t count = values.size() / grid.points.size();
            for (std::size_t k = 0; k < count; ++k, ++c) values_[c][n] = values[node * count + k] - origins_[c];
        }
    }
}

void GridMeasure::evaluate() {
    std::array<std::array<Piece, 3>, 3> slopes;
    for (std::size_t d = 0; d < 3; ++d) slopes_at_gauss_points(positions_[d], slopes[d]);
    const auto& [x, y, z] = slopes;
    for (std::size_t g = 0; g < kNodes; ++g) {
        const double determinant = x[0][g] * (y[1][g] * z[2][g] - y[2][g] * z[1][g]) -
                                   x[1][g] * (y[0][g] * z[2][g] - y[2][g] * z[0][g]) +
                                   x[2][g] * (y[0][g] * z[1][g] - y[1][g] * z[0][g]);
        weights_[g] = kGaussWeights[g % 3] * kGaussWeights[g / 3 % 3] * kGaussWeights[g / 9] * determinant;
    }
    for (std::size_t c = 0; c < values_.size(); ++c) at_gauss_points(values_[c], at_gauss_[c]);
}

void GridMeasure::add(std::span<double> sums) const {
    double volume = 0;
    for (const double weight : weights_) volume += weight;
    sums[0] += volume;
    for (std::size_t c = 0; c < at_gauss_.size(); ++c) {
        double sum = 0;
        for (std::size_t g = 0; g < kNodes; ++g) sum += weights_[g] * at_gauss_[c][g];
        sums[1 + c] += sum;
    }
}

void GridMeasure::add_sums(const DenseCell& grid, std::size_t step, std::span<double> sums) {
    each_piece(grid, step, [&] { add(sums); });
}

void GridMeasure::add_trilinear_sums(const DenseCell& grid, std::span<double> sums) {
    load(grid, 0, (grid.side - 1) / 2);
    for (Piece& nodes : positions_) nodes = trilinear(nodes);
    for (Piece& nodes : values_) nodes = trilinear(nodes);
    evaluate();
    add(sums);
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

struct SidePoint {
    std::array<double, 9> values, along, across;
    double weight;
};

std::array<SidePoint, 9> make_side_points() {
    std::array<SidePoint, 9> points{};
    for (std::size_t g = 0; g < 9; ++g) {
        const QuadraticWeights u(kGaussPlaces[g % 3]), v(kGaussPlaces[g / 3]);
        for (std::size_t n = 0; n < 9; ++n) {
            points[g].values[n] = u.values[n % 3] * v.values[n / 3];
            points[g].along[n] = u.slopes[n % 3] * v.values[n / 3];
            points[g].across[n] = u.values[n % 3] * v.slopes[n / 3];
        }
        points[g].weight = kGaussWeights[g % 3] * kGaussWeights[g / 3] / 3;
    }
    return points;
}

const std::array<SidePoint, 9> kSidePoints = make_side_points();

/// The volume of the cone from the origin to a piece of nine nodes: a third of the integral of x · n.
double cone(const std::array<Vec3, 9>& nodes) {
    double volume = 0;
    for (const SidePoint& at : kSidePoints) {
        Vec3 x(0.0), along(0.0), across(0.0);
        for (std::size_t n = 0; n < 9; ++n) {
            x += at.values[n] * nodes[n];
            along += at.along[n] * nodes[n];
            across += at.across[n] * nodes[n];
        }
        volume += at.weight * glm::dot(x, glm::cross(along, across));
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

/// Each piece of 27 nodes has its largest step: how far a node lies from the trilinear piece between the eight corners. Where
/// the limit is smooth, it goes a quarter of the step beyond the nodes. Twice that is for its kinks.
void GridMeasure::find_bounds(std::size_t side, Extremes& result) const {
    constexpr double kReach = 0.5;
    result.low_bound = HUGE_VAL;
    result.high_bound = -HUGE_VAL;
    Piece nodes;
    for (std::size_t first = 0, w = 0; w + 1 < side; w += 2) {
        for (std::size_t v = 0; v + 1 < side; v += 2) {
            for (std::size_t u = 0; u + 1 < side; u += 2) {
                first = u + side * (v + side * w);
                for (std::size_t n = 0; n < kNodes; ++n) {
                    nodes[n] = channel_[first + n % 3 + side * (n / 3 % 3 + side * (n / 9))];
                }
                const auto [low, high] = std::ranges::minmax(nodes);
                const double reach = kReach * largest_step(nodes);
                result.low_bound = std::min(result.low_bound, low - reach);
                result.high_bound = std::max(result.high_bound, high + reach);
            }
        }
    }
}

/// The extreme of the quadratic through the 27 nodes around a node, or beside it at the cell's sides: its values, slopes and
/// second derivatives by central differences in steps of the grid, then the best place along one axis after the other.
Vec3 GridMeasure::peak(std::size_t node, std::size_t side, double sign) const {
    const std::array<std::size_t, 3> at{node % side, node / side % side, node / side / side}, strides{1, side, side * side};
    std::array<std::size_t, 3> middle;
    for (std::size_t d = 0; d < 3; ++d) middle[d] = std::clamp<std::size_t>(at[d], 1, side - 2);
    const double* f = &channel_[middle[0] + side * (middle[1] + side * middle[2])];
    const auto value = [&](std::ptrdiff_t offset) { return sign * f[offset]; };
    Vec3 slope(0.0), place(0.0);
    Mat3 bend(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<std::ptrdiff_t>(strides[a]);
        const int d = static_cast<int>(a);
        place[d] = static_cast<double>(at[a]) - static_cast<double>(middle[a]);
        slope[d] = (value(i) - value(-i)) / 2;
        bend[d][d] = value(i) - 2 * value(0) + value(-i);
        for (std::size_t b = 0; b < a; ++b) {
            const auto j = static_cast<std::ptrdiff_t>(strides[b]);
            const int e = static_cast<int>(b);
            bend[d][e] = bend[e][d] = (value(i + j) - value(i - j) - value(j - i) + value(-i - j)) / 4;
        }
    }
    constexpr int kRounds = 24;
    for (int round = 0; round < kRounds; ++round) {
        for (int d = 0; d < 3; ++d) {
            const double here = slope[d] + bend[0][d] * place.x + bend[1][d] * place.y + bend[2][d] * place.z;
            if (bend[d][d] < 0) {
                place[d] = std::clamp(place[d] - here / bend[d][d], -1.0, 1.0);
            } else if (here != 0) {
                place[d] = here > 0 ? 1 : -1;
            }
        }
    }
    const Vec3 from(middle[0], middle[1], middle[2]);
    return (from + place) / static_cast<double>(side - 1);
}

GridMeasure::Extremes GridMeasure::extremes(const DenseCell& grid, std::size_t channel) {
    read_channel(grid, channel);
    const auto [low, high] = std::ranges::minmax_element(channel_);
    const std::size_t side = grid.side;
    const auto place = [&](auto found) -> Place {
        const auto n = static_cast<std::size_t>(found - channel_.begin());
        return {*found, Vec3(n % side, n / side % side, n / side / side) / static_cast<double>(side - 1)};
    };
    Extremes result{.low = place(low), .high = place(high)};
    find_bounds(side, result);
    result.low_peak = result.low.uvw;
    result.high_peak = result.high.uvw;
    if (side > 3) {
        result.low_peak = peak(static_cast<std::size_t>(low - channel_.begin()), side, -1);
        result.high_peak = peak(static_cast<std::size_t>(high - channel_.begin()), side, 1);
    }
    return result;
}

}  // namespace subvol::detail
