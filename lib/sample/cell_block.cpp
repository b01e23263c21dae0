// SPDX-License-Identifier: Apache-2.0
#include "cell_block.h"

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

/// The quartic Lagrange basis on the nodes 0, 1/4, 1/2, 3/4, 1. At a node the values are exactly one and zeros.
struct QuarticBasis {
    static constexpr std::size_t kNodes = 5;
    using Weights = std::array<double, kNodes>;
    Weights value{}, first{};

    explicit QuarticBasis(double t) {
        for (std::size_t i = 0; i < kNodes; ++i) {
            double p = 1, dp = 0;  // the product so far and its derivative
            for (std::size_t j = 0; j < kNodes; ++j) {
                if (j == i) continue;
                const double slope = 4.0 / (static_cast<double>(i) - static_cast<double>(j));
                const double factor = (t - static_cast<double>(j) / 4) * slope;
                dp = dp * factor + p * slope;
                p *= factor;
            }
            value[i] = p;
            first[i] = dp;
        }
    }
};

/// Weights along one axis of a cell: of the value, and per sample interval of the derivative and the second difference.
///
/// The second difference is that of the neighbouring samples, not the second derivative: a kernel reaches over them, and limit
/// curves need not have a second derivative. At a side of the cell, where one neighbour is missing, the derivative replaces it:
/// 2 (f(t+s) − f(t) − s f′(t)); the cell on the other side supplies the other half.
struct SampleStencil {
    QuarticBasis::Weights value{}, first{}, second{};

    SampleStencil(double t, double step) {
        const QuarticBasis here(t);
        value = here.value;
        for (std::size_t i = 0; i < value.size(); ++i) first[i] = step * here.first[i];
        constexpr double kSlack = 1e-9;  // t ± step of the outermost samples is rounded
        const bool below = t - step > -kSlack, above = t + step < 1 + kSlack;
        const QuarticBasis low(t - step), high(t + step);
        for (std::size_t i = 0; i < value.size(); ++i) {
            const double down = below ? low.value[i] - value[i] : high.value[i] - value[i] - 2 * first[i];
            const double up = above ? high.value[i] - value[i] : low.value[i] - value[i] + 2 * first[i];
            second[i] = down + up;
        }
    }
};

/// Where a node of the 5×5×5 block is in the twice refined mesh: at a corner of one of the 64 descendants of its cell.
struct NodePlace {
    std::uint8_t descendant, corner;
};

constexpr std::array<NodePlace, 125> make_node_places() {
    std::array<NodePlace, 125> places{};
    for (std::size_t child = 0; child < 8; ++child) {
        for (std::size_t grandchild = 0; grandchild < 8; ++grandchild) {
            for (std::size_t k = 0; k < 8; ++k) {
                std::size_t node = 0, stride = 1;
                for (std::size_t a = 0; a < 3; ++a, stride *= 5) {
                    node += stride * static_cast<std::size_t>(2 * kCornerParameters[child][a] +
                                                              kCornerParameters[grandchild][a] + kCornerParameters[k][a]);
                }
                places[node] = {static_cast<std::uint8_t>(8 * child + grandchild), static_cast<std::uint8_t>(k)};
            }
        }
    }
    return places;
}

constexpr auto kNodePlaces = make_node_places();

}  // namespace

CellBlocks::CellBlocks(const HexMesh& twice_refined) : mesh_(twice_refined) {
    for (std::size_t a = 0; a < mesh_.attributes.size(); ++a) {
        for (std::size_t c = 0; c < static_cast<std::size_t>(mesh_.attributes[a].channels); ++c) source_.emplace_back(a, c);
    }
    channels_ = source_.size();
}

Index CellBlocks::point(std::size_t cell, std::size_t node) const {
    const auto [descendant, corner] = kNodePlaces[node];
    return mesh_.cells[64 * cell + descendant][corner];
}

double CellBlocks::channel_value(Index point, std::size_t channel) const {
    const auto [attribute, c] = source_[channel];
    const auto& values = mesh_.attributes[attribute];
    return values.values[point * static_cast<std::size_t>(values.channels) + c];
}

void CellBlocks::evaluate(std::size_t cell, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
                          Jet& jet) const {
    const std::array<SampleStencil, 3> basis{SampleStencil(uvw[0], step[0]), SampleStencil(uvw[1], step[1]),
                                             SampleStencil(uvw[2], step[2])};
    jet.position = Vec3(0.0);
    jet.d_position = jet.dd_position = {Vec3(0.0), Vec3(0.0), Vec3(0.0)};
    jet.value.assign(channels_, 0);
    jet.d_value.assign(channels_, {0, 0, 0});
    jet.dd_value.assign(channels_, {0, 0, 0});

    constexpr std::array<std::size_t, 3> kStride{1, 5, 25};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (std::size_t j = 0; j < 5; ++j) {
            if (basis[b].value[j] == 0) continue;  // at corners, on edges and faces most weights vanish
            for (std::size_t k = 0; k < 5; ++k) {
                const double across = basis[b].value[j] * basis[c].value[k];
                if (across == 0) continue;
                for (std::size_t i = 0; i < 5; ++i) {
                    const Index p = point(cell, i * kStride[axis] + j * kStride[b] + k * kStride[c]);
                    const double w = across * basis[axis].value[i], d = across * basis[axis].first[i];
                    const double dd = across * basis[axis].second[i];
                    const Vec3& x = mesh_.points[p];
                    jet.d_position[axis] += d * x;
                    jet.dd_position[axis] += dd * x;
                    if (axis == 0) jet.position += w * x;
                    for (std::size_t ch = 0; ch < channels_; ++ch) {
                        const double f = channel_value(p, ch);
                        jet.d_value[ch][axis] += d * f;
                        jet.dd_value[ch][axis] += dd * f;
                        if (axis == 0) jet.value[ch] += w * f;
                    }
                }
            }
        }
    }
}

void CellBlocks::evaluate_mixed(std::size_t cell, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
                                Jet& jet) const {
    const std::array<SampleStencil, 3> basis{SampleStencil(uvw[0], step[0]), SampleStencil(uvw[1], step[1]),
                                             SampleStencil(uvw[2], step[2])};
    jet.mixed_position = {Vec3(0.0), Vec3(0.0), Vec3(0.0)};
    jet.mixed_value.assign(channels_, {0, 0, 0});
    constexpr std::array<std::size_t, 3> kStride{1, 5, 25};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (std::size_t i = 0; i < 5; ++i) {
            if (basis[axis].value[i] == 0) continue;
            for (std::size_t j = 0; j < 5; ++j) {
                for (std::size_t k = 0; k < 5; ++k) {
                    const double w = basis[axis].value[i] * basis[b].first[j] * basis[c].first[k];
                    const Index p = point(cell, i * kStride[axis] + j * kStride[b] + k * kStride[c]);
                    jet.mixed_position[axis] += w * mesh_.points[p];
                    for (std::size_t ch = 0; ch < channels_; ++ch) jet.mixed_value[ch][axis] += w * channel_value(p, ch);
                }
            }
        }
    }
}

}  // namespace subvol::detail
