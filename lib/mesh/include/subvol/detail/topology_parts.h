// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "subvol/topology.h"

namespace subvol::detail {

/// Fills faces, face_cells and cell_faces of a topology that has its cells and point_count.
///
/// throws: Error(InvalidInput) if more than two cells share a face, or two cells have the same corners
void build_faces(Topology& topology);

/// The quad of a cell's side, counter-clockwise seen from outside, its smallest id first.
[[nodiscard]] std::array<Index, 4> outward_quad(const std::array<Index, 8>& cell, std::size_t side);

/// The outward quads of the faces that one cell has, in the order of the faces of a topology, without building one.
///
/// where:  chooses among all faces, by their points in any order; called in parallel
/// throws: Error(InvalidInput) if more than two cells share a face that is chosen
[[nodiscard]] std::vector<std::array<Index, 4>> hull_quads(
    const HexMesh& mesh, const std::function<bool(const std::array<Index, 4>&)>& where = [](const auto&) { return true; });

/// throws: Error(InvalidInput) if there are more entities of a kind than an Index can count. kind: "faces"
void check_count(std::size_t count, std::string_view kind);

/// Puts the faces of every edge into ring order and fills edge_cells and edge_has_ring.
void order_edge_rings(Topology& topology);

/// Walks the faces of one edge (ascending) from cell to cell: fans from hull face to hull face, then closed rings.
///
/// returns: the number of closed rings
int walk_edge_ring(const Topology& topology, std::span<const Index> edge_faces, std::vector<Index>& ring_faces,
                   std::vector<Index>& ring_cells);

/// What to do with tagged creases that are not on the boundary. In a whole mesh they are refused. In a part of a mesh, a crease
/// is off the boundary where the cells that put it there are cut off: only among the outermost cells of the part, whose rules
/// are not evaluated. There it is ignored.
enum class InteriorCreases { Refuse, Ignore };

[[nodiscard]] Topology build_topology(const HexMesh& mesh, InteriorCreases interior);

}  // namespace subvol::detail
