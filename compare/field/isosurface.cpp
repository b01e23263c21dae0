// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sample_grid.h"
#include "subvol/field_metrics.h"

namespace subvol {

namespace {

/// An edge of the tetrahedra: the number of its lower grid point × 8 + its direction, a bit for each axis.
using Edge = std::uint64_t;
using EdgeTriangle = std::array<Edge, 3>;

/// The six tetrahedra of a cube about its diagonal from corner 0 to corner 7 (bits: x, y, z), one for each order of the axes.
constexpr std::array<std::array<unsigned, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

Vec3 corner(unsigned bits) {
    return {bits & 1, bits >> 1 & 1, bits >> 2};
}

class Marcher {
public:
    Marcher(const FieldView& field, double iso, const detail::SampleGrid& grid) : field_(field), iso_(iso), grid_(grid) {}

    Surface march(Progress* progress) {
        std::vector<EdgeTriangle> triangles;
        std::vector<double> below = layer(0);
        for (int k = 0; k < grid_.count[2]; ++k) {
            report_progress(progress, "isosurface", static_cast<double>(k) / grid_.count[2]);
            std::vector<double> above = layer(k + 1);
            std::vector<std::vector<EdgeTriangle>> rows(static_cast<std::size_t>(grid_.count[1]));
            tbb::parallel_for(0, grid_.count[1],
                              [&](int j) { march_row(j, k, below, above, rows[static_cast<std::size_t>(j)]); });
            for (const auto& row : rows) triangles.insert(triangles.end(), row.begin(), row.end());
            below = std::move(above);
        }
        return surface_of(triangles);
    }

private:
    [[nodiscard]] std::uint64_t point_number(int i, int j, int k) const {
        const auto [nx, ny, nz] = grid_.count;
        const auto u = [](int n) { return static_cast<std::uint64_t>(n); };
        return (u(k) * u(ny + 1) + u(j)) * u(nx + 1) + u(i);
    }

    /// The values at the grid points of a layer; NaN outside the domain.
    [[nodiscard]] std::vector<double> layer(int k) const {
        std::vector<double> values(point_number(0, 0, 1));
        tbb::parallel_for(0, grid_.count[1] + 1, [&](int j) {
            for (int i = 0; i <= grid_.count[0]; ++i) {
                values[point_number(i, j, 0)] =
                    field_.value(grid_.place(i, j, k)).value_or(std::numeric_limits<double>::quiet_NaN());
            }
        });
        return values;
    }

    void march_row(int j, int k, const std::vector<double>& below, const std::vector<double>& above,
                   std::vector<EdgeTriangle>& triangles) const {
        for (int i = 0; i < grid_.count[0]; ++i) {
            std::array<double, 8> values;
            unsigned inside = 0;
            bool whole = true;
            for (unsigned c = 0; c < 8; ++c) {
                const auto& values_of_layer = c >> 2 ? above : below;
                values[c] = values_of_layer[point_number(i + static_cast<int>(c & 1), j + static_cast<int>(c >> 1 & 1), 0)];
                whole = whole && !std::isnan(values[c]);
                inside |= values[c] >= iso_ ? 1u << c : 0u;
            }
            if (!whole || inside == 0 || inside == 0xff) continue;
            for (const auto& tetrahedron : kTetrahedra) add_tetrahedron(tetrahedron, inside, {i, j, k}, triangles);
        }
    }

