// SPDX-License-Identifier: Apache-2.0
// Curved hexahedra as polynomials over a lattice of nodes: degrees p, q, r, and (p + 1)(q + 1)(r + 1) slots, x fastest. A
// layout says which slot each node of the file has in the order of its format; positions and fields are channels of the same
// lattice.
//
//     20 or 24 nodes   the missing middles follow from others:   face  ½ Σ edges − ¼ Σ corners
//                                                                cell  ½ Σ faces − ¼ Σ edges + ⅛ Σ corners
//     rational         channels are multiplied by the weight of their node, and divided by the sum of weights in the end
//
// Values at a grid come axis by axis, with Lagrange or Bernstein weights at i / n. The bend along an axis is the largest
// second difference of samples on the lines along it, times the square of their number: an estimate of the second derivative;
// divided by 8 n² it estimates how far n straight pieces are from the curve. At the ends the difference is continued linearly.
#include "curved_cells.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"

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

namespace {

using Place = std::array<int, 3>;

Place operator+(const Place& a, const Place& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Place step(const Place& from, const Place& to, int parts) {
    return {(to[0] - from[0]) / parts, (to[1] - from[1]) / parts, (to[2] - from[2]) / parts};
}

// Collects the places of the nodes in the order of a format.
class Nodes {
public:
    explicit Nodes(const std::array<std::size_t, 3>& degrees)
        : degrees_{static_cast<int>(degrees[0]), static_cast<int>(degrees[1]), static_cast<int>(degrees[2])} {
        for (const auto& parameters : kCornerParameters) {
            corners_.push_back({parameters[0] * degrees_[0], parameters[1] * degrees_[1], parameters[2] * degrees_[2]});
        }
        places_ = corners_;
    }

    // The nodes between the ends of edges, from the lower parameter to the upper one.
    void edges(std::initializer_list<std::array<std::size_t, 2>> ends) {
        for (const auto& [a, b] : ends) edge(corners_[a], corners_[b]);
    }

    // The nodes inside a face across an axis, and those of the cell; the first direction is fastest.
    void face(std::size_t axis, bool upper) {
        Place from{1, 1, 1}, to{degrees_[0] - 1, degrees_[1] - 1, degrees_[2] - 1};
        from[axis] = to[axis] = upper ? degrees_[axis] : 0;
        block(from, to);
    }
    void inside() { block({1, 1, 1}, {degrees_[0] - 1, degrees_[1] - 1, degrees_[2] - 1}); }

    // Gmsh: the nodes inside a face, and inside the cell, are again a face and a cell of two degrees less.
    void gmsh(const std::vector<Place>& corners, int degree) {
        static constexpr std::array<std::array<std::size_t, 2>, 12> kEdges{
            {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};
        static constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
            {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}}};
        for (const auto& [a, b] : kEdges) edge(corners[a], corners[b]);
        for (const auto& f : kFaces) gmsh_face({corners[f[0]], corners[f[1]], corners[f[2]], corners[f[3]]}, degree);
        if (degree < 2) return;
        std::vector<Place> inner;
        for (std::size_t c = 0; c < 8; ++c) {
            Place place = corners[c];
            for (std::size_t a = 0; a < 3; ++a) place[a] += kCornerParameters[c][a] == 0 ? 1 : -1;
            inner.push_back(place);
        }
        if (degree == 2) return places_.push_back(inner[0]);
        places_.insert(places_.end(), inner.begin(), inner.end());
        gmsh(inner, degree - 2);
    }
    void gmsh() { gmsh(corners_, degrees_[0]); }

    [[nodiscard]] std::vector<std::size_t> slots() const {
        std::vector<std::size_t> slots;
        for (const Place& p : places_) {
            slots.push_back(static_cast<std::size_t>(p[0] + (degrees_[0] + 1) * (p[1] + (degrees_[1] + 1) * p[2])));
        }
        return slots;
    }

private:
    void edge(const Place& from, const Place& to) {
        const int parts = std::max({std::abs(to[0] - from[0]), std::abs(to[1] - from[1]), std::abs(to[2] - from[2])});
        Place at = from;
        for (int t = 1; t < parts; ++t) places_.push_back(at = at + step(from, to, parts));
    }

    void block(const Place& from, const Place& to) {
        for (int k = from[2]; k <= to[2]; ++k) {
            for (int j = from[1]; j <= to[1]; ++j) {
                for (int i = from[0]; i <= to[0]; ++i) places_.push_back({i, j, k});
            }
        }
    }

    void gmsh_face(const std::array<Place, 4>& corners, int degree) {
        if (degree < 2) return;
        std::array<Place, 4> inner;
        for (std::size_t c = 0; c < 4; ++c) {
            inner[c] =
                corners[c] + step(corners[c], corners[(c + 1) % 4], degree) + step(corners[c], corners[(c + 3) % 4], degree);
        }
        if (degree == 2) return places_.push_back(inner[0]);
        places_.insert(places_.end(), inner.begin(), inner.end());
        for (std::size_t c = 0; c < 4; ++c) edge(inner[c], inner[(c + 1) % 4]);
        gmsh_face(inner, degree - 2);
    }

    std::array<int, 3> degrees_;
    std::vector<Place> corners_;
    std::vector<Place> places_;
};

}  // namespace

std::optional<std::size_t> uniform_degree(CurvedOrder order, std::size_t nodes) {
    const bool lagrange = order == CurvedOrder::Vtk || order == CurvedOrder::Vtk8;
    if (order != CurvedOrder::VtkBezier && order != CurvedOrder::VtkBezier8 && (nodes == 20 || (nodes == 24 && lagrange))) {
        return 2;
    }
    for (std::size_t degree = 1; degree <= kMostDegree; ++degree) {
        if ((degree + 1) * (degree + 1) * (degree + 1) == nodes) return degree;
    }
    return std::nullopt;
}

CurvedLayout curved_layout(CurvedOrder order, const std::array<std::size_t, 3>& degrees, std::size_t nodes) {
    Nodes in(degrees);
    CurvedLayout layout{degrees, order == CurvedOrder::VtkBezier || order == CurvedOrder::VtkBezier8, false, {}};
    const bool old = order == CurvedOrder::Vtk8 || order == CurvedOrder::VtkBezier8;
    layout.completed = nodes < layout.size();
    if (order == CurvedOrder::Gmsh) {
        in.gmsh();
    } else if (order == CurvedOrder::Exodus) {
        in.edges({{0, 1}, {1, 2}, {3, 2}, {0, 3}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {7, 6}, {4, 7}});
        in.inside();
        for (const std::size_t axis : {2u, 0u, 1u}) {
            in.face(axis, false);
            in.face(axis, true);
        }
    } else {
        in.edges({{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}});
        if (old) {
            in.edges({{3, 7}, {2, 6}});
        } else {
            in.edges({{2, 6}, {3, 7}});
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            in.face(axis, false);
            in.face(axis, true);
        }
        in.inside();
    }
    layout.slots = in.slots();
    if (layout.completed) layout.slots.resize(nodes);
    return layout;
}

}  // namespace subvol::detail
