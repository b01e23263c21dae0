// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// Where the points of the four kinds start in the child's numbering: old points, then one point per edge, per face, per cell.
struct ChildNumbering {
    explicit ChildNumbering(const Topology& t)
        : edges(t.point_count), faces(edges + t.edges.size()), cells(faces + t.faces.size()), end(cells + t.cells.size()) {}
    std::size_t edges, faces, cells, end;
};

/// How many entities of each kind a mesh has.
struct EntityCounts {
    std::size_t points, edges, faces, cells;
};

/// The numbers of a child's entities, from those of its parent.
[[nodiscard]] constexpr EntityCounts child_counts(const EntityCounts& parent) {
    return {parent.points + parent.edges + parent.faces + parent.cells, 2 * parent.edges + 4 * parent.faces + 6 * parent.cells,
            4 * parent.faces + 12 * parent.cells, 8 * parent.cells};
}

/// throws: Error(InvalidInput) if the child of a mesh with these numbers has more entities of a kind than an Index can count
void check_child(const EntityCounts& parent);

/// A place in the 3×3×3 lattice of a refined cell: one of its corners, edges or faces, or its centre.
struct LatticePlace {
    enum Kind : std::uint8_t { Corner, Edge, Face, Cell } kind = Cell;
    std::uint8_t number = 0;
};

/// The place of corner `corner` of child `child`.
[[nodiscard]] LatticePlace lattice_place(std::size_t child, std::size_t corner);

/// The cells of the child: 8c + k lies at corner k of cell c and has its orientation.
[[nodiscard]] std::vector<std::array<Index, 8>> child_cells(const Topology& parent);
[[nodiscard]] constexpr Index child_cell(std::size_t c, std::size_t k) {
    return static_cast<Index>(8 * c + k);
}

/// The 27 points of a refined cell, u fastest, in the child's numbering.
[[nodiscard]] std::array<Index, 27> lattice_points(const Topology& parent, Index cell);

/// The eight cells that 27 lattice points make.
[[nodiscard]] std::array<std::array<Index, 8>, 8> split_lattice(const std::array<Index, 27>& points);

/// The tags of the child: both halves of a crease, the four quarters of a sharp face.
[[nodiscard]] std::vector<std::array<Index, 2>> child_creases(const Topology& parent);
[[nodiscard]] std::vector<std::array<Index, 4>> child_sharp_faces(const Topology& parent);

/// The topology of the child in the numbering of `refine`, derived from its parent's without sorting: the same as
/// `build_topology` of the child mesh.
///
/// cost: parallel, O(n)
[[nodiscard]] Topology child_topology(const Topology& parent);

}  // namespace subvol::detail
