// SPDX-License-Identifier: Apache-2.0
// Into how many pieces each edge of curved cells is cut, and the numbers of the points that result.
//
//     ┌─a─┬─b─┐   Opposite edges of a cell have as many pieces, and so have all edges that cells join in this way: the
//     c   c   c   edges c are one class. A class is found by joining the four edges of each cell that run along an axis.
//     └─a─┴─b─┘
//
// Pieces are given one by one, to the class with the largest error, until all are within the tolerance or there are too many
// hexahedra. The points of the grids are numbered: corners first, then those inside edges, then for each cell those inside its
// faces that are new, and those inside the cell. Neighbours agree on a shared point, as an edge is walked from its smaller end
// and a face from its smallest corner, first towards that one's smaller neighbour.
#include "curved_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/counted_rows.h"

namespace subvol::detail {

namespace {

std::array<Index, 2> key(const std::array<Index, 8>& cell, std::size_t e) {
    const Index a = cell[kCellEdges[e][0]], b = cell[kCellEdges[e][1]];
    return {std::min(a, b), std::max(a, b)};
}

}  // namespace

EdgeClasses::EdgeClasses(std::span<const std::array<Index, 8>> cells) {
    for (const auto& cell : cells) {
        for (std::size_t e = 0; e < 12; ++e) keys_.push_back(key(cell, e));
    }
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    parents_.resize(keys_.size());
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
    for (const auto& cell : cells) {
        for (std::size_t e = 0; e < 12; ++e) {
            if (e % 4 != 0) join(edge(cell, e - e % 4), edge(cell, e));
        }
    }
}

std::size_t EdgeClasses::edge(const std::array<Index, 8>& cell, std::size_t e) const {
    return static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), key(cell, e)) - keys_.begin());
}

std::size_t EdgeClasses::class_of(std::size_t edge) const {
    while (parents_[edge] != edge) edge = parents_[edge];
    return edge;
}

void EdgeClasses::join(std::size_t a, std::size_t b) {
    a = class_of(a);
    b = class_of(b);
    for (std::size_t* x : {&a, &b}) parents_[*x] = std::min(a, b);
}

namespace {

// Volumes add up the error of the shape, and nothing adds up that of the fields.
constexpr double kFieldsPerShape = 400;

// Where there are as many pieces as between the nodes of the file, the limit goes through all values that the file has, and is
// nearer to its polynomials than the straight lines whose error is measured. Up to there fields come before more pieces for the
// shape.
constexpr double kNearerThroughNodes = 8;

double squared(std::size_t n) {
    return static_cast<double>(n) * static_cast<double>(n);
}

// The cells beside the edges of each class.
Rows<std::size_t> cells_of_classes(const std::vector<std::array<std::size_t, 3>>& class_of, std::size_t class_count) {
    return counted_rows<std::size_t>(class_count, [&](const auto& put) {
        for (std::size_t c = 0; c < class_of.size(); ++c) {
            const auto& [a, b, d] = class_of[c];
            put(a, c);
            if (b != a) put(b, c);
            if (d != a && d != b) put(d, c);
        }
    });
}

}  // namespace

double fields_error(double bend, std::size_t degree, std::size_t n) {
    return bend / squared(n) / (n < degree ? 1 : kNearerThroughNodes);
}

/// The error of a class of edges, in parts of the tolerance, falls as 1 / n² with n pieces; three directions share the
/// tolerance. The class of the largest error gets the next piece. The order of these steps depends neither on the tolerance nor
/// on the most hexahedra: both only say where the steps end.
CurvedPieces choose_pieces(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges,
                           std::span<const CellBend> bends, double tolerance, std::size_t most_hexes) {
    CurvedPieces result{std::vector<std::array<std::size_t, 3>>(cells.size()), std::vector<std::size_t>(edges.size(), 1),
                        cells.size(), most_hexes};
    std::vector<double> of_shape(edges.size()), of_fields(edges.size());
    std::vector<std::size_t> degrees(edges.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t e = result.class_of[c][axis] = edges.class_of(edges.edge(cells[c], 4 * axis));
            of_shape[e] = std::max(of_shape[e], 3. * bends[c].shape[axis]);
            of_fields[e] = std::max(of_fields[e], 3. * bends[c].fields[axis] / kFieldsPerShape);
            degrees[e] = std::max<std::size_t>(degrees[e], bends[c].degrees[axis]);
        }
    }
    const Rows<std::size_t> beside = cells_of_classes(result.class_of, edges.size());
    const auto error_of = [&](std::size_t e) {
        const std::size_t n = result.of_class[e];
        return std::max(of_shape[e] / squared(n), fields_error(of_fields[e], degrees[e], n));
    };
    using Step = std::pair<double, std::size_t>;
    const auto later = [](const Step& a, const Step& b) {
        return a.first != b.first ? a.first < b.first : a.second > b.second;
    };
    std::priority_queue<Step, std::vector<Step>, decltype(later)> steps(later);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (error_of(e) > 0) steps.push({error_of(e), e});
    }
    constexpr double kRounding = 1 + 1e-6;
    while (!steps.empty() && steps.top().first > tolerance * kRounding) {
        const std::size_t e = steps.top().second;
        steps.pop();
        const auto count = [&] {
            std::size_t sum = 0;
            for (const std::size_t c : beside[e]) {
                const auto n = result.of_cell(c);
                sum += n[0] * n[1] * n[2];
            }
            return sum;
        };
        const std::size_t before = count();
        ++result.of_class[e];
        const std::size_t hexes = result.hexes - before + count();
        if (hexes > most_hexes) {
            --result.of_class[e];
            result.limited = true;
            break;
        }
        result.hexes = hexes;
        steps.push({error_of(e), e});
    }
    return result;
}

