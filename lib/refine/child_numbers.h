// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child_topology.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The two sides of a cell that meet at each of its edges.
constexpr std::array<std::array<std::uint8_t, 2>, 12> make_edge_sides() {
    std::array<std::array<std::uint8_t, 2>, 12> sides{};
    for (std::size_t k = 0; k < 12; ++k) {
        std::size_t count = 0;
        for (std::size_t s = 0; s < 6; ++s) {
            int corners = 0;
            for (const int c : kCellFaces[s]) corners += c == kCellEdges[k][0] || c == kCellEdges[k][1];
            if (corners == 2) sides[k][count++] = static_cast<std::uint8_t>(s);
        }
    }
    return sides;
}

inline constexpr auto kEdgeSides = make_edge_sides();

/// The numbers that the edges and faces of a child have in the order of their point ids, told from the parent.
///
/// A child edge joins an old point and an edge point, an edge point and a face point, or a face point and a cell point; a child
/// face lies in a parent face at one of its corners, or in a cell at one of its edges. In the order of their points they stand
/// old point by old point, edge by edge, face by face.
struct ChildNumbers {
    explicit ChildNumbers(const Topology& parent);

    const Topology& parent;
    ChildNumbering first;
    std::size_t edge_b, edge_c, face_e;        // where edges from edge points, from face points, faces in cells start
    FlatArray<Index> sorted_faces;             // parent.edge_faces, ascending
    std::vector<Index> face_cell_offsets;      // how many cells the faces before this one have
    std::vector<Index> corner_offsets;         // how many faces the points before this one have
    FlatArray<std::array<Index, 2>> at_ends;   // edges at the ends of an edge
    FlatArray<std::array<Index, 4>> to_face;   // edges from the edges of a face to its point
    FlatArray<std::array<Index, 6>> to_cell;   // edges from the sides of a cell to its point
    FlatArray<std::array<Index, 4>> quarters;  // faces at the corners of a face
    FlatArray<std::array<Index, 12>> inner;    // faces at the edges of a cell

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

/// Fills edge_faces and edge_cells of a child that has all else: about half an edge as about the whole, four elsewhere inside.
void fill_child_rings(const ChildNumbers& numbers, Topology& child);

}  // namespace subvol::detail
