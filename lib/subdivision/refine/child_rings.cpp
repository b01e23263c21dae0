// SPDX-License-Identifier: Apache-2.0
// The rings of faces and cells about a child's edges. About an edge a the ring is that of the parent edge that it halves; about
// an edge b it has the four faces and four cells next to it in the two cells of the parent face (three and two on the hull);
// about an edge c, inside a cell, four of each.
#include <algorithm>

#include "child_numbers.h"
#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/topology_parts.h"

namespace subvol::detail {

namespace {

/// The number of the edge of a cell between two of its corners.
constexpr std::size_t edge_between(std::size_t a, std::size_t b) {
    for (std::size_t k = 0; k < 12; ++k) {
        if ((kCellEdges[k][0] == a && kCellEdges[k][1] == b) || (kCellEdges[k][0] == b && kCellEdges[k][1] == a)) return k;
    }
    return 12;
}

class RingBuilder {
public:
    RingBuilder(const ChildNumbers& numbers, Topology& child) : p_(numbers.parent), n_(numbers), t_(child) {}

    void run() {
        size_rings();
        fill_rings();
    }

private:
    void size_rings() {
        auto& faces = t_.edge_faces.offsets;
        auto& cells = t_.edge_cells.offsets;
        faces.assign(t_.edges.size() + 1, 0);
        cells.assign(t_.edges.size() + 1, 0);
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (const Index half : n_.at_ends[e]) {
                faces[half + 1] = p_.edge_faces[e].size();
                cells[half + 1] = p_.edge_cells[e].size();
            }
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            const bool hull = p_.face_on_hull(static_cast<Index>(f));
            for (const Index b : n_.to_face[f]) {
                faces[b + 1] = hull ? 3 : 4;
                cells[b + 1] = hull ? 2 : 4;
            }
        });
        parallel_each(t_.edges.size() - n_.edge_c,
                      [&](std::size_t i) { faces[n_.edge_c + i + 1] = cells[n_.edge_c + i + 1] = 4; });
        for (std::size_t e = 0; e < t_.edges.size(); ++e) {
            faces[e + 1] += faces[e];
            cells[e + 1] += cells[e];
        }
        t_.edge_faces.values.resize(faces.back());
        t_.edge_cells.values.resize(cells.back());
    }

    /// Writes a closed ring, which starts at its smallest face and continues with the smaller of the two faces next to it.
    template <class Faces, class Cells>
    void put_ring(Index edge, const Faces& faces, const Cells& cells) {
        const std::size_t m = faces.size();
        const auto start = static_cast<std::size_t>(std::min_element(faces.begin(), faces.end()) - faces.begin());
        const bool forward = faces[(start + 1) % m] <= faces[(start + m - 1) % m];
        const auto to_faces = t_.edge_faces.values.data() + t_.edge_faces.offsets[edge];
        const auto to_cells = t_.edge_cells.values.data() + t_.edge_cells.offsets[edge];
        for (std::size_t j = 0; j < m; ++j) {
            to_faces[j] = faces[forward ? (start + j) % m : (start + m - j) % m];
            to_cells[j] = cells[forward ? (start + j) % m : (start + 2 * m - j - 1) % m];
        }
    }

    /// Writes an open ring, from its smaller end on.
    template <class Faces, class Cells>
    void put_fan(Index edge, const Faces& faces, const Cells& cells) {
        const auto to_faces = t_.edge_faces.values.data() + t_.edge_faces.offsets[edge];
        const auto to_cells = t_.edge_cells.values.data() + t_.edge_cells.offsets[edge];
        if (faces.front() < faces.back()) {
            std::copy(faces.begin(), faces.end(), to_faces);
            std::copy(cells.begin(), cells.end(), to_cells);
        } else {
            std::reverse_copy(faces.begin(), faces.end(), to_faces);
            std::reverse_copy(cells.begin(), cells.end(), to_cells);
        }
    }

    void fill_rings() {
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (std::size_t i = 0; i < 2; ++i) halve_ring(static_cast<Index>(e), i);
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            for (std::size_t k = 0; k < 4; ++k) ring_in_face(static_cast<Index>(f), k);
        });
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            for (std::size_t s = 0; s < 6; ++s) {
                std::array<Index, 4> faces, cells;
                for (std::size_t i = 0; i < 4; ++i) {
                    const std::size_t a = kCellFaces[s][i], b = kCellFaces[s][(i + 1) % 4];
                    faces[i] = n_.inner[c][edge_between(a, b)];
                    cells[i] = child_cell(static_cast<Index>(c), b);
                }
                put_ring(n_.to_cell[c][s], faces, cells);
            }
        });
    }

    void halve_ring(Index e, std::size_t end) {
        const Index v = p_.edges[e][end], half = n_.at_ends[e][end];
        thread_local std::vector<Index> faces, cells;
        faces.clear();
        cells.clear();
        for (const Index f : p_.edge_faces[e]) faces.push_back(n_.quarters[f][slot_of(p_.faces[f], v)]);
        for (const Index c : p_.edge_cells[e]) cells.push_back(child_cell(c, slot_of(p_.cells[c], v)));
        const bool single_fan = faces.size() == cells.size() + 1 && t_.face_on_hull(faces.front());
        if (p_.edge_has_ring[e]) {
            put_ring(half, faces, cells);
        } else if (single_fan) {
            put_fan(half, faces, cells);
        } else {
            std::sort(faces.begin(), faces.end());
            thread_local std::vector<Index> ring_faces, ring_cells;
            walk_edge_ring(t_, faces, ring_faces, ring_cells);
            std::copy(ring_faces.begin(), ring_faces.end(), t_.edge_faces.values.data() + t_.edge_faces.offsets[half]);
            std::copy(ring_cells.begin(), ring_cells.end(), t_.edge_cells.values.data() + t_.edge_cells.offsets[half]);
        }
    }

    /// The ring about the child edge from the point of edge k of a face to the point of the face.
    void ring_in_face(Index f, std::size_t k) {
        const Index e = p_.face_edges[f][k], v0 = p_.faces[f][k], v1 = p_.faces[f][(k + 1) % 4];
        const auto [c0, c1] = p_.face_cells[f];
        const auto inner = [&](Index c) { return n_.inner[c][slot_of(p_.cell_edges[c], e)]; };
        const auto child = [&](Index c, Index v) { return child_cell(c, slot_of(p_.cells[c], v)); };
        const Index q0 = n_.quarters[f][k], q1 = n_.quarters[f][(k + 1) % 4];
        if (c1 == kNone) {
            put_fan(n_.to_face[f][k], std::array{q0, inner(c0), q1}, std::array{child(c0, v0), child(c0, v1)});
        } else {
            put_ring(n_.to_face[f][k], std::array{q0, inner(c0), q1, inner(c1)},
                     std::array{child(c0, v0), child(c0, v1), child(c1, v1), child(c1, v0)});
        }
    }

    const Topology& p_;
    const ChildNumbers& n_;
    Topology& t_;
};

}  // namespace

void fill_child_rings(const ChildNumbers& numbers, Topology& child) {
    RingBuilder(numbers, child).run();
}

}  // namespace subvol::detail
