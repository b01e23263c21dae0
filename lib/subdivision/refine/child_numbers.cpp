// SPDX-License-Identifier: Apache-2.0
#include "child_numbers.h"

#include <algorithm>

#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"

namespace subvol::detail {

ChildNumbers::ChildNumbers(const Topology& topology)
    : parent(topology),
      first(topology),
      edge_b(2 * topology.edges.size()),
      edge_c(edge_b + 4 * topology.faces.size()),
      face_e(4 * topology.faces.size()) {
    sort_edge_faces();
    number_edges();
    number_faces();
}

/// The cells of a face in the order of their cell points.
std::array<Index, 2> ChildNumbers::cells_by_rank(Index f) const {
    auto cells = parent.face_cells[f];
    if (cells[1] != kNone && parent.cell_ordinal[cells[1]] < parent.cell_ordinal[cells[0]]) std::swap(cells[0], cells[1]);
    return cells;
}

void ChildNumbers::sort_edge_faces() {
    sorted_faces = parent.edge_faces.values;
    parallel_each(parent.edges.size(), [&](std::size_t e) {
        const auto begin = sorted_faces.begin();
        std::sort(begin + static_cast<std::ptrdiff_t>(parent.edge_faces.offsets[e]),
                  begin + static_cast<std::ptrdiff_t>(parent.edge_faces.offsets[e + 1]));
    });
}

std::span<const Index> ChildNumbers::faces_at(Index e) const {
    return std::span(sorted_faces).subspan(parent.edge_faces.offsets[e], parent.edge_faces[e].size());
}

void ChildNumbers::number_edges() {
    at_ends.resize(parent.edges.size());
    parallel_each(parent.point_count, [&](std::size_t v) {
        const auto edges = parent.point_edges[v];
        for (std::size_t i = 0; i < edges.size(); ++i) {
            at_ends[edges[i]][parent.edges[edges[i]][0] == v ? 0 : 1] = static_cast<Index>(parent.point_edges.offsets[v] + i);
        }
    });
    to_face.resize(parent.faces.size());
    parallel_each(parent.edges.size(), [&](std::size_t e) {
        const auto faces = faces_at(static_cast<Index>(e));
        for (std::size_t i = 0; i < faces.size(); ++i) {
            to_face[faces[i]][slot_of(parent.face_edges[faces[i]], static_cast<Index>(e))] =
                static_cast<Index>(edge_b + parent.edge_faces.offsets[e] + i);
        }
    });
    face_cell_offsets.assign(parent.faces.size() + 1, 0);
    for (std::size_t f = 0; f < parent.faces.size(); ++f) {
        face_cell_offsets[f + 1] = face_cell_offsets[f] + (parent.face_on_hull(static_cast<Index>(f)) ? 1u : 2u);
    }
    to_cell.resize(parent.cells.size());
    parallel_each(parent.faces.size(), [&](std::size_t f) {
        const auto cells = cells_by_rank(static_cast<Index>(f));
        for (std::size_t i = 0; i < 2 && cells[i] != kNone; ++i) {
            to_cell[cells[i]][slot_of(parent.cell_faces[cells[i]], static_cast<Index>(f))] =
                static_cast<Index>(edge_c + face_cell_offsets[f] + i);
        }
    });
}

/// The other edge of a face at a point of one of its edges.
Index ChildNumbers::other_edge(Index f, Index e, std::size_t v) const {
    const std::size_t k = slot_of(parent.face_edges[f], e);
    return parent.face_edges[f][parent.faces[f][k] == v ? (k + 3) % 4 : (k + 1) % 4];
}

void ChildNumbers::number_faces() {
    corner_offsets.assign(parent.point_count + 1, 0);  // each face at a point is counted at two of the point's edges
    parallel_each(parent.point_count, [&](std::size_t v) {
        std::size_t sides = 0;
        for (const Index e : parent.point_edges[v]) sides += parent.edge_faces[e].size();
        corner_offsets[v + 1] = static_cast<Index>(sides / 2);
    });
    for (std::size_t v = 0; v < parent.point_count; ++v) corner_offsets[v + 1] += corner_offsets[v];
    quarters.resize(parent.faces.size());
    parallel_each(parent.point_count, [&](std::size_t v) {
        Index next = corner_offsets[v];
        for (const Index e : parent.point_edges[v]) {
            for (const Index f : faces_at(e)) {
                if (e < other_edge(f, e, v)) quarters[f][slot_of(parent.faces[f], static_cast<Index>(v))] = next++;
            }
        }
    });
    inner.resize(parent.cells.size());
    parallel_each(parent.edges.size(), [&](std::size_t e) {
        auto next = static_cast<Index>(face_e + parent.edge_cells.offsets[e]);
        for (const Index f : faces_at(static_cast<Index>(e))) {
            for (const Index c : cells_by_rank(f)) {
                if (c == kNone) continue;
                const std::size_t k = slot_of(parent.cell_edges[c], static_cast<Index>(e));
                const auto& [s0, s1] = kEdgeSides[k];
                if (f == std::min(parent.cell_faces[c][s0], parent.cell_faces[c][s1])) inner[c][k] = next++;
            }
        }
    });
}

}  // namespace subvol::detail
