// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// Sets of edges that have to be split alike: opposite edges of a cell, through all cells that follow each other.
class EdgeClasses {
public:
    explicit EdgeClasses(std::span<const std::array<Index, 8>> cells);

    /// The number of edges.
    [[nodiscard]] std::size_t size() const { return keys_.size(); }
    /// The number of edge e of a cell, one of those given.
    [[nodiscard]] std::size_t edge(const std::array<Index, 8>& cell, std::size_t e) const;
    /// The first edge of the set that an edge belongs to.
    [[nodiscard]] std::size_t class_of(std::size_t edge) const;

private:
    void join(std::size_t a, std::size_t b);

    std::vector<std::array<Index, 2>> keys_;  // the points of each edge, sorted
    std::vector<std::size_t> parents_;
};

/// How far a straight line is from the curve at most, if a direction of a cell is not split: in parts of the mesh's size, and
/// of the fields' ranges. The distance falls with the square of the number of pieces.
struct CellBend {
    std::array<float, 3> shape{}, fields{};
    std::array<std::uint8_t, 3> degrees{1, 1, 1};  ///< degrees of the polynomials along each direction
};

/// The error of a field along a direction in n pieces, if it is `bend` in one piece of a polynomial of this degree.
[[nodiscard]] double fields_error(double bend, std::size_t degree, std::size_t n);

/// Into how many pieces the directions of curved cells are split.
struct CurvedPieces {
    std::vector<std::array<std::size_t, 3>> class_of;  ///< for each cell the classes of its three directions
    std::vector<std::size_t> of_class;                 ///< the pieces of each class of edges
    std::size_t hexes = 0;                             ///< the hexahedra that all cells become
    std::size_t most_hexes = 0;
    bool limited = false;  ///< whether there would have been more than most_hexes for the tolerance

    [[nodiscard]] std::array<std::size_t, 3> of_cell(std::size_t c) const {
        return {of_class[class_of[c][0]], of_class[class_of[c][1]], of_class[class_of[c][2]]};
    }
};

/// Chooses the pieces of each class of edges so that shape and fields are within their tolerances, all alike in a class, as the
/// cell that needs it most. Pieces are added one by one where the error is the largest part of its tolerance, until all errors
/// are within their tolerances or the next piece would make too many hexahedra. So a smaller tolerance only adds pieces.
///
/// bends:      of the cells
/// tolerance:  of the shape, in parts of the mesh's size; greater than 0. That of the fields is 400 times as large
/// most_hexes: at least the number of cells
[[nodiscard]] CurvedPieces choose_pieces(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges,
                                         std::span<const CellBend> bends, double tolerance, std::size_t most_hexes);

/// The numbers of the points of cells that are split into grids, so that neighbours share the points where they meet: first
/// the corners, then the points on edges, then those on the faces and inside of one cell after the other.
class SplitGrids {
public:
    /// cells:       with 8 different corners each
    /// pieces:      of each class of edges
    /// point_count: of the cells that are split
    SplitGrids(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges, std::span<const std::size_t> pieces,
               std::size_t point_count);

    /// kNone or more: then there are too many, and no grids.
    [[nodiscard]] std::size_t point_count() const { return point_count_; }

    /// The pieces of a cell along its three directions.
    [[nodiscard]] std::array<std::size_t, 3> pieces_of(std::size_t cell) const;

    /// The points of a cell, the first direction fastest.
    [[nodiscard]] std::vector<Index> grid_of(std::size_t cell) const;

private:
    std::span<const std::array<Index, 8>> cells_;
    const EdgeClasses& edges_;
    std::span<const std::size_t> pieces_;
    std::vector<Index> corners_;
    std::vector<std::size_t> edge_starts_, cell_starts_;
    std::map<std::array<Index, 4>, std::size_t> face_starts_;
    std::size_t point_count_ = 0;
};

}  // namespace subvol::detail
