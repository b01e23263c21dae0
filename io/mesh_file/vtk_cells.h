// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh_file.h"
#include "polyhedra.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// VTK counts from 0.
inline constexpr EntityNames kVtkNames{"point", "cell", 0};

inline constexpr std::int64_t kVtkPolyhedron = 42;

/// The faces of a polyhedron as VTK lists them: how many there are, then of each its number of points and the points.
///
/// first_point: is added to each; points: their number
/// returns: nothing if the list is not such a one, or names a point that is not there
[[nodiscard]] std::optional<CellFaces> faces_of_stream(std::span<const std::int64_t> stream, std::size_t first_point,
                                                       std::size_t points);

/// The faces of the polyhedra of a piece, in VTK's lists of two generations: for each cell all its faces, one after the other;
/// or faces with numbers, and the numbers of each cell, if there are `number_ends`.
struct VtkFaces {
    std::vector<std::int64_t> stream;
    std::vector<std::int64_t> ends;  ///< end of each cell in `stream`; that of the cell before for other cells
    std::vector<std::int64_t> points, point_ends, numbers, number_ends;

    /// The faces of a cell; first_point, point_count and the result as for `faces_of_stream`
    [[nodiscard]] std::optional<CellFaces> of_cell(std::size_t cell, std::size_t first_point, std::size_t point_count) const;
};

/// Sorts the cells of a VTK file into the kinds of cells that are read, and those that are left out.
class VtkCellSorter {
public:
    VtkCellSorter(const TextScanner& in, MeshFile& found, const ReadOptions& options)
        : in_(in), found_(found), options_(options) {}

    /// Adds the next cell.
    ///
    /// corners:  numbered through all pieces of the file
    /// position: of the cell in the text
    void take(std::int64_t type, std::span<const Index> corners, std::size_t position);

    /// Adds the next cell, a polyhedron. faces: as in `take`
    void take_polyhedron(CellFaces&& faces);

    /// The file is of a version in which Lagrange and Bézier hexahedra have VTK 8's order of nodes.
    void set_old_order() { old_order_ = true; }

    /// To be called after the last cell and the last array: splits polyhedra, and appends warnings about cells that were left
    /// out or read as another kind.
    ///
    /// file: refused if it has no cells that are taken; nothing: that is allowed, and quads and lines are left out
    void report(std::optional<std::string_view> file);

private:
    /// Makes polyhedra of the hulls of convex point sets, which need the points of the file.
    void take_point_sets();
    /// Counts all quads and lines as left out: parts of a mesh have no shells.
    void take_no_shells();
    /// Keeps all nodes of a curved hexahedron. returns: whether its shape is known
    bool keep_curved(std::int64_t type, std::span<const Index> nodes);
    /// Adds the cell to `into`, with its first N corners. curved: it may have more points
    template <std::size_t N>
    void take_as(FileCells<N>& into, std::span<const Index> corners, std::size_t position, std::string_view kind, bool curved);

    const TextScanner& in_;
    MeshFile& found_;
    ReadOptions options_;
    std::size_t next_ = 0;  // the number of the cell that comes next
    std::size_t mislabelled_ = 0;
    bool old_order_ = false;
    std::size_t curved_ = 0;  // cells of which only the corners are used
    std::map<std::int64_t, std::size_t> left_out_;
    Polyhedra polyhedra_;
    std::vector<std::pair<std::size_t, std::vector<Index>>> point_sets_;  // convex ones, with the numbers of their cells
};

}  // namespace subvol::detail
