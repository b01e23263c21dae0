// SPDX-License-Identifier: Apache-2.0
#include "boundary_triangles.h"

#include <algorithm>
#include <tuple>

#include "refined_cells.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

using Quad = std::array<Vec3, 4>;

/// The corners of a side of a cell, in the order of `kCellFaces`.
std::array<Index, 4> corners_of_side(const Topology& topology, Index cell, std::size_t side) {
    std::array<Index, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = topology.cells[cell][static_cast<std::size_t>(kCellFaces[side][k])];
    return quad;
}

/// Whether two cells go round their shared face in the same direction; then one of them is turned.
bool same_direction(const std::array<Index, 4>& a, const std::array<Index, 4>& b) {
    const auto first = static_cast<std::size_t>(std::ranges::find(b, a[0]) - b.begin());
    return b[(first + 1) % 4] == a[1];
}

/// One flag per cell: its corners have the opposite order to those of the first cell of its connected part.
std::vector<std::uint8_t> turned_cells(const Topology& topology) {
    std::vector<std::uint8_t> turned(topology.cells.size()), seen(topology.cells.size());
    std::vector<Index> open;
    for (std::size_t start = 0; start < topology.cells.size(); ++start) {
        if (seen[start]) continue;
        seen[start] = 1;
        open.push_back(static_cast<Index>(start));
        while (!open.empty()) {
            const Index cell = open.back();
            open.pop_back();
            for (std::size_t side = 0; side < 6; ++side) {
                const Index face = topology.cell_faces[cell][side];
                const auto& [low, high] = topology.face_cells[face];
                const Index other = low == cell ? high : low;
                if (other == kNone || seen[other]) continue;
                seen[other] = 1;
                const auto& sides = topology.cell_faces[other];
                const auto there = static_cast<std::size_t>(std::ranges::find(sides, face) - sides.begin());
                const bool same =
                    same_direction(corners_of_side(topology, cell, side), corners_of_side(topology, other, there));
                turned[other] = static_cast<std::uint8_t>(turned[cell] ^ (same ? 1 : 0));
                open.push_back(other);
            }
        }
    }
    return turned;
}

/// A cell with sides on the boundary. first: how many sides on the boundary the cells before it have
struct BoundaryCell {
    Index cell;
    std::size_t first;
    std::vector<std::size_t> sides;
};

std::vector<BoundaryCell> boundary_cells(const Topology& topology) {
    std::vector<BoundaryCell> cells;
    std::size_t first = 0;
    for (std::size_t c = 0; c < topology.cells.size(); ++c) {
        BoundaryCell cell{static_cast<Index>(c), first, {}};
        for (std::size_t side = 0; side < 6; ++side) {
            if (topology.face_on_hull(topology.cell_faces[c][side])) cell.sides.push_back(side);
        }
        first += cell.sides.size();
        if (!cell.sides.empty()) cells.push_back(std::move(cell));
    }
    return cells;
}

/// Cuts a quad into two triangles that share its corner `start`.
void put(Quad quad, std::size_t start, bool turned, VoxelTriangle* out) {
    std::rotate(quad.begin(), quad.begin() + static_cast<std::ptrdiff_t>(start), quad.end());
    out[0] = {quad[0], quad[1], quad[2]};
    out[1] = {quad[0], quad[2], quad[3]};
    if (!turned) return;
    std::swap(out[0][1], out[0][2]);
    std::swap(out[1][1], out[1][2]);
}

std::size_t lowest_corner(const Quad& quad) {
    return static_cast<std::size_t>(
        std::ranges::min_element(
            quad, [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }) -
        quad.begin());
}

/// The steps² quads of one side of a refined cell.
void put_side(const DenseCell& cell, std::size_t side, std::ptrdiff_t steps, const ToVoxels& to_voxels, bool turned,
              VoxelTriangle* out) {
    const std::size_t last = cell.side - 1;
    const auto node = [&](int corner) {  // of the grid of nodes; corners in VTK order
        const std::size_t u = corner % 4 == 1 || corner % 4 == 2, v = corner % 4 >= 2, w = corner >= 4;
        return static_cast<std::ptrdiff_t>(last * (u + cell.side * (v + cell.side * w)));
    };
    const auto& corners = kCellFaces[side];
    const std::ptrdiff_t start = node(corners[0]);
    const std::ptrdiff_t along = (node(corners[1]) - start) / steps, across = (node(corners[3]) - start) / steps;
    for (std::ptrdiff_t i = 0; i < steps; ++i) {
        for (std::ptrdiff_t j = 0; j < steps; ++j, out += 2) {
            const std::ptrdiff_t n = start + i * along + j * across;
            const auto p = [&](std::ptrdiff_t at) { return to_voxels(cell.points[static_cast<std::size_t>(at)]); };
            const Quad quad{p(n), p(n + along), p(n + along + across), p(n + across)};
            put(quad, lowest_corner(quad), turned, out);
        }
    }
}

}  // namespace

std::vector<VoxelTriangle> boundary_triangles(const CellRequest& request) {
    const HexMesh& mesh = *request.mesh;
    const Topology topology = build_topology(mesh);
    const std::vector<std::uint8_t> turned = turned_cells(topology);
    const std::vector<BoundaryCell> cells = boundary_cells(topology);
    if (cells.empty()) return {};
    const std::size_t side_quads = std::size_t{1} << (2 * request.refine.levels);
    std::vector<VoxelTriangle> triangles(2 * side_quads * (cells.back().first + cells.back().sides.size()));
    const auto place = [&](const BoundaryCell& cell, std::size_t k) { return &triangles[2 * side_quads * (cell.first + k)]; };
    if (!request.refines()) {
        for (const BoundaryCell& cell : cells) {
            for (std::size_t k = 0; k < cell.sides.size(); ++k) {
                const auto ids = corners_of_side(topology, cell.cell, cell.sides[k]);
                Quad quad;
                for (std::size_t c = 0; c < 4; ++c) quad[c] = request.to_voxels(mesh.points[ids[c]]);
                const auto start = static_cast<std::size_t>(std::ranges::min_element(ids) - ids.begin());
                put(quad, start, turned[cell.cell], place(cell, k));
            }
        }
        return triangles;
    }
    std::vector<Index> numbers;
    std::vector<std::size_t> slots(mesh.cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        numbers.push_back(cells[i].cell);
        slots[cells[i].cell] = i;
    }
    CellRequest without_fields = request;
    without_fields.fields.clear();
    // Unless the scheme interpolates, the limit of one vertex, computed at two levels, differs in its last bits.
    const bool as_tables = request.tables || !interpolates(request.refine.scheme.kind);
    const int levels = as_tables ? request.levels() : request.refine.levels;
    RefinedCells(without_fields).for_each(numbers, levels, [&](const DenseCell& dense) {
        const BoundaryCell& cell = cells[slots[dense.cell]];
        for (std::size_t k = 0; k < cell.sides.size(); ++k) {
            put_side(dense, cell.sides[k], std::ptrdiff_t{1} << request.refine.levels, request.to_voxels, turned[cell.cell],
                     place(cell, k));
        }
    });
    return triangles;
}

}  // namespace subvol::detail
