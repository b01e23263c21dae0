// SPDX-License-Identifier: Apache-2.0
#include "hull_cut.h"

#include <algorithm>
#include <numeric>

#include "corner_of.h"
#include "subvol/cell.h"
#include "subvol/detail/boundary_rings.h"

namespace subvol::detail {

namespace {

/// A boundary face in its cell: where its places are in the cell's grid.
class FaceInCell {
public:
    FaceInCell(const Topology& topology, Index face, int max_level) : cell_(topology.face_cells[face][0]) {
        const auto& corners = topology.cells[cell_];
        std::array<std::size_t, 4> at;
        for (std::size_t k = 0; k < 4; ++k) at[k] = corner_of(corners, topology.faces[face][k]);
        side_ = slot_of(topology.cell_faces[cell_], face);
        const auto& outward = kCellFaces[side_];
        const auto slot = [&](std::size_t corner) { return std::ranges::find(outward, corner) - outward.begin(); };
        outward_ = (slot(at[0]) + 1) % 4 == slot(at[1]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int from = kCornerParameters[at[0]][axis];
            origin_[axis] = from * hull_steps(max_level);
            along_[0][axis] = kCornerParameters[at[1]][axis] - from;
            along_[1][axis] = kCornerParameters[at[3]][axis] - from;
        }
    }

    [[nodiscard]] Index cell() const { return cell_; }
    [[nodiscard]] std::size_t side() const { return side_; }
    /// Whether its corners are counter-clockwise seen from outside.
    [[nodiscard]] bool outward() const { return outward_; }
    [[nodiscard]] std::array<std::uint16_t, 3> in_cell(const FacePlace& at) const {
        std::array<std::uint16_t, 3> place;
        for (std::size_t axis = 0; axis < 3; ++axis)
            place[axis] = static_cast<std::uint16_t>(origin_[axis] + at[0] * along_[0][axis] + at[1] * along_[1][axis]);
        return place;
    }

private:
    Index cell_;
    std::size_t side_;
    bool outward_;
    std::array<int, 3> origin_;
    std::array<std::array<int, 3>, 2> along_;
};

/// Makes triangles of leaves.
class LeafCutter {
public:
    LeafCutter(const HullLeaves& hull, const Topology& topology, int max_level)
        : hull_(hull),
          topology_(topology),
          max_level_(max_level),
          numbers_(topology, max_level + 1),
          points_(hull.vertices.size(), kNone),
          normals_(hull.vertices.size(), Vec3(0.0)) {}

    SettledCut run() {
        cut_.level = hull_.level;
        for (const HullLeaf& leaf : hull_.leaves) add(leaf);
        finish();
        return std::move(cut_);
    }

private:
    [[nodiscard]] const Vec3& at(std::uint32_t vertex) const { return hull_.vertices[vertex]; }

    void add(const HullLeaf& leaf) {
        const FaceInCell face(topology_, leaf.face, max_level_);
        SurfaceSoup& soup = cut_.soup;
        if (soup.cells.empty() || soup.cells.back() != face.cell()) {
            soup.cells.push_back(face.cell());
            soup.ends.push_back(soup.triangles.size());
        }
        const std::size_t count = leaf.ring.size();
        const auto triangle = [&](const LeafVertex& a, const LeafVertex& b, const LeafVertex& c) {
            std::array<Index, 3> points{point(a, face), point(b, face), point(c, face)};
            if (!face.outward()) std::swap(points[1], points[2]);
            soup.triangles.push_back(points);
            soup.hull.push_back(1);
        };
        const auto ring = [&](std::size_t i) -> const LeafVertex& { return leaf.ring[i % count]; };
        if (count == 4) {
            // The diagonal that is nearer to the centre; along a plane, the shorter one.
            const std::size_t first = nearer_diagonal(leaf);
            triangle(ring(first), ring(first + 1), ring(first + 2));
            triangle(ring(first), ring(first + 2), ring(first + 3));
        } else if (count == 5) {
            std::size_t between = 0;
            while (std::ranges::find(leaf.corners, between) != leaf.corners.end()) ++between;
            for (std::size_t k = 1; k < 4; ++k) triangle(ring(between), ring(between + k), ring(between + k + 1));
        } else {
            for (std::size_t k = 0; k < count; ++k) triangle(ring(k), ring(k + 1), leaf.center);
        }
        soup.ends.back() = soup.triangles.size();
        add_normals(leaf, face.outward());
        cut_.deviation_world = std::max(cut_.deviation_world, leaf.bend);
    }

    [[nodiscard]] std::size_t nearer_diagonal(const HullLeaf& leaf) const {
        std::array<double, 2> far;
        for (std::size_t k = 0; k < 2; ++k) {
            const Vec3 &a = at(leaf.ring[k].vertex), &b = at(leaf.ring[k + 2].vertex);
            far[k] = leaf.center.vertex == kNoVertex ? 0 : glm::length(at(leaf.center.vertex) - 0.5 * (a + b));
            far[k] += 1e-3 * glm::distance(a, b);
        }
        return far[1] < far[0] ? 1 : 0;
    }

