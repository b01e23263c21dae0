// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "mesh_file.h"

namespace subvol::detail {

/// The faces of a cell, each a cycle of points.
using CellFaces = std::vector<std::vector<Index>>;

/// Takes cells by their faces: as the hexahedra, prisms, pyramids and tetrahedra that these make them. Others are split from a
/// new point in their middle into tetrahedra. Both cells of a face cut it alike: into triangles from its smallest point, as the
/// quads of other cells are cut.
///
/// found: has the points of all cells, and its arrays are not longer than these when `add` is called
class PolyhedronTaker {
public:
    /// ignore_others: only hexahedra are taken
    PolyhedronTaker(MeshFile& found, bool ignore_others) : found_(found), ignore_others_(ignore_others) {}

    /// faces: their normals point out of the cell; see `orient_faces`. Changed
    void add(Index number, CellFaces& faces);

    /// Returns how many cells `add` left out, as they are not hexahedra and others are ignored.
    [[nodiscard]] std::size_t left_out() const { return left_out_; }
    /// After the last cell: appends a warning that counts the cells that were split.
    void report();

private:
    bool take(const CellFaces& faces);
    void split(CellFaces& faces);
    template <std::size_t N>
    bool put(FileCells<N>& into, const std::array<Index, N>* corners);

    MeshFile& found_;
    bool ignore_others_;
    std::vector<Index> points_;  // of the cell at hand
    Index number_ = 0;
    std::size_t polyhedra_ = 0, tets_ = 0, left_out_ = 0, folded_ = 0;
};

/// Cells by their faces that wait until all points and arrays of a file are there.
class Polyhedra {
public:
    /// faces: in any orientation
    void add(std::size_t number, CellFaces&& faces) { cells_.emplace_back(static_cast<Index>(number), std::move(faces)); }

    /// Takes them into `found` as PolyhedronTaker does, with warnings. Cells whose faces do not enclose a volume are left out.
    /// Returns how many are left out because others than hexahedra are ignored.
    std::size_t take_into(MeshFile& found, bool ignore_others);

private:
    std::vector<std::pair<Index, CellFaces>> cells_;  // with their numbers
};

/// The faces of the convex hull of up to 64 different points, each with all points in its plane, in no orientation. Points are
/// in a plane that they miss by up to a thousandth of the hull's size. Empty if the points are in one plane, or if one of them
/// is not a corner of the hull.
[[nodiscard]] CellFaces hull_faces(const std::vector<Index>& corners, const std::vector<Vec3>& points);

/// Turns the faces of a closed cell so that their normals point out of it. Faces that repeat points or do not close the cell
/// stay as they are.
void orient_faces(CellFaces& faces, const std::vector<Vec3>& points);

/// Whether each edge of the faces belongs to two of them, and each face has three different points or more.
[[nodiscard]] bool is_closed(const CellFaces& faces);

}  // namespace subvol::detail