    /// Adds triangles between the corners inside (value at least the isovalue) and those outside, facing the outside.
    void add_tetrahedron(const std::array<unsigned, 4>& corners, unsigned inside, const std::array<int, 3>& cell,
                         std::vector<EdgeTriangle>& triangles) const {
        std::array<unsigned, 4> in{}, out{};
        std::size_t ins = 0, outs = 0;
        for (const unsigned c : corners) (inside >> c & 1 ? in[ins++] : out[outs++]) = c;
        const auto add = [&](std::array<std::array<unsigned, 2>, 3> ends) {
            const auto middle = [&](std::size_t n) { return corner(ends[n][0]) + corner(ends[n][1]); };
            const Vec3 normal = glm::cross(middle(1) - middle(0), middle(2) - middle(0));
            const Vec3 outward = corner(out[0]) - corner(in[0]);  // for any pair: the plane separates all of them
            if (glm::dot(normal, outward) < 0) std::swap(ends[1], ends[2]);
            EdgeTriangle triangle;
            for (std::size_t n = 0; n < 3; ++n) triangle[n] = edge(ends[n][0], ends[n][1], cell);
            triangles.push_back(triangle);
        };
        if (ins == 1) add({{{in[0], out[0]}, {in[0], out[1]}, {in[0], out[2]}}});
        if (ins == 3) add({{{in[0], out[0]}, {in[1], out[0]}, {in[2], out[0]}}});
        if (ins == 2) {
            add({{{in[0], out[0]}, {in[0], out[1]}, {in[1], out[1]}}});
            add({{{in[0], out[0]}, {in[1], out[1]}, {in[1], out[0]}}});
        }
    }

    [[nodiscard]] Edge edge(unsigned a, unsigned b, const std::array<int, 3>& cell) const {
        const unsigned lower = a & b;  // of the two ends of an edge, one has all bits of the other
        const auto shift = [&](int axis) { return static_cast<int>(lower >> axis & 1); };
        return point_number(cell[0] + shift(0), cell[1] + shift(1), cell[2] + shift(2)) * 8 + (a ^ b);
    }

    [[nodiscard]] Surface surface_of(const std::vector<EdgeTriangle>& triangles) const {
        std::vector<Edge> edges;
        edges.reserve(3 * triangles.size());
        for (const EdgeTriangle& triangle : triangles) edges.insert(edges.end(), triangle.begin(), triangle.end());
        tbb::parallel_sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        Surface surface{std::vector<Vec3>(edges.size()), std::vector<std::array<Index, 3>>(triangles.size())};
        tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t e) { surface.points[e] = crossing(edges[e]); });
        tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t t) {
            for (std::size_t n = 0; n < 3; ++n) {
                const auto found = std::lower_bound(edges.begin(), edges.end(), triangles[t][n]);
                surface.triangles[t][n] = static_cast<Index>(found - edges.begin());
            }
        });
        return surface;
    }

    /// Where the field takes the isovalue on an edge: by regula falsi (Illinois), usually to 1e-9 of the edge.
    [[nodiscard]] Vec3 crossing(Edge edge) const {
        const auto [nx, ny, nz] = grid_.count;
        const auto columns = static_cast<std::uint64_t>(nx + 1), rows = static_cast<std::uint64_t>(ny + 1);
        const std::uint64_t point = edge / 8, row = point / columns, layer = row / rows;
        const Vec3 lower(point % columns, row % rows, layer), d = corner(static_cast<unsigned>(edge % 8));
        const auto place = [&](double t) { return grid_.place(lower.x + t * d.x, lower.y + t * d.y, lower.z + t * d.z); };
        const auto off = [&](double t) { return field_.value(place(t)).value_or(iso_) - iso_; };
        double a = 0, b = 1, at_a = off(a), at_b = off(b);
        double t = a;
        for (int step = 0; step < kMostSteps && at_a != at_b; ++step) {
            const double next = a + (b - a) * at_a / (at_a - at_b);
            if (std::abs(next - t) < kEnough) return place(next);
            t = next;
            const double value = off(t);
            if (value == 0) break;
            if ((value > 0) == (at_b > 0)) {
                b = t;
                at_b = value;
                at_a /= 2;
            } else {
                a = b;
                at_a = at_b;
                b = t;
                at_b = value;
            }
        }
        return place(t);
    }

    static constexpr int kMostSteps = 40;
    static constexpr double kEnough = 1e-9;

    const FieldView& field_;
    double iso_;
    detail::SampleGrid grid_;
};

}  // namespace

Surface isosurface(const FieldView& field, double iso, const Box& box, int resolution, Progress* progress) {
    return Marcher(field, iso, detail::SampleGrid(box, resolution)).march(progress);
}

}  // namespace subvol
