// SPDX-License-Identifier: Apache-2.0
#include "cell_cutter.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

// The other corners of a positively oriented tetrahedron, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 4> kOpposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
// Even permutations that begin with each pair of corners.
constexpr std::array<std::array<std::size_t, 4>, 6> kPairs{
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

/// A point before it is known whether another tetrahedron has it too: its ends in the cell's grid, the smaller number first.
using LocalPoint = std::array<std::uint32_t, 2>;

class CellCutter {
public:
    CellCutter(const DenseCell& grid, std::span<const double> values, const Cut& cut, const Topology& topology,
               const GridNumbers& numbers)
        : grid_(grid), values_(values), cut_(cut), side_(grid.side), number_(numbers, grid.cell) {
        for (std::size_t f = 0; f < 6; ++f) on_hull_[f] = cut.hull && topology.face_on_hull(topology.cell_faces[grid.cell][f]);
        any_hull_ = std::ranges::find(on_hull_, true) != on_hull_.end();
        numbers_.resize(side_ * side_ * side_);
        for (std::size_t k = 0; k < side_; ++k) {
            for (std::size_t j = 0; j < side_; ++j) {
                for (std::size_t i = 0; i < side_; ++i) numbers_[linear(i, j, k)] = number_(i, j, k);
            }
        }
    }

    CellTriangles run() {
        for (std::size_t k = 0; k + 1 < side_; ++k) {
            for (std::size_t j = 0; j + 1 < side_; ++j) {
                for (std::size_t i = 0; i + 1 < side_; ++i) cut_child(i, j, k);
            }
        }
        return finish();
    }

private:
    [[nodiscard]] std::size_t linear(std::size_t i, std::size_t j, std::size_t k) const { return i + side_ * (j + side_ * k); }
    [[nodiscard]] bool inside(std::uint32_t vertex) const { return !cut_.iso || values_[vertex] >= *cut_.iso; }

    void cut_child(std::size_t i, std::size_t j, std::size_t k) {
        std::array<std::uint32_t, 8> vertices;
        std::size_t ins = 0;
        for (std::size_t c = 0; c < 8; ++c) {
            const auto& [u, v, w] = kCornerParameters[c];
            vertices[c] = static_cast<std::uint32_t>(
                linear(i + static_cast<std::size_t>(u), j + static_cast<std::size_t>(v), k + static_cast<std::size_t>(w)));
            ins += inside(vertices[c]) ? 1 : 0;
        }
        const std::size_t last = side_ - 2;
        const bool at_hull = any_hull_ && ((on_hull_[0] && i == 0) || (on_hull_[1] && i == last) || (on_hull_[2] && j == 0) ||
                                           (on_hull_[3] && j == last) || (on_hull_[4] && k == 0) || (on_hull_[5] && k == last));
        if (ins == 0 || (ins == 8 && !at_hull)) return;
        // Only the order of the numbers decides how a cell is split.
        std::array<Index, 8> ranks{};
        for (std::size_t a = 0; a < 8; ++a) {
            for (std::size_t b = 0; b < 8; ++b) ranks[a] += numbers_[vertices[b]] < numbers_[vertices[a]] ? 1 : 0;
        }
        std::array<std::uint32_t, 8> of_rank;
        for (std::size_t c = 0; c < 8; ++c) of_rank[ranks[c]] = vertices[c];
        for (const auto& tet : split_cell(ranks)) {
            const std::array<std::uint32_t, 4> corners{of_rank[tet[0]], of_rank[tet[1]], of_rank[tet[2]], of_rank[tet[3]]};
            if (cut_.iso && ins < 8) cut_tetrahedron(corners);
            if (at_hull) clip_faces(corners);
        }
    }

    void cut_tetrahedron(const std::array<std::uint32_t, 4>& t) {
        unsigned in = 0;
        for (std::size_t c = 0; c < 4; ++c) in |= inside(t[c]) ? 1U << c : 0;
        if (in == 0 || in == 15) return;
        for (std::size_t c = 0; c < 4; ++c) {
            const auto& [x, y, z] = kOpposite[c];
            if (in == 1U << c) add({edge(t[c], t[x]), edge(t[c], t[y]), edge(t[c], t[z])}, false);
            if (in == (15U & ~(1U << c))) add({edge(t[c], t[x]), edge(t[c], t[z]), edge(t[c], t[y])}, false);
        }
        for (const auto& [a, b, c, d] : kPairs) {
            if (in != (1U << a | 1U << b)) continue;
            const LocalPoint ac = edge(t[a], t[c]), ad = edge(t[a], t[d]), bd = edge(t[b], t[d]), bc = edge(t[b], t[c]);
            add({ac, ad, bd}, false);
            add({ac, bd, bc}, false);
        }
    }

    /// The parts of the tetrahedron's faces on the hull that are inside.
    void clip_faces(const std::array<std::uint32_t, 4>& t) {
        for (const auto& face : kOpposite) {
            const std::array<std::uint32_t, 3> p{t[face[0]], t[face[1]], t[face[2]]};
            if ((hull_sides(p[0]) & hull_sides(p[1]) & hull_sides(p[2])) == 0) continue;
            std::size_t ins = 0;
            for (const std::uint32_t vertex : p) ins += inside(vertex) ? 1 : 0;
            if (ins == 3) add({vertex(p[0]), vertex(p[1]), vertex(p[2])}, true);
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t a = p[c], b = p[(c + 1) % 3], d = p[(c + 2) % 3];
                if (ins == 1 && inside(a)) add({vertex(a), edge(a, b), edge(a, d)}, true);
                if (ins != 2 || inside(a)) continue;
                add({edge(a, b), vertex(b), vertex(d)}, true);
                add({edge(a, b), vertex(d), edge(a, d)}, true);
            }
        }
    }

    [[nodiscard]] std::array<std::size_t, 3> position(std::uint32_t vertex) const {
        return {vertex % side_, vertex / side_ % side_, vertex / side_ / side_};
    }

    /// The faces of the hull that a vertex lies on, a bit for each.
    [[nodiscard]] unsigned hull_sides(std::uint32_t vertex) const {
        const auto at = position(vertex);
        unsigned sides = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (at[axis] == 0 && on_hull_[2 * axis]) sides |= 1U << (2 * axis);
            if (at[axis] == side_ - 1 && on_hull_[2 * axis + 1]) sides |= 2U << (2 * axis);
        }
        return sides;
    }

    [[nodiscard]] LocalPoint edge(std::uint32_t a, std::uint32_t b) const {
        return numbers_[a] < numbers_[b] ? LocalPoint{a, b} : LocalPoint{b, a};
    }
    static LocalPoint vertex(std::uint32_t a) { return {a, a}; }

    void add(const std::array<LocalPoint, 3>& corners, bool hull) {
        triangles_.push_back(corners);
        hull_.push_back(hull ? 1 : 0);
    }

    [[nodiscard]] CellTriangles finish() const {
        CellTriangles found;
        found.hull = hull_;
        std::vector<LocalPoint> points;
        points.reserve(3 * triangles_.size());
        for (const auto& corners : triangles_) points.insert(points.end(), corners.begin(), corners.end());
        std::ranges::sort(points);
        points.erase(std::unique(points.begin(), points.end()), points.end());
        for (const auto& corners : triangles_) {
            std::array<std::uint32_t, 3> triangle;
            for (std::size_t c = 0; c < 3; ++c) {
                triangle[c] = static_cast<std::uint32_t>(std::ranges::lower_bound(points, corners[c]) - points.begin());
            }
            found.triangles.push_back(triangle);
        }
        for (const auto& [a, b] : points) {
            SurfacePoint point{numbers_[a], numbers_[b], grid_.cell, {}, {}, 6};
            std::size_t end = 0;
            for (const std::uint32_t vertex : {a, b}) {
                const auto at = position(vertex);
                for (std::size_t axis = 0; axis < 3; ++axis) point.at[end][axis] = static_cast<std::uint16_t>(at[axis]);
                point.off[end++] = cut_.iso ? values_[vertex] - *cut_.iso : 0;
            }
            const unsigned sides = any_hull_ ? hull_sides(a) & hull_sides(b) : 0;
            for (std::size_t f = 6; f-- > 0;) point.side = (sides >> f & 1) != 0 ? static_cast<std::uint8_t>(f) : point.side;
            found.points.push_back(point);
        }
        return found;
    }

    const DenseCell& grid_;
    std::span<const double> values_;
    const Cut& cut_;
    std::size_t side_;
    GridNumbers::Cell number_;
    std::array<bool, 6> on_hull_{};
    bool any_hull_ = false;
    std::vector<VertexNumber> numbers_;
    std::vector<std::array<LocalPoint, 3>> triangles_;
    std::vector<std::uint8_t> hull_;
};

}  // namespace

CellTriangles cut_cell(const DenseCell& grid, std::span<const double> values, const Cut& cut, const Topology& topology,
                       const GridNumbers& numbers) {
    return CellCutter(grid, values, cut, topology, numbers).run();
}

}  // namespace subvol::detail
