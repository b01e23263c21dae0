// SPDX-License-Identifier: Apache-2.0
// The boundary of the filled cells as triangles in voxels, without gaps. First a flood over shared faces finds the cells whose
// corners have the opposite order to those of their part's first cell; their triangles are turned. Then the sides on which the
// filled cells end are listed, each with 4^L quads at level L, and each quad is cut into two triangles at its lowest corner:
//
//     unrefined       by the smallest point number
//     refined         nodes of the dense grid, by position
//     curved pieces   nodes of the triquadratic pieces, by position; a point on an edge or corner comes from the first of the
//                     cells that share it, so that both sides get the same bits, even between pieces of different levels
//
// These rules are those by which the fill cuts cells, so that the surface bounds its tetrahedra exactly.
#include "boundary_triangles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "fill_block.h"
#include "refined_grids.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

using Quad = std::array<Vec3, 4>;

/// The corners of a side of a cell, in the order of `kCellFaces`.
std::array<Index, 4> corners_of_side(const Topology& topology, Index cell, std::size_t side) {
    std::array<Index, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = topology.cells[cell][kCellFaces[side][k]];
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
    std::atomic<bool> any{false};  // mostly no two neighbours differ, which all threads can find out together
    parallel_each(topology.faces.size(), [&](std::size_t f) {
        const auto& [low, high] = topology.face_cells[f];
        if (high == kNone) return;
        const auto corners = [&](Index cell) {
            const auto& sides = topology.cell_faces[cell];
            const auto side = std::ranges::find(sides, static_cast<Index>(f)) - sides.begin();
            return corners_of_side(topology, cell, static_cast<std::size_t>(side));
        };
        if (same_direction(corners(low), corners(high))) any.store(true, std::memory_order_relaxed);
    });
    if (!any) return turned;
    std::vector<Index> open;
    for (Index start = 0; start < topology.cells.size(); ++start) {
        if (seen[start]) continue;
        seen[start] = 1;
        open.push_back(start);
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

std::vector<BoundaryCell> boundary_cells(const CellRequest& request, const Topology& topology,
                                         const std::function<bool(Index cell)>& wanted) {
    std::vector<BoundaryCell> cells;
    std::size_t first = 0;
    for (Index c = 0; c < topology.cells.size(); ++c) {
        if (!request.fills(c) || (wanted && !wanted(c))) continue;
        BoundaryCell cell{c, first, {}};
        for (std::size_t side = 0; side < 6; ++side) {
            if (request.ends_at(topology.face_cells[topology.cell_faces[c][side]])) cell.sides.push_back(side);
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

/// The steps² quads of one side of a cell. point: by u, v, w in parts 1/steps
template <class PointAt>
void put_quads(std::size_t side, int steps, bool turned, const PointAt& point, VoxelTriangle* out) {
    using LatticePoint = std::array<int, 3>;
    const auto corner = [&](std::size_t k) {
        LatticePoint at;
        for (std::size_t d = 0; d < 3; ++d) at[d] = steps * kCornerParameters[kCellFaces[side][k]][d];
        return at;
    };
    const LatticePoint start = corner(0), next = corner(1), last = corner(3);
    const auto across = static_cast<std::size_t>(steps) + 1;
    std::vector<Vec3> points;
    points.reserve(across * across);
    for (int i = 0; i <= steps; ++i) {
        for (int j = 0; j <= steps; ++j) {
            LatticePoint at;
            for (std::size_t d = 0; d < 3; ++d) {
                at[d] = start[d] + (next[d] - start[d]) / steps * i + (last[d] - start[d]) / steps * j;
            }
            points.push_back(point(at));
        }
    }
    for (std::size_t i = 0; i + 1 < across; ++i) {
        for (std::size_t j = 0; j + 1 < across; ++j, out += 2) {
            const std::size_t n = i * across + j;
            const Quad quad{points[n], points[n + across], points[n + across + 1], points[n + 1]};
            put(quad, lowest_corner(quad), turned, out);
        }
    }
}

/// Points on the boundary of curved pieces. A point that several cells share is taken from the first of them, so that the
/// surface has no gaps, even where pieces of different levels meet.
class PieceSurface {
public:
    PieceSurface(const CellRequest& request, const Topology& topology, int levels)
        : request_(request), topology_(topology), levels_(levels) {
        const std::vector<Index>& cells = request.pieces->cells;
        first_.resize(topology.cells.size() + 1);
        for (Index c = 0; c < first_.size(); ++c) {
            first_[c] = static_cast<std::size_t>(std::ranges::lower_bound(cells, c) - cells.begin());
        }
        points_.assign(topology.point_count, kNone);
        edges_.assign(topology.edges.size(), kNone);
        for (Index f = 0; f < topology.faces.size(); ++f) {
            if (!request.ends_at(topology.face_cells[f])) continue;
            const Index cell = topology.face_cells[f][request.fills(topology.face_cells[f][0]) ? 0 : 1];
            for (const Index p : topology.faces[f]) points_[p] = std::min(points_[p], cell);
            for (const Index e : topology.face_edges[f]) edges_[e] = std::min(edges_[e], cell);
        }
    }

    /// at: u, v, w in parts 2^-levels, on the boundary
    [[nodiscard]] Vec3 point(Index cell, const std::array<int, 3>& at) const {
        const int steps = 1 << levels_;
        const auto inside = std::ranges::count_if(at, [&](int x) { return x > 0 && x < steps; });
        if (inside > 1) return evaluate(cell, at);
        std::array<int, 3> low = at;  // the ends of the edge, or twice the corner
        std::array<int, 3> high = at;
        int along = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            if (at[d] == 0 || at[d] == steps) continue;
            along = at[d];
            low[d] = 0;
            high[d] = steps;
        }
        const auto corner_of = [&](const std::array<int, 3>& place) {
            std::size_t octant = 0;
            for (std::size_t d = 0; d < 3; ++d) octant |= (place[d] > 0 ? std::size_t{1} : 0) << d;
            return topology_.cells[cell][kCornerOctants[octant]];
        };
        const Index a = corner_of(low), b = corner_of(high);
        const Index owner = a == b ? points_[a] : edges_[*topology_.find_edge(a, b)];
        const std::array<int, 3> from = place_of(owner, a), to = place_of(owner, b);
        std::array<int, 3> there;
        for (std::size_t d = 0; d < 3; ++d) there[d] = from[d] == to[d] ? from[d] : from[d] < to[d] ? along : steps - along;
        return evaluate(owner, there);
    }

private:
    /// Where a corner lies in a cell.
    [[nodiscard]] std::array<int, 3> place_of(Index cell, Index point) const {
        const auto& corners = topology_.cells[cell];
        const auto k = static_cast<std::size_t>(std::ranges::find(corners, point) - corners.begin());
        std::array<int, 3> at;
        for (std::size_t d = 0; d < 3; ++d) at[d] = kCornerParameters[k][d] << levels_;
        return at;
    }

    [[nodiscard]] Vec3 evaluate(Index cell, const std::array<int, 3>& at) const {
        const LimitPieces& pieces = *request_.pieces;
        std::array<double, 3> t{};
        std::size_t piece = first_[cell];
        for (; piece < first_[cell + 1]; ++piece) {
            bool contains = true;
            for (std::size_t d = 0; d < 3 && contains; ++d) {
                t[d] = std::ldexp(static_cast<double>(at[d]), pieces.levels[piece] - levels_) - pieces.lowest[piece][d];
                contains = t[d] >= 0 && t[d] <= 1;
            }
            if (contains) break;
        }
        std::array<std::array<double, 3>, 3> weights;
        for (std::size_t d = 0; d < 3; ++d) {
            weights[d] = {(1 - t[d]) * (1 - 2 * t[d]), 4 * t[d] * (1 - t[d]), t[d] * (2 * t[d] - 1)};
        }
        Vec3 sum(0.0);
        for (std::size_t n = 0; n < kCurvedNodes; ++n) {
            sum += weights[0][n % 3] * weights[1][n / 3 % 3] * weights[2][n / 9] * pieces.position(piece, n);
        }
        return request_.to_voxels(sum);
    }

    const CellRequest& request_;
    const Topology& topology_;
    int levels_;
    std::vector<std::size_t> first_;     // piece of each cell
    std::vector<Index> points_, edges_;  // the first cell with a hull face there
};

}  // namespace

std::vector<VoxelTriangle> boundary_triangles(const CellRequest& request, const std::function<bool(Index cell)>& wanted) {
    const HexMesh& mesh = *request.mesh;
    const Topology topology = build_topology(mesh);
    const std::vector<std::uint8_t> turned = turned_cells(topology);
    const std::vector<BoundaryCell> cells = boundary_cells(request, topology, wanted);
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
    const int steps = 1 << request.refine.levels;
    if (request.pieces) {
        const PieceSurface surface(request, topology, request.refine.levels);
        tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            const BoundaryCell& cell = cells[i];
            for (std::size_t k = 0; k < cell.sides.size(); ++k) {
                put_quads(
                    cell.sides[k], steps, turned[cell.cell],
                    [&](const std::array<int, 3>& at) { return surface.point(cell.cell, at); }, place(cell, k));
            }
        });
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
    RefinedGrids(without_fields).for_each(numbers, levels, [&](const DenseCell& dense) {
        const BoundaryCell& cell = cells[slots[dense.cell]];
        for (std::size_t k = 0; k < cell.sides.size(); ++k) {
            const auto stride = (static_cast<int>(dense.side) - 1) / steps;
            put_quads(
                cell.sides[k], steps, turned[cell.cell],
                [&](const std::array<int, 3>& at) {
                    std::size_t node = 0;
                    for (std::size_t d = 3; d-- > 0;) node = node * dense.side + static_cast<std::size_t>(at[d] * stride);
                    return request.to_voxels(dense.points[node]);
                },
                place(cell, k));
        }
    });
    return triangles;
}

}  // namespace subvol::detail
