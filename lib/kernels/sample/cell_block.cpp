// SPDX-License-Identifier: Apache-2.0
#include "cell_block.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "subvol/dense_cells.h"

namespace subvol::detail {

namespace {

/// 4 / (i − j): the slopes of the factors of the basis.
constexpr auto kSlopes = [] {
    std::array<std::array<double, 5>, 5> slopes{};
    for (std::size_t i = 0; i < 5; ++i) {
        for (std::size_t j = 0; j < 5; ++j) {
            if (i != j) slopes[i][j] = 4.0 / (static_cast<double>(i) - static_cast<double>(j));
        }
    }
    return slopes;
}();

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
                const double slope = kSlopes[i][j];
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
        const QuarticBasis basis(t);
        value = basis.value;
        for (std::size_t i = 0; i < value.size(); ++i) first[i] = step * basis.first[i];
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

}  // namespace

CellBlocks::CellBlocks(const HexMesh& control, const SchemeOptions& scheme, Progress* progress) {
    for (const Attribute& attribute : control.attributes) channels_ += static_cast<std::size_t>(attribute.channels);
    row_ = (3 + channels_ + 3) / 4 * 4;
    rows_.resize(control.cells.size() * kNodes * row_);
    std::vector<Index> cells(control.cells.size());
    std::iota(cells.begin(), cells.end(), Index{0});
    const DenseCells limit(control, {.scheme = scheme, .levels = 2, .progress = progress}, true, DenseBits::ToRounding);
    limit.for_each(cells, [&](const DenseCell& cell) {
        double* row = &rows_[cell.cell * kNodes * row_];
        for (std::size_t n = 0; n < kNodes; ++n, row += row_) {
            double* next = std::copy_n(&cell.points[n].x, 3, row);
            for (const std::span<const double> values : cell.values) {
                const std::size_t channels = values.size() / kNodes;
                next = std::copy_n(&values[n * channels], channels, next);
            }
        }
    });
}

void CellBlocks::evaluate(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
                          Jet& jet) const {
    const std::array<SampleStencil, 3> basis{SampleStencil(uvw[0], step[0]), SampleStencil(uvw[1], step[1]),
                                             SampleStencil(uvw[2], step[2])};
    jet.value.resize(channels_);
    jet.d_value.resize(channels_);
    jet.dd_value.resize(channels_);
    constexpr std::array<std::size_t, 3> kStride{1, 5, 25};
    for (std::size_t block = 0; block < row_; block += 4) {
        std::array<double, 4> value{};
        std::array<std::array<double, 4>, 3> first{}, second{};  // by axes
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
            std::array<double, 4> d{}, dd{};
            for (std::size_t j = 0; j < 5; ++j) {
                if (basis[b].value[j] == 0) continue;  // at corners, on edges and faces most weights vanish
                for (std::size_t k = 0; k < 5; ++k) {
                    const double across = basis[b].value[j] * basis[c].value[k];
                    if (across == 0) continue;
                    const double* line = nodes + (j * kStride[b] + k * kStride[c]) * row_ + block;
                    for (std::size_t i = 0; i < 5; ++i) {
                        const double* x = line + i * kStride[axis] * row_;
                        const double weight = across * basis[axis].first[i], bend = across * basis[axis].second[i];
                        for (std::size_t n = 0; n < 4; ++n) d[n] += weight * x[n];
                        for (std::size_t n = 0; n < 4; ++n) dd[n] += bend * x[n];
                        if (axis != 0) continue;
                        const double here = across * basis[axis].value[i];
                        for (std::size_t n = 0; n < 4; ++n) value[n] += here * x[n];
                    }
                }
            }
            first[axis] = d;
            second[axis] = dd;
        }
        for (std::size_t n = block; n < block + 4 && n < 3 + channels_; ++n) {
            if (n < 3) {
                const int i = static_cast<int>(n);
                jet.position[i] = value[n];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    jet.d_position[axis][i] = first[axis][n];
                    jet.dd_position[axis][i] = second[axis][n];
                }
            } else {
                jet.value[n - 3] = value[n - block];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    jet.d_value[n - 3][axis] = first[axis][n - block];
                    jet.dd_value[n - 3][axis] = second[axis][n - block];
                }
            }
        }
    }
}

void CellBlocks::evaluate_mixed(const double* nodes, const std::array<double, 3>& uvw, const std::array<double, 3>& step,
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
                    const double* x = nodes + (i * kStride[axis] + j * kStride[b] + k * kStride[c]) * row_;
                    jet.mixed_position[axis] += w * Vec3(x[0], x[1], x[2]);
                    for (std::size_t ch = 0; ch < channels_; ++ch) jet.mixed_value[ch][axis] += w * x[3 + ch];
                }
            }
        }
    }
}

}  // namespace subvol::detail
