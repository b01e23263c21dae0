// SPDX-License-Identifier: Apache-2.0
// Cuts the surface where a field has a value, or the hull, out of the refined cells of a mesh, without refining the whole mesh.
//
//     cells: bounds by control values → values of level 1 → candidates
//     cut:   cell → children → tetrahedra → triangles by the signs at four corners → points on edges, joined over cells
//
// Each vertex has a number that all cells around it agree on, from those of points, edges, faces and cells of the mesh. A child
// is split into tetrahedra by the order of its numbers, so that neighbours split a common face alike, and a point of the
// surface is known by the two ends of its edge: triangles of all cells meet without comparing places. Where a point lies on a
// face of a cell, the surface goes on in the cell behind it, which is cut next if it is allowed to be, until no more are found.
// On the hull, the parts of faces whose values are at least the isovalue are added.
#include "soup_cutter.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "corner_of.h"
#include "subvol/cell.h"
#include "subvol/dense_cells.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

// Between the vertices of level 1 values go beyond theirs by less than this part of their range.
constexpr double kSlack = 0.3;

// The number in kCellEdges of the edge along `axis` at the other two axes' sides (in their order).
constexpr std::array<std::array<std::size_t, 4>, 3> kEdgeAt{{{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}}};

}  // namespace

GridNumbers::GridNumbers(const Topology& topology, int level)
    : topology_(topology),
      side_(std::uint64_t{1} << level),
      first_edge_(topology.point_count),
      first_face_(first_edge_ + topology.edges.size() * (side_ - 1)),
      first_cell_(first_face_ + topology.faces.size() * (side_ - 1) * (side_ - 1)) {
}

GridNumbers::Cell::Cell(const GridNumbers& numbers, Index cell) : numbers_(numbers), cell_(cell) {
    const Topology& topology = numbers.topology_;
    const auto& corners = topology.cells[cell];
    for (std::size_t e = 0; e < 12; ++e) {
        const auto [a, b] = kCellEdges[e];
        reversed_[e] = corners[a] > corners[b];
    }
    for (std::size_t f = 0; f < 6; ++f) {
        const auto& points = topology.faces[topology.cell_faces[cell][f]];
        const auto& origin = kCornerParameters[corner_of(corners, points[0])];
        for (std::size_t side_axis = 0; side_axis < 2; ++side_axis) {
            const auto& end = kCornerParameters[corner_of(corners, points[side_axis == 0 ? 1 : 3])];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (origin[axis] == end[axis]) continue;
                faces_[f].axis[side_axis] = axis;
                faces_[f].reversed[side_axis] = origin[axis] == 1;
            }
        }
    }
}

VertexNumber GridNumbers::Cell::operator()(std::size_t i, std::size_t j, std::size_t k) const {
    const Topology& topology = numbers_.topology_;
    const std::uint64_t n = numbers_.side_;
    const std::array<std::uint64_t, 3> at{i, j, k};
    std::array<std::size_t, 3> inner{};
    std::size_t inner_count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at[axis] != 0 && at[axis] != n) inner[inner_count++] = axis;
    }
    const auto is_high = [&](std::size_t axis) { return at[axis] != 0 ? std::size_t{1} : std::size_t{0}; };
    if (inner_count == 0) return topology.cells[cell_][kCornerOctants[is_high(0) + 2 * is_high(1) + 4 * is_high(2)]];
    if (inner_count == 1) {
        const std::size_t axis = inner[0];
        const std::size_t first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
        const std::size_t edge = kEdgeAt[axis][is_high(first) + 2 * is_high(second)];
        const std::uint64_t along = reversed_[edge] ? n - at[axis] : at[axis];
        return numbers_.first_edge_ + topology.cell_edges[cell_][edge] * (n - 1) + along - 1;
    }
    if (inner_count == 2) {
        const std::size_t across = 3 - inner[0] - inner[1];
        const std::size_t side = 2 * across + is_high(across);
        const FaceAxes& axes = faces_[side];
        const auto along = [&](std::size_t side_axis) {
            const std::uint64_t t = at[axes.axis[side_axis]];
            return (axes.reversed[side_axis] ? n - t : t) - 1;
        };
        return numbers_.first_face_ + topology.cell_faces[cell_][side] * (n - 1) * (n - 1) + along(1) * (n - 1) + along(0);
    }
    return numbers_.first_cell_ + cell_ * (n - 1) * (n - 1) * (n - 1) + ((k - 1) * (n - 1) + j - 1) * (n - 1) + i - 1;
}

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
        numbers_.assign(side_ * side_ * side_, kNotYet);
    }

    CellTriangles run() {
        for (std::size_t k = 0; k + 1 < side_; ++k) {
            for (std::size_t j = 0; j + 1 < side_; ++j) {
                if (cut_.iso || at_hull(1, j, k)) {
                    for (std::size_t i = 0; i + 1 < side_; ++i) cut_child(i, j, k);
                } else {  // the hull alone: the row meets it at its ends
                    cut_child(0, j, k);
                    if (side_ > 2) cut_child(side_ - 2, j, k);
                }
            }
        }
        return finish();
    }

