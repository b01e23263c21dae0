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
struct SurfacePoint {
    VertexNumber a, b;                               ///< ends of the edge, a < b; a vertex: twice the same
    Index cell;                                      ///< one of the control cells that have it
    std::array<std::array<std::uint16_t, 3>, 2> at;  ///< places of the ends in that cell, in steps of the grid
    std::array<double, 2> off;                       ///< at the ends, the value less the isovalue
    std::uint8_t side = 6;                           ///< a face of the hull that it lies on (kCellFaces); 6: none
};

/// The triangles in one control cell.
struct CellTriangles {
    std::vector<SurfacePoint> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< by the numbers of the points
    std::vector<std::uint8_t> hull;                       ///< whether a triangle is part of the hull
};

/// What is cut out of cells.
struct Cut {
    std::optional<double> iso{};  ///< nothing: the hull alone
    bool hull = false;            ///< for an isosurface the part of the hull where values are at least the isovalue
};

/// Cuts the tetrahedra (`split_cell`) of all children of a control cell.
///
/// grid: of `numbers`' level; values: one number for each of its vertices. Without an isovalue nothing but its side is used
[[nodiscard]] CellTriangles cut_cell(const DenseCell& grid, std::span<const double> values, const Cut& cut,
                                     const Topology& topology, const GridNumbers& numbers);

/// Triangles whose corners are points on edges, before and after these have been moved to the limit.
struct SurfaceSoup {
    std::vector<SurfacePoint> points;             ///< in the order of their ends
    std::vector<std::array<Index, 3>> triangles;  ///< cell by cell
    std::vector<std::uint8_t> hull;               ///< for each triangle, whether it is part of the hull
    std::vector<Index> cells;                     ///< cells with triangles, ascending
    std::vector<std::size_t> ends;                ///< for each of these cells, where its triangles end
    bool leads_out = false;                       ///< the surface goes on in a cell that may not be cut
};

/// How far a surface is followed from the cells that are given.
struct SurfaceReach {
    bool follow = true;                 ///< the surface is followed into the neighbours that it leads to
    std::span<const Index> not_into{};  ///< the surface is not followed into these: they are cut elsewhere
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
