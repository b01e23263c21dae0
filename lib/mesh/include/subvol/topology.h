// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/flat_array.h"
#include "subvol/hex_mesh.h"

namespace subvol {

/// The edges and faces of a hexahedral mesh and their incidences, as flat arrays.
///
/// Edges and faces are numbered in the order of their point ids, so their numbers do not depend on the order of the cells.
///
/// hull:     the faces with only one cell
/// boundary: the hull and the faces tagged as sharp, with their edges and points: where schemes use their surface rules
struct Topology {
    std::size_t point_count = 0;
    std::vector<std::array<Index, 8>> cells;
    /// Two point ids, smaller first; the edges with the smaller point p are edge_offsets[p] to edge_offsets[p+1]
    FlatArray<std::array<Index, 2>> edges;
    FlatArray<Index> edge_offsets;
    /// Four point ids in cyclic order, the smallest first and then the smaller of its two neighbours
    FlatArray<std::array<Index, 4>> faces;
    FlatArray<std::array<Index, 12>> cell_edges;
    FlatArray<std::array<Index, 6>> cell_faces;
    FlatArray<std::array<Index, 4>> face_edges;  ///< edge k of a face joins its points k and k+1
    FlatArray<std::array<Index, 2>> face_cells;  ///< one or two cells (smaller first); the second is kNone on the hull
    /// The faces around an edge. At an interior edge a cycle, from the smallest face to the smaller of its two neighbours and
    /// on; at a boundary edge fan by fan, each from hull face to hull face
    IndexRows edge_faces;
    /// The cells around an edge. Cell j of an interior ring lies between its faces j and j+1; at a boundary edge the cells of
    /// the fans in order
    IndexRows edge_cells;
    IndexRows point_edges;
    std::vector<std::uint8_t> edge_on_boundary;
    std::vector<std::uint8_t> point_on_boundary;
    std::vector<std::uint8_t> edge_has_ring;    ///< interior edges whose cells form one ring of at least three
    std::vector<std::uint8_t> edge_is_crease;   ///< boundary edges kept sharp: one cell, non-manifold, or tagged
    FlatArray<Index> cell_ordinal;              ///< a number for each cell that does not depend on the order of `cells`
    std::vector<std::uint8_t> face_is_sharp;    ///< a flag for each face; empty if none is tagged
    std::vector<std::array<Index, 2>> creases;  ///< the tags of the mesh, besides those that the default rule finds
    std::size_t nonmanifold_edges = 0;          ///< boundary edges with other than two boundary faces

    [[nodiscard]] bool face_on_hull(Index face) const { return face_cells[face][1] == kNone; }
    [[nodiscard]] bool face_on_boundary(Index face) const {
        return face_on_hull(face) || (!face_is_sharp.empty() && face_is_sharp[face] != 0);
    }
    [[nodiscard]] std::size_t boundary_faces_at(Index edge) const;
    [[nodiscard]] std::optional<Index> find_edge(Index a, Index b) const;
    [[nodiscard]] std::optional<Index> find_face(const std::array<Index, 4>& points) const;
};

/// Builds the topology of a mesh, in parallel; the result does not depend on the number of threads.
///
/// throws: Error(InvalidInput) if more than two cells share a face, two cells have the same corners, a crease is not a boundary
///         edge or a sharp face not a face; names them
/// cost:   O(n log n) time, about 500 bytes per cell
[[nodiscard]] Topology build_topology(const HexMesh& mesh);

/// Tags the smooth boundary edges whose two face normals differ by more than `angle_deg`. `keep_sharp_edges` has the default.
///
/// throws: Error(InvalidInput) if the angle is not in (0,180]; 180 tags none
void tag_creases(HexMesh& mesh, double angle_deg);

}  // namespace subvol