    /// The number of the point at a vertex, which is that of the first leaf that has it.
    Index point(const LeafVertex& vertex, const FaceInCell& face) {
        Index& known = points_[vertex.vertex];
        if (known != kNone) return known;
        const auto place = face.in_cell(vertex.at);
        const VertexNumber number = GridNumbers::Cell(numbers_, face.cell())(place[0], place[1], place[2]);
        known = static_cast<Index>(cut_.soup.points.size());
        cut_.soup.points.push_back(
            {number, number, face.cell(), {place, place}, {0, 0}, static_cast<std::uint8_t>(face.side())});
        vertices_.push_back(vertex.vertex);
        return known;
    }

    /// Adds to the normals at the vertices of a leaf those of the triangles about its centre, which count as on a sphere.
    ///
    /// source: N. Max, Weights for computing vertex normals from facet normals, Journal of Graphics Tools 4 (1999)
    void add_normals(const HullLeaf& leaf, bool outward) {
        std::vector<std::uint32_t>& ring = ring_;  // with the middles of the sides that have no vertices
        ring.clear();
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t end = k < 3 ? leaf.corners[k + 1] : leaf.ring.size();
            for (std::size_t i = leaf.corners[k]; i < end; ++i) ring.push_back(leaf.ring[i].vertex);
            if (end - leaf.corners[k] == 1 && leaf.middles[k] != kNoVertex) ring.push_back(leaf.middles[k]);
        }
        Vec3 center(0.0);
        for (const std::uint32_t corner : leaf.corners) center += 0.25 * at(leaf.ring[corner].vertex);
        if (leaf.center.vertex != kNoVertex) center = at(leaf.center.vertex);
        const auto add = [&](std::uint32_t vertex, const Vec3& u, const Vec3& v) {
            const double weight = glm::dot(u, u) * glm::dot(v, v);
            if (weight > 0) normals_[vertex] += (outward ? 1.0 : -1.0) / weight * glm::cross(u, v);
        };
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const std::uint32_t a = ring[i], b = ring[(i + 1) % ring.size()];
            add(a, at(b) - at(a), center - at(a));
            add(b, center - at(b), at(a) - at(b));
            if (leaf.center.vertex != kNoVertex) add(leaf.center.vertex, at(a) - center, at(b) - center);
        }
    }

    /// Sorts the points by their names, and places them.
    void finish() {
        SurfaceSoup& soup = cut_.soup;
        std::vector<Index> order(soup.points.size()), ranks(soup.points.size());
        std::iota(order.begin(), order.end(), Index{0});
        std::ranges::sort(order, {}, [&](Index p) { return soup.points[p].a; });
        std::vector<SurfacePoint> points;
        points.reserve(order.size());
        const double step = 1.0 / hull_steps(max_level_);
        for (const Index p : order) {
            ranks[p] = static_cast<Index>(points.size());
            const SurfacePoint& point = points.emplace_back(soup.points[p]);
            const auto& [i, j, k] = point.at[0];
            cut_.settled.places.push_back({point.cell, step * Vec3(i, j, k)});
            cut_.settled.positions.push_back(at(vertices_[p]));
            const Vec3& normal = normals_[vertices_[p]];
            const double length = glm::length(normal);
            cut_.settled.normals.push_back(length > 0 ? normal / length : Vec3(0.0));
        }
        soup.points = std::move(points);
        for (auto& triangle : soup.triangles) {
            for (Index& p : triangle) p = ranks[p];
        }
    }

    const HullLeaves& hull_;
    const Topology& topology_;
    int max_level_;
    GridNumbers numbers_;
    std::vector<Index> points_;                   // of the vertices
    std::vector<Vec3> normals_;                   // at the vertices
    std::vector<std::uint32_t> vertices_, ring_;  // of the points; of a leaf
    SettledCut cut_;
};

}  // namespace

SettledCut hull_cut(const HullLeaves& hull, const Topology& topology, int max_level) {
    return LeafCutter(hull, topology, max_level).run();
}

SettledCut part_of(const SettledCut& whole, const ShareRange& range) {
    SettledCut part{.level = whole.level,
                    .deviation_world = whole.deviation_world,
                    .converged = whole.converged,
                    .range = range,
                    .soup = {},
                    .settled = {}};
    const SurfaceSoup& from = whole.soup;
    const std::size_t begin = range.begin, end = range.end;
    const std::size_t first = begin > 0 ? from.ends[begin - 1] : 0, last = end > 0 ? from.ends[end - 1] : 0;
    std::vector<Index> numbers(from.points.size(), kNone);
    for (std::size_t t = first; t < last; ++t) {
        for (const Index p : from.triangles[t]) numbers[p] = 0;
    }
    part.settled.fields = without_points(whole.settled.fields);
    for (Index p = 0; p < numbers.size(); ++p) {
        if (numbers[p] == kNone) continue;
        numbers[p] = static_cast<Index>(part.soup.points.size());
        part.soup.points.push_back(from.points[p]);
        part.settled.add(whole.settled, p);
    }
    for (std::size_t t = first; t < last; ++t) {
        auto& triangle = part.soup.triangles.emplace_back(from.triangles[t]);
        for (Index& p : triangle) p = numbers[p];
        part.soup.hull.push_back(from.hull[t]);
    }
    for (std::size_t c = begin; c < end; ++c) {
        part.soup.cells.push_back(from.cells[c]);
        part.soup.ends.push_back(from.ends[c] - first);
    }
    return part;
}

}  // namespace subvol::detail
