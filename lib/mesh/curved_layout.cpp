// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "curved_cells.h"
#include "subvol/cell.h"

namespace subvol::detail {

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