private:
    [[nodiscard]] std::size_t linear(std::size_t i, std::size_t j, std::size_t k) const { return i + side_ * (j + side_ * k); }
    [[nodiscard]] bool inside(std::uint32_t vertex) const { return !cut_.iso || values_[vertex] >= *cut_.iso; }

    /// Whether a child has a face on the hull.
    [[nodiscard]] bool at_hull(std::size_t i, std::size_t j, std::size_t k) const {
        const std::size_t last = side_ - 2;
        return any_hull_ && ((on_hull_[0] && i == 0) || (on_hull_[1] && i == last) || (on_hull_[2] && j == 0) ||
                             (on_hull_[3] && j == last) || (on_hull_[4] && k == 0) || (on_hull_[5] && k == last));
    }

    /// The number of a vertex: few vertices are asked for.
    [[nodiscard]] VertexNumber number(std::uint32_t vertex) {
        VertexNumber& known = numbers_[vertex];
        if (known == kNotYet) {
            const auto at = position(vertex);
            known = number_(at[0], at[1], at[2]);
        }
        return known;
    }

    void cut_child(std::size_t i, std::size_t j, std::size_t k) {
        std::array<std::uint32_t, 8> vertices;
        std::size_t ins = 0;
        for (std::size_t c = 0; c < 8; ++c) {
            const auto& [u, v, w] = kCornerParameters[c];
            vertices[c] = static_cast<std::uint32_t>(
                linear(i + static_cast<std::size_t>(u), j + static_cast<std::size_t>(v), k + static_cast<std::size_t>(w)));
            ins += inside(vertices[c]) ? 1 : 0;
        }
        const bool with_hull = at_hull(i, j, k);
        if (ins == 0 || (ins == 8 && !with_hull)) return;
        // Only the order of the numbers decides how a cell is split.
        std::array<VertexNumber, 8> numbers;
        std::ranges::transform(vertices, numbers.begin(), [&](std::uint32_t vertex) { return number(vertex); });
        std::array<Index, 8> ranks{};
        for (std::size_t a = 0; a < 8; ++a) {
            for (std::size_t b = 0; b < 8; ++b) ranks[a] += numbers[b] < numbers[a] ? 1 : 0;
        }
        std::array<std::uint32_t, 8> of_rank;
        for (std::size_t c = 0; c < 8; ++c) of_rank[ranks[c]] = vertices[c];
        for (const auto& tet : split_cell(ranks)) {
            const std::array<std::uint32_t, 4> corners{of_rank[tet[0]], of_rank[tet[1]], of_rank[tet[2]], of_rank[tet[3]]};
            if (cut_.iso && ins < 8) cut_tetrahedron(corners);
            if (with_hull) clip_faces(corners);
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

    static constexpr VertexNumber kNotYet = ~VertexNumber{0};

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

namespace {

/// One list of points for all cells: those that several cells have, once.
SurfaceSoup join(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts, const std::vector<Index>& slots) {
    struct Named {
        VertexNumber a, b;
        std::uint64_t at;  // in the order of cells and their points
        auto operator<=>(const Named&) const = default;
    };
    std::vector<Named> named;
    std::vector<std::size_t> starts;
    for (const Index cell : cells) {
        starts.push_back(named.size());
        for (const SurfacePoint& point : parts[slots[cell]].points) named.push_back({point.a, point.b, named.size()});
    }
    std::vector<const SurfacePoint*> given;
    for (const Index cell : cells) {
        for (const SurfacePoint& point : parts[slots[cell]].points) given.push_back(&point);
    }
    tbb::parallel_sort(named.begin(), named.end());
    SurfaceSoup soup;
    soup.cells = cells;
    std::vector<Index> numbers(named.size());
    for (std::size_t i = 0; i < named.size(); ++i) {
        const bool again = i > 0 && named[i].a == named[i - 1].a && named[i].b == named[i - 1].b;
        if (!again) soup.points.push_back(*given[named[i].at]);
        // A point of the hull has a face of it in some of its cells only.
        if (again && soup.points.back().side == 6 && given[named[i].at]->side != 6) soup.points.back() = *given[named[i].at];
        numbers[named[i].at] = static_cast<Index>(soup.points.size() - 1);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const CellTriangles& part = parts[slots[cells[c]]];
        for (const auto& t : part.triangles) {
            soup.triangles.push_back({numbers[starts[c] + t[0]], numbers[starts[c] + t[1]], numbers[starts[c] + t[2]]});
        }
        soup.hull.insert(soup.hull.end(), part.hull.begin(), part.hull.end());
        soup.ends.push_back(soup.triangles.size());
    }
    return soup;
}

}  // namespace

/// Cells whose vertices of level 1 may have values about the isovalue: bounds from the control values around them, before any
/// is computed. A row whose negative weights sum up to -n makes values at most n times the range of the control values beyond
/// these. For MCQ with tension w, n is at most 8 w where all points of the rule are there, and 24 w where some are
/// extrapolated.
std::vector<Index> SoupCutter::near_isovalue(const Cut& cut) const {
    struct Around {
        double low = HUGE_VAL, high = -HUGE_VAL;
        std::size_t cells = 0;
    };
    // Points of other schemes depend on two layers of cells, and a function on more than its values at the points.
    const bool bounded = interpolates(scheme_.kind) && mesh_.attributes[0].function == nullptr;
    const double tension = scheme_.kind == Scheme::Mcq ? scheme_.tension : 0;
    std::vector<Around> points(bounded ? mesh_.points.size() : 0);
    const auto range_at = [&](Index cell, const auto& low_of, const auto& high_of) {
        std::array<double, 2> range{HUGE_VAL, -HUGE_VAL};
        for (const Index p : mesh_.cells[cell]) range = {std::min(range[0], low_of(p)), std::max(range[1], high_of(p))};
        return range;
    };
    for (Index c = 0; bounded && c < mesh_.cells.size(); ++c) {
        const auto value = [&](Index p) { return mesh_.attributes[0].values[p]; };
        const auto [low, high] = range_at(c, value, value);
        for (const Index p : mesh_.cells[c]) {
            points[p] = {std::min(points[p].low, low), std::max(points[p].high, high), points[p].cells + 1};
        }
    }
    std::vector<Index> near;
    for (Index c = 0; c < mesh_.cells.size(); ++c) {
        if (!may_cut(c)) continue;
        if (bounded) {
            const auto [low, high] = range_at(
                c, [&](Index p) { return points[p].low; }, [&](Index p) { return points[p].high; });
            const bool inside = std::ranges::all_of(mesh_.cells[c], [&](Index p) { return points[p].cells == 8; });
            const double beyond = (inside ? 8 : 24) * tension, far = (beyond + kSlack * (1 + 2 * beyond)) * (high - low);
            if (high + far < *cut.iso || (low - far > *cut.iso && !(cut.hull && has_hull(c)))) continue;
        }
        near.push_back(c);
    }
    return near;
}

std::vector<Index> SoupCutter::candidates(const Cut& cut) const {
    std::vector<std::uint8_t> wanted(mesh_.cells.size(), 0);
    if (cut.iso) {
        const std::vector<Index> near = near_isovalue(cut);
        const DenseCells cells(mesh_, {.scheme = scheme_, .levels = 1, .progress = progress_}, true, DenseBits::ToRounding);
        cells.for_each(near, [&](const DenseCell& cell) {
            const auto [low, high] = std::ranges::minmax(cell.values[0]);
            const double slack = kSlack * (high - low);
            const bool crossed = low - slack < *cut.iso && high + slack >= *cut.iso;
            const bool on_hull = cut.hull && has_hull(cell.cell) && high + slack >= *cut.iso;
            wanted[cell.cell] = crossed || on_hull ? 1 : 0;
        });
    } else {
        for (Index c = 0; c < wanted.size(); ++c) wanted[c] = may_cut(c) && has_hull(c) ? 1 : 0;
    }
    std::vector<Index> found;
    for (Index c = 0; c < wanted.size(); ++c) {
        if (wanted[c] != 0) found.push_back(c);
    }
    return found;
}

bool SoupCutter::has_hull(Index cell) const {
    return std::ranges::any_of(topology_.cell_faces[cell], [&](Index f) { return topology_.face_on_hull(f); });
}

/// Cuts the cells, and neighbours into which the surface leads from them, until no more are found.
SurfaceSoup SoupCutter::cut(const Cut& cut, int level, std::vector<Index> todo, const SurfaceReach& reach) const {
    const GridNumbers numbers(topology_, level);
    // Cells that share a vertex must agree on which side of the isovalue it is. On the hull only its number counts.
    std::optional<DenseCells> dense;
    if (cut.iso) dense.emplace(mesh_, RefineOptions{.scheme = scheme_, .levels = level, .progress = progress_}, true);
    std::vector<Index> slots(mesh_.cells.size(), kNone);
    for (const Index cell : reach.not_into) slots[cell] = 0;  // as if it had been cut
    std::vector<CellTriangles> parts;
    std::vector<Index> cells;
    bool leads_out = false;
    while (!todo.empty()) {
        for (const Index cell : todo) {
            slots[cell] = static_cast<Index>(cells.size());
            cells.push_back(cell);
        }
        parts.resize(cells.size());
        const auto cut_one = [&](const DenseCell& cell) {
            parts[slots[cell.cell]] =
                cut_cell(cell, cut.iso ? cell.values[0] : std::span<const double>(), cut, topology_, numbers);
        };
        if (dense) {
            dense->for_each(todo, cut_one);
        } else {
            const std::size_t side = (std::size_t{1} << level) + 1;
            parallel_each(todo.size(),
                          [&](std::size_t i) { cut_one({.cell = todo[i], .side = side, .points = {}, .values = {}}); });
        }
        if (!reach.follow) break;
        todo = reached(cells, parts, todo.size(), slots, level);
        const std::size_t before = todo.size();
        std::erase_if(todo, [&](Index cell) { return !may_cut(cell); });
        leads_out = leads_out || todo.size() < before;
    }
    std::erase_if(cells, [&](Index cell) { return parts[slots[cell]].triangles.empty(); });
    std::ranges::sort(cells);
    SurfaceSoup soup = join(cells, parts, slots);
    soup.leads_out = leads_out;
    return soup;
}

/// Cells that have not been cut, but share a face with a point on it.
std::vector<Index> SoupCutter::reached(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                                       std::size_t last, const std::vector<Index>& slots, int level) const {
    const auto end = static_cast<std::uint16_t>(1U << level);
    std::vector<Index> found;
    for (std::size_t i = cells.size() - last; i < cells.size(); ++i) {
        for (const SurfacePoint& point : parts[i].points) {
            if (point.a == point.b) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (point.at[0][axis] != point.at[1][axis]) continue;
                if (point.at[0][axis] == 0) add_neighbors(cells[i], 2 * axis, slots, found);
                if (point.at[0][axis] == end) add_neighbors(cells[i], 2 * axis + 1, slots, found);
            }
        }
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

void SoupCutter::add_neighbors(Index cell, std::size_t side, const std::vector<Index>& slots, std::vector<Index>& found) const {
    for (const Index other : topology_.face_cells[topology_.cell_faces[cell][side]]) {
        if (other != kNone && slots[other] == kNone) found.push_back(other);
    }
}

}  // namespace subvol::detail