namespace {

using Sizes = std::array<std::size_t, 3>;

std::size_t octant_corner(std::size_t x, std::size_t y, std::size_t z) {
    return kCornerOctants[x + 2 * y + 4 * z];
}

// The corners of a face from its smallest one, over the smaller of that one's neighbours: the same for both cells.
struct Face {
    std::size_t axis, side;
    std::array<std::size_t, 2> axes;    // along the face, the one to the smaller neighbour first
    std::array<std::size_t, 2> upward;  // whether the smallest corner is at their lower end
    std::array<Index, 4> key;
};

Face face_of(const std::array<Index, 8>& cell, std::size_t axis, std::size_t side) {
    Face face{axis, side, {(axis + 1) % 3, (axis + 2) % 3}, {}, {}};
    const auto corner = [&](std::size_t a, std::size_t b) {
        std::array<std::size_t, 3> at{};
        at[axis] = side;
        at[(axis + 1) % 3] = a;
        at[(axis + 2) % 3] = b;
        return cell[octant_corner(at[0], at[1], at[2])];
    };
    std::size_t a = 0, b = 0;
    for (std::size_t k = 1; k < 4; ++k) {
        if (corner(k % 2, k / 2) < corner(a, b)) a = k % 2, b = k / 2;
    }
    const bool first = corner(1 - a, b) < corner(a, 1 - b);
    if (!first) std::swap(face.axes[0], face.axes[1]);
    face.upward = first ? std::array<std::size_t, 2>{1 - a, 1 - b} : std::array<std::size_t, 2>{1 - b, 1 - a};
    face.key = {corner(a, b), first ? corner(1 - a, b) : corner(a, 1 - b), corner(1 - a, 1 - b),
                first ? corner(a, 1 - b) : corner(1 - a, b)};
    return face;
}

}  // namespace

SplitGrids::SplitGrids(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges,
                       std::span<const std::size_t> pieces, std::size_t point_count)
    : cells_(cells), edges_(edges), pieces_(pieces), corners_(point_count, kNone) {
    const auto add = [this](std::size_t more) {
        const std::size_t first = point_count_;
        point_count_ += more;
        return first;
    };
    for (const auto& cell : cells_) {
        for (const Index p : cell) corners_[p] = 0;
    }
    for (Index& corner : corners_) {
        if (corner == 0) corner = static_cast<Index>(add(1));
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) edge_starts_.push_back(add(pieces_[edges_.class_of(e)] - 1));
    for (std::size_t c = 0; c < cells_.size() && point_count_ < kNone; ++c) {
        const Sizes n = pieces_of(c);
        for (std::size_t f = 0; f < 6; ++f) {
            const auto [start, is_new] = face_starts_.try_emplace(face_of(cells_[c], f / 2, f % 2).key, point_count_);
            if (is_new) start->second = add((n[(f / 2 + 1) % 3] - 1) * (n[(f / 2 + 2) % 3] - 1));
        }
        cell_starts_.push_back(add((n[0] - 1) * (n[1] - 1) * (n[2] - 1)));
    }
}

std::array<std::size_t, 3> SplitGrids::pieces_of(std::size_t c) const {
    Sizes n{};
    for (std::size_t axis = 0; axis < 3; ++axis) n[axis] = pieces_[edges_.class_of(edges_.edge(cells_[c], 4 * axis))];
    return n;
}

std::vector<Index> SplitGrids::grid_of(std::size_t c) const {
    const std::array<Index, 8>& cell = cells_[c];
    const Sizes n = pieces_of(c);
    const auto at = [&](const Sizes& p) { return p[0] + (n[0] + 1) * (p[1] + (n[1] + 1) * p[2]); };
    std::vector<Index> grid((n[0] + 1) * (n[1] + 1) * (n[2] + 1));
    for (std::size_t k = 0; k < 8; ++k) {
        Sizes place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = kCornerParameters[k][a] == 0 ? 0 : n[a];
        grid[at(place)] = corners_[cell[k]];
    }
    for (std::size_t e = 0; e < 12; ++e) {
        const std::size_t from = kCellEdges[e][0], to = kCellEdges[e][1];
        const std::size_t axis = e / 4, start = edge_starts_[edges_.edge(cell, e)];
        Sizes place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = kCornerParameters[from][a] == 0 ? 0 : n[a];
        for (std::size_t i = 1; i < n[axis]; ++i) {
            place[axis] = i;
            grid[at(place)] = static_cast<Index>(start + (cell[from] < cell[to] ? i : n[axis] - i) - 1);
        }
    }
    for (std::size_t f = 0; f < 6; ++f) {
        const Face face = face_of(cell, f / 2, f % 2);
        const std::size_t start = face_starts_.at(face.key);
        const std::size_t n0 = n[face.axes[0]], n1 = n[face.axes[1]];
        Sizes place{};
        place[face.axis] = face.side == 0 ? 0 : n[face.axis];
        for (std::size_t j = 1; j < n1; ++j) {
            for (std::size_t i = 1; i < n0; ++i) {
                place[face.axes[0]] = face.upward[0] != 0 ? i : n0 - i;
                place[face.axes[1]] = face.upward[1] != 0 ? j : n1 - j;
                grid[at(place)] = static_cast<Index>(start + (i - 1) + (n0 - 1) * (j - 1));
            }
        }
    }
    std::size_t inside = cell_starts_[c];
    for (std::size_t z = 1; z < n[2]; ++z) {
        for (std::size_t y = 1; y < n[1]; ++y) {
            for (std::size_t x = 1; x < n[0]; ++x) grid[at({x, y, z})] = static_cast<Index>(inside++);
        }
    }
    return grid;
}

}  // namespace subvol::detail
