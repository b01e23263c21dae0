// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "subvol/dense_cells.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The number of a vertex of the refined mesh: the same in all cells that share the vertex.
using VertexNumber = std::uint64_t;

/// Numbers of the vertices of a mesh after `level` refinements, without refining it: those of the control points, then those on
/// edges, on faces, and inside cells.
class GridNumbers {
public:
    /// topology: kept by reference
    GridNumbers(const Topology& topology, int level);

    /// Sets the cell whose vertices are asked for.
    class Cell {
    public:
        Cell(const GridNumbers& numbers, Index cell);
        /// ijk: 0 to 2^level
        [[nodiscard]] VertexNumber operator()(std::size_t i, std::size_t j, std::size_t k) const;

    private:
        const GridNumbers& numbers_;
        Index cell_;
        std::array<bool, 12> reversed_{};
        // For the first and the second axis of each face: which of the cell's axes it is, and whether it is reversed.
        struct FaceAxes {
            std::array<std::size_t, 2> axis;
            std::array<bool, 2> reversed;
        };
        std::array<FaceAxes, 6> faces_{};
    };

private:
    const Topology& topology_;
    std::uint64_t side_;  // intervals along an edge
    VertexNumber first_edge_, first_face_, first_cell_;
};

/// Where a surface crosses an edge of the tetrahedra, or a vertex of the grid that is part of a surface.
///
/// a, b:   the ends of the edge, a < b; a vertex: twice the same
/// cell:   one of the control cells that have it; at: of the ends in that cell, in steps of the grid
/// off:    at the ends, the value less the isovalue
/// side:   a face of the hull that it lies on (kCellFaces); 6: none
struct SurfacePoint {
    VertexNumber a, b;
    Index cell;
    std::array<std::array<std::uint16_t, 3>, 2> at;
    std::array<double, 2> off;
    std::uint8_t side = 6;
};

/// The triangles in one control cell. triangles: by the numbers of the points; hull: whether a triangle is part of the hull
struct CellTriangles {
    std::vector<SurfacePoint> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint8_t> hull;
};

/// What is cut out of cells. iso: nothing: the hull alone; hull: of an isosurface the part of the hull where values are at
/// least the isovalue
struct Cut {
    std::optional<double> iso{};
    bool hull = false;
};

/// Cuts the tetrahedra (`split_cell`) of all children of a control cell.
///
/// grid: of `numbers`' level; values: one number for each of its vertices. Without an isovalue nothing but its side is used
[[nodiscard]] CellTriangles cut_cell(const DenseCell& grid, std::span<const double> values, const Cut& cut,
                                     const Topology& topology, const GridNumbers& numbers);

/// Triangles whose corners are points on edges, before and after these have been moved to the limit.
///
/// points:    in the order of their ends
/// triangles: cell by cell; hull: of each, whether it is part of the hull
/// cells:     those with triangles, ascending; ends: of each, where its triangles end
/// leads_out: the surface goes on in a cell that may not be cut
struct SurfaceSoup {
    std::vector<SurfacePoint> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::uint8_t> hull;
    std::vector<Index> cells;
    std::vector<std::size_t> ends;
    bool leads_out = false;
};

/// How far a surface is followed from the cells that are given.
///
/// follow:   into the neighbours that it leads to
/// not_into: but not into these: they are cut elsewhere
struct SurfaceReach {
    bool follow = true;
    std::span<const Index> not_into{};
};

/// Cuts a surface out of the cells of a mesh at some level, where it passes.
class SoupCutter {
public:
    /// mesh:  its first attribute is the field; without one, only hulls can be cut. It and the topology are kept by reference
    /// owned: a flag for each cell that may be cut; empty: all
    SoupCutter(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> owned, const SchemeOptions& scheme,
               Progress* progress)
        : mesh_(mesh), topology_(topology), owned_(owned), scheme_(scheme), progress_(progress) {}

    /// cells: without repetition
    [[nodiscard]] SurfaceSoup cut(const Cut& cut, int level, std::vector<Index> cells, const SurfaceReach& reach = {}) const;

    /// The cells through which the surface may pass, by the values at the vertices of level 1.
    [[nodiscard]] std::vector<Index> candidates(const Cut& cut) const;

private:
    [[nodiscard]] bool may_cut(Index cell) const { return owned_.empty() || owned_[cell] != 0; }
    [[nodiscard]] bool has_hull(Index cell) const;
    [[nodiscard]] std::vector<Index> near_isovalue(const Cut& cut) const;
    [[nodiscard]] std::vector<Index> reached(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                                             std::size_t last, const std::vector<Index>& slots, int level) const;
    void add_neighbors(Index cell, std::size_t side, const std::vector<Index>& slots, std::vector<Index>& found) const;

    const HexMesh& mesh_;
    const Topology& topology_;
    std::span<const std::uint8_t> owned_;
    SchemeOptions scheme_;
    Progress* progress_;
};

}  // namespace subvol::detail
