// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/detail/child_topology.h"
#include "subvol/topology.h"

namespace subvol::detail {

// The numbers of a child's edges and faces, counted instead of sorted.
//
//    ●─ a ─○─ a ─●      A face of the parent after one refinement: old points ●, edge points ○ and the face point □.
//    │     │     │      Its children and those of its cells:
//    a  d  b  d  a        edges  a  from an old point to an edge point     two per parent edge
//    │     │     │               b  from an edge point to a face point     four per parent face
//    ○─ b ─□─ b ─○               c  from a face point to a cell point      six per parent cell
//    │     │     │        faces  d  a quarter of a parent face             four per parent face
//    a  d  b  d  a               e  in a cell, at one of its edges         twelve per parent cell
//    │     │     │
//    ●─ a ─○─ a ─●
//
// `build_topology` numbers edges and faces in the order of their smallest points, and the child's points are numbered kind by
// kind. So the edges a come first, old point by old point, then the edges b, edge by edge, then the edges c, face by face. The
// faces d come before the faces e for the same reason. At one point the order follows from the parent's numbers.

/// The two sides of a cell that meet at each of its edges.
constexpr std::array<std::array<std::uint8_t, 2>, 12> make_edge_sides() {
    std::array<std::array<std::uint8_t, 2>, 12> sides{};
    for (std::size_t k = 0; k < 12; ++k) {
        std::size_t count = 0;
        for (std::size_t s = 0; s < 6; ++s) {
            int corners = 0;
            for (const std::size_t c : kCellFaces[s]) corners += c == kCellEdges[k][0] || c == kCellEdges[k][1];
            if (corners == 2) sides[k][count++] = static_cast<std::uint8_t>(s);
        }
    }
    return sides;
}

inline constexpr auto kEdgeSides = make_edge_sides();

/// The number of each child edge and child face, by the entity of the parent that it lies in.
struct ChildNumbers {
    explicit ChildNumbers(const Topology& parent);

    const Topology& parent;
    ChildNumbering first;
    std::size_t edge_b, edge_c, face_e;        // the first numbers of the kinds b, c and e
    FlatArray<Index> sorted_faces;             // parent.edge_faces, ascending
    std::vector<Index> face_cell_offsets;      // how many cells the faces before this one have
    std::vector<Index> corner_offsets;         // how many faces the points before this one have
    FlatArray<std::array<Index, 2>> at_ends;   // edges a of an edge, by its ends
    FlatArray<std::array<Index, 4>> to_face;   // edges b of a face, by its edges
    FlatArray<std::array<Index, 6>> to_cell;   // edges c of a cell, by its sides
    FlatArray<std::array<Index, 4>> quarters;  // faces d of a face, by its corners
    FlatArray<std::array<Index, 12>> inner;    // faces e of a cell, by its edges

    [[nodiscard]] std::size_t edge_count() const { return edge_c + face_cell_offsets.back(); }
    [[nodiscard]] std::size_t face_count() const { return face_e + 12 * parent.cells.size(); }

private:
    [[nodiscard]] std::array<Index, 2> cells_by_rank(Index f) const;
    [[nodiscard]] std::span<const Index> faces_at(Index e) const;
    [[nodiscard]] Index other_edge(Index f, Index e, std::size_t v) const;
    void sort_edge_faces();
    void number_edges();
    void number_faces();
};

/// Fills edge_faces and edge_cells of a child whose other members are complete.
void fill_child_rings(const ChildNumbers& numbers, Topology& child);

}  // namespace subvol::detail
