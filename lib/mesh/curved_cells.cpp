// SPDX-License-Identifier: Apache-2.0
#include "curved_cells.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

namespace {

// The weights of the nodes 0 … degree at t, from 0 to 1.
void add_basis(std::vector<double>& table, bool bezier, std::size_t degree, double t) {
    const auto p = static_cast<double>(degree);
    double binomial = 1;
    for (std::size_t i = 0; i <= degree; ++i) {
        const auto node = static_cast<double>(i);
        double weight = 1;
        if (bezier) {
            weight = binomial * std::pow(t, node) * std::pow(1 - t, p - node);
            binomial *= (p - node) / (node + 1);
        } else {
            for (std::size_t j = 0; j <= degree; ++j) {
                if (j != i) weight *= (t * p - static_cast<double>(j)) / (node - static_cast<double>(j));
            }
        }
        table.push_back(weight);
    }
}

// Replaces the nodes along an axis by the points 0 … pieces. size: of the grid of values, is changed too
std::vector<double> along(std::size_t axis, std::size_t pieces, bool bezier, const std::vector<double>& values,
                          std::array<std::size_t, 3>& size, std::size_t channels) {
    const std::size_t nodes = size[axis];
    std::vector<double> table;
    for (std::size_t i = 0; i <= pieces; ++i) {
        add_basis(table, bezier, nodes - 1, static_cast<double>(i) / static_cast<double>(pieces));
    }
    std::size_t inner = channels, outer = 1;
    for (std::size_t a = 0; a < axis; ++a) inner *= size[a];
    for (std::size_t a = axis + 1; a < 3; ++a) outer *= size[a];
    std::vector<double> result(inner * (pieces + 1) * outer);
    for (std::size_t o = 0; o < outer; ++o) {
        for (std::size_t i = 0; i <= pieces; ++i) {
            double* to = &result[(o * (pieces + 1) + i) * inner];
            for (std::size_t n = 0; n < nodes; ++n) {
                const double weight = table[i * nodes + n];
                if (weight == 0) continue;
                const double* from = &values[(o * nodes + n) * inner];
                for (std::size_t k = 0; k < inner; ++k) to[k] += weight * from[k];
            }
        }
    }
    size[axis] = pieces + 1;
    return result;
}

}  // namespace

CurvedCell::CurvedCell(const CurvedLayout& layout, std::span<const double> values, std::size_t channels, bool rational)
    : layout_(&layout), channels_(channels), rational_(rational), values_(layout.size() * channels) {
    for (std::size_t n = 0; n < layout.slots.size(); ++n) {
        const double weight = rational ? values[n * channels + channels - 1] : 1;
        for (std::size_t k = 0; k < channels; ++k) {
            const bool is_weight = rational && k + 1 == channels;
            values_[layout.slots[n] * channels + k] = values[n * channels + k] * (is_weight ? 1 : weight);
        }
    }
    if (!layout.completed) return;
    // The faces without a node in the middle have the serendipity element's shape; the middle of the cell follows from the
    // faces in a way that is the serendipity element's for 20 nodes, and that of VTK's cell for 24.
    const auto slot = [](std::size_t i, std::size_t j, std::size_t k) { return i + 3 * (j + 3 * k); };
    std::array<bool, 27> has{};
    for (const std::size_t s : layout.slots) has[s] = true;
    const auto add = [&](std::size_t to, std::size_t from, double weight) {
        for (std::size_t c = 0; c < channels; ++c) values_[to * channels + c] += weight * values_[from * channels + c];
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const std::size_t side : {0u, 2u}) {
            std::array<std::size_t, 3> middle{1, 1, 1};
            middle[axis] = side;
            const std::size_t to = slot(middle[0], middle[1], middle[2]);
            if (has[to]) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                for (std::size_t b = 0; b < 3; ++b) {
                    std::array<std::size_t, 3> at = middle;
                    at[(axis + 1) % 3] = a;
                    at[(axis + 2) % 3] = b;
                    const bool corner = a != 1 && b != 1;
                    if (a != 1 || b != 1) add(to, slot(at[0], at[1], at[2]), corner ? -.25 : .5);
                }
            }
        }
    }
    for (std::size_t s = 0; s < 27; ++s) {
        const std::array<std::size_t, 3> at{s % 3, s / 3 % 3, s / 9};
        const auto middles = std::count(at.begin(), at.end(), 1u);
        if (middles < 3) add(slot(1, 1, 1), s, middles == 2 ? .5 : middles == 1 ? -.25 : .125);
    }
}

std::vector<double> CurvedCell::at_grid(const std::array<std::size_t, 3>& pieces) const {
    std::array<std::size_t, 3> size{layout_->degrees[0] + 1, layout_->degrees[1] + 1, layout_->degrees[2] + 1};
    std::vector<double> values = along(0, pieces[0], layout_->bezier, values_, size, channels_);
    values = along(1, pieces[1], layout_->bezier, values, size, channels_);
    values = along(2, pieces[2], layout_->bezier, values, size, channels_);
    if (!rational_) return values;
    std::vector<double> divided;
    divided.reserve(values.size() / channels_ * shown());
    for (std::size_t i = 0; i < values.size(); i += channels_) {
        for (std::size_t k = 0; k < shown(); ++k) divided.push_back(values[i + k] / values[i + shown()]);
    }
    return divided;
}

std::array<std::size_t, 3> CurvedCell::sample_pieces(std::size_t axis) const {
    std::array<std::size_t, 3> pieces;
    for (std::size_t a = 0; a < 3; ++a) pieces[a] = (a == axis ? 4 : rational_ ? 2 : 1) * layout_->degrees[a];
    return pieces;
}

std::vector<double> CurvedCell::samples(std::size_t axis) const {
    return at_grid(sample_pieces(axis));
}

double CurvedCell::bend(std::size_t axis, std::span<const double> samples, std::size_t first, std::size_t count) const {
    const auto pieces = sample_pieces(axis);
    std::size_t stride = shown(), outer = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= pieces[a] + 1;
    for (std::size_t a = axis + 1; a < 3; ++a) outer *= pieces[a] + 1;
    const std::size_t m = pieces[axis];
    double largest = 0;
    const auto difference = [&](std::size_t at) { return samples[at - stride] - 2 * samples[at] + samples[at + stride]; };
    for (std::size_t o = 0; o < outer; ++o) {
        for (std::size_t inner = 0; inner < stride; inner += shown()) {
            const auto index = [&](std::size_t i, std::size_t k) { return (o * (m + 1) + i) * stride + inner + first + k; };
            for (std::size_t i = 1; i < m; ++i) {
                double inside = 0, end = 0;
                for (std::size_t k = 0; k < count; ++k) {
                    const double here = difference(index(i, k));
                    inside += here * here;
                    // At the ends the derivative is continued linearly: exact up to the third degree.
                    if (i != 1 && i + 1 != m) continue;
                    const double there = 2 * here - difference(index(i == 1 ? 2 : m - 2, k));
                    end += there * there;
                }
                largest = std::max({largest, inside, end});
            }
        }
    }
    return std::sqrt(largest) * static_cast<double>(m * m);
}

}  // namespace subvol::detail
