// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "subvol/topology.h"

namespace subvol::test {

/// The inside of a mesh, from its boundary alone: a centre is inside if the column below it enters the boundary more often than
/// it leaves it. The cells are not used.
class SolidColumns {
public:
    /// shift: of the centres, in voxels, as in the rasterizer's rule for centres on the boundary
    SolidColumns(const HexMesh& mesh, double voxel_size, const Vec3& shift = 1e-6 * Vec3(1.0, 0.83, 0.71)) : shift_(shift) {
        const Topology topology = build_topology(mesh);
        for (std::size_t f = 0; f < topology.faces.size(); ++f) {
            if (topology.face_cells[f][1] != kNone) continue;
            add_face(mesh, outward(mesh, topology.faces[f], topology.face_cells[f][0]), voxel_size);
        }
        for (auto& [column, crossings] : columns_) std::sort(crossings.begin(), crossings.end());
    }

    /// Calls visit(i, j, k, winding) for every centre of every column within the boundary's heights.
    void for_each(const std::function<void(int, int, int, int)>& visit) const {
        for (const auto& [column, crossings] : columns_) {
            std::size_t next = 0;
            int winding = 0;
            for (int k = static_cast<int>(std::floor(crossings.front().first)); k <= crossings.back().first; ++k) {
                while (next < crossings.size() && crossings[next].first < k + shift_.z) winding += crossings[next++].second;
                visit(column.first, column.second, k, winding);
            }
        }
    }

private:
    using Quad = std::array<Index, 4>;

    /// A face's corners counter-clockwise seen from outside, starting at the smallest.
    static Quad outward(const HexMesh& mesh, const Quad& face, Index cell) {
        for (const auto& corners : kCellFaces) {
            Quad quad, sorted, wanted = face;
            for (std::size_t k = 0; k < 4; ++k) quad[k] = mesh.cells[cell][static_cast<std::size_t>(corners[k])];
            sorted = quad;
            std::sort(sorted.begin(), sorted.end());
            std::sort(wanted.begin(), wanted.end());
            if (sorted != wanted) continue;
            std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
            return quad;
        }
        return face;
    }

    void add_face(const HexMesh& mesh, const Quad& quad, double h) {
        const auto p = [&](std::size_t k) { return mesh.points[quad[k]] / h; };
        add_triangle(p(0), p(1), p(2));
        add_triangle(p(0), p(2), p(3));
    }

    void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
        const double area = cross(b - a, c - a);
        if (area == 0) return;
        const auto range = [&](double x, double y, double z, double s) {
            return std::pair(static_cast<int>(std::ceil(std::min({x, y, z}) - s)),
                             static_cast<int>(std::floor(std::max({x, y, z}) - s)));
        };
        const auto [x0, x1] = range(a.x, b.x, c.x, shift_.x);
        const auto [y0, y1] = range(a.y, b.y, c.y, shift_.y);
        for (int i = x0; i <= x1; ++i) {
            for (int j = y0; j <= y1; ++j) {
                const Vec3 q(i + shift_.x, j + shift_.y, 0);
                const double u = cross(b - q, c - q) / area, v = cross(c - q, a - q) / area, w = cross(a - q, b - q) / area;
                if (u < 0 || v < 0 || w < 0) continue;
                columns_[{i, j}].emplace_back(u * a.z + v * b.z + w * c.z, area < 0 ? 1 : -1);
            }
        }
    }
    static double cross(const Vec3& a, const Vec3& b) { return a.x * b.y - a.y * b.x; }

    Vec3 shift_;
    std::map<std::pair<int, int>, std::vector<std::pair<double, int>>>
        columns_;  // heights; +1 where the boundary is entered upwards
};

}  // namespace subvol::test
