// A child edge joins an old point and an edge point, an edge point and a face point, or a face point and a cell point; a child
// face lies in a parent face at one of its corners, or in a cell at one of its edges. Sorted by point ids (as `build_topology`
// numbers them) they stand old point by old point, edge by edge, face by face, so that each knows its number from the parent.
#include "child_topology.h"

#include <algorithm>

#include "boundary_rings.h"
#include "bucket_sort.h"
#include "child_cells.h"
#include "edge_rings.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t at(int corner) {
    return static_cast<std::size_t>(corner);
}

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

constexpr auto kEdgeSides = make_edge_sides();

/// The number of the edge of a cell between two of its corners.
constexpr std::size_t edge_between(int a, int b) {
    for (std::size_t k = 0; k < 12; ++k) {
        if ((kCellEdges[k][0] == a && kCellEdges[k][1] == b) || (kCellEdges[k][0] == b && kCellEdges[k][1] == a)) return k;
    }
    return 12;
}

class ChildBuilder {
public:
    explicit ChildBuilder(const Topology& parent)
        : p_(parent),
          first_(parent),
          edge_b_(2 * parent.edges.size()),
          edge_c_(edge_b_ + 4 * parent.faces.size()),
          face_e_(4 * parent.faces.size()) {}

    Topology build() {
        t_.point_count = first_.end;
        t_.cells = child_cells(p_);
        t_.creases = child_creases(p_);
        t_.nonmanifold_edges = 2 * p_.nonmanifold_edges;
        sort_edge_faces();
        number_edges();
        number_faces();
        fill_edges();
        fill_faces();
        fill_cells();
        fill_point_edges();
        fill_flags();
        size_rings();
        rank_cells();
        fill_rings();
        return std::move(t_);
    }

private:
    [[nodiscard]] Index edge_point(Index e) const { return static_cast<Index>(first_.edges + e); }
    [[nodiscard]] Index face_point(Index f) const { return static_cast<Index>(first_.faces + f); }
    [[nodiscard]] Index cell_point(Index c) const { return static_cast<Index>(first_.cells + p_.cell_rank[c]); }

    /// A face's cells in the order of their points.
    [[nodiscard]] std::array<Index, 2> cells_by_rank(Index f) const {
        auto cells = p_.face_cells[f];
        if (cells[1] != kNone && p_.cell_rank[cells[1]] < p_.cell_rank[cells[0]]) std::swap(cells[0], cells[1]);
        return cells;
    }

    void sort_edge_faces() {
        sorted_faces_ = p_.edge_faces.values;
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            const auto begin = sorted_faces_.begin();
            std::sort(begin + static_cast<std::ptrdiff_t>(p_.edge_faces.offsets[e]),
                      begin + static_cast<std::ptrdiff_t>(p_.edge_faces.offsets[e + 1]));
        });
    }

    [[nodiscard]] std::span<const Index> faces_at(Index e) const {
        return std::span(sorted_faces_).subspan(p_.edge_faces.offsets[e], p_.edge_faces[e].size());
    }

    void number_edges() {
        a_.resize(p_.edges.size());
        parallel_each(p_.point_count, [&](std::size_t v) {
            const auto edges = p_.point_edges[v];
            for (std::size_t i = 0; i < edges.size(); ++i) {
                a_[edges[i]][p_.edges[edges[i]][0] == v ? 0 : 1] = static_cast<Index>(p_.point_edges.offsets[v] + i);
            }
        });
        b_.resize(p_.faces.size());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            const auto faces = faces_at(static_cast<Index>(e));
            for (std::size_t i = 0; i < faces.size(); ++i) {
                b_[faces[i]][slot_of(p_.face_edges[faces[i]], static_cast<Index>(e))] =
                    static_cast<Index>(edge_b_ + p_.edge_faces.offsets[e] + i);
            }
        });
        face_cell_offsets_.assign(p_.faces.size() + 1, 0);
        for (std::size_t f = 0; f < p_.faces.size(); ++f) {
            face_cell_offsets_[f + 1] = face_cell_offsets_[f] + (p_.face_on_hull(static_cast<Index>(f)) ? 1u : 2u);
        }
        c_.resize(p_.cells.size());
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            const auto cells = cells_by_rank(static_cast<Index>(f));
            for (std::size_t i = 0; i < 2 && cells[i] != kNone; ++i) {
                c_[cells[i]][slot_of(p_.cell_faces[cells[i]], static_cast<Index>(f))] =
                    static_cast<Index>(edge_c_ + face_cell_offsets_[f] + i);
            }
        });
    }

    /// The other edge of a face at a point of one of its edges.
    [[nodiscard]] Index other_edge(Index f, Index e, std::size_t v) const {
        const std::size_t k = slot_of(p_.face_edges[f], e);
        return p_.face_edges[f][p_.faces[f][k] == v ? (k + 3) % 4 : (k + 1) % 4];
    }

    void number_faces() {
        corner_offsets_.assign(p_.point_count + 1, 0);  // twice the faces at a point are the faces at its edges
        parallel_each(p_.point_count, [&](std::size_t v) {
            std::size_t sides = 0;
            for (const Index e : p_.point_edges[v]) sides += p_.edge_faces[e].size();
            corner_offsets_[v + 1] = static_cast<Index>(sides / 2);
        });
        for (std::size_t v = 0; v < p_.point_count; ++v) corner_offsets_[v + 1] += corner_offsets_[v];
        fv_.resize(p_.faces.size());
        parallel_each(p_.point_count, [&](std::size_t v) {
            Index next = corner_offsets_[v];
            for (const Index e : p_.point_edges[v]) {
                for (const Index f : faces_at(e)) {
                    if (e < other_edge(f, e, v)) fv_[f][slot_of(p_.faces[f], static_cast<Index>(v))] = next++;
                }
            }
        });
        fe_.resize(p_.cells.size());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            auto next = static_cast<Index>(face_e_ + p_.edge_cells.offsets[e]);
            for (const Index f : faces_at(static_cast<Index>(e))) {
                for (const Index c : cells_by_rank(f)) {
                    if (c == kNone) continue;
                    const std::size_t k = slot_of(p_.cell_edges[c], static_cast<Index>(e));
                    const auto& [s0, s1] = kEdgeSides[k];
                    if (f == std::min(p_.cell_faces[c][s0], p_.cell_faces[c][s1])) fe_[c][k] = next++;
                }
            }
        });
    }

    void fill_edges() {
        t_.edges.resize(edge_c_ + face_cell_offsets_.back());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (std::size_t i = 0; i < 2; ++i) t_.edges[a_[e][i]] = {p_.edges[e][i], edge_point(static_cast<Index>(e))};
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            for (std::size_t k = 0; k < 4; ++k) {
                t_.edges[b_[f][k]] = {edge_point(p_.face_edges[f][k]), face_point(static_cast<Index>(f))};
            }
        });
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            for (std::size_t s = 0; s < 6; ++s) {
                t_.edges[c_[c][s]] = {face_point(p_.cell_faces[c][s]), cell_point(static_cast<Index>(c))};
            }
        });
        t_.edge_offsets.resize(t_.point_count + 1);
        parallel_each(t_.point_count + 1, [&](std::size_t q) {
            t_.edge_offsets[q] = static_cast<Index>(q < first_.edges   ? p_.point_edges.offsets[q]
                                                    : q < first_.faces ? edge_b_ + p_.edge_faces.offsets[q - first_.edges]
                                                    : q < first_.cells ? edge_c_ + face_cell_offsets_[q - first_.faces]
                                                                       : t_.edges.size());
        });
    }

    void fill_faces() {
        const std::size_t count = face_e_ + 12 * p_.cells.size();
        t_.faces.resize(count);
        t_.face_edges.resize(count);
        t_.face_cells.resize(count);
        if (!p_.face_is_sharp.empty()) t_.face_is_sharp.assign(count, 0);
        parallel_each(p_.faces.size(), [&](std::size_t f) { fill_quarters(static_cast<Index>(f)); });
        parallel_each(p_.cells.size(), [&](std::size_t c) { fill_inner_faces(static_cast<Index>(c)); });
    }

    void fill_quarters(Index f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Index v = p_.faces[f][k];
            std::size_t low = k, high = (k + 3) % 4;  // slots of its two edges
            if (p_.face_edges[f][high] < p_.face_edges[f][low]) std::swap(low, high);
            const Index e0 = p_.face_edges[f][low], e1 = p_.face_edges[f][high], face = fv_[f][k];
            t_.faces[face] = {v, edge_point(e0), face_point(f), edge_point(e1)};
            t_.face_edges[face] = {a_[e0][end_of(e0, v)], b_[f][low], b_[f][high], a_[e1][end_of(e1, v)]};
            auto& cells = t_.face_cells[face];
            for (std::size_t i = 0; i < 2; ++i) {
                const Index c = p_.face_cells[f][i];
                cells[i] = c == kNone ? kNone : static_cast<Index>(8 * c + slot_of(p_.cells[c], v));
            }
            if (!p_.face_is_sharp.empty()) t_.face_is_sharp[face] = p_.face_is_sharp[f];
        }
    }

    void fill_inner_faces(Index c) {
        for (std::size_t k = 0; k < 12; ++k) {
            const Index e = p_.cell_edges[c][k], face = fe_[c][k];
            std::array<std::size_t, 2> side{kEdgeSides[k][0], kEdgeSides[k][1]};
            if (p_.cell_faces[c][side[1]] < p_.cell_faces[c][side[0]]) std::swap(side[0], side[1]);
            const Index f0 = p_.cell_faces[c][side[0]], f1 = p_.cell_faces[c][side[1]];
            t_.faces[face] = {edge_point(e), face_point(f0), cell_point(c), face_point(f1)};
            t_.face_edges[face] = {b_[f0][slot_of(p_.face_edges[f0], e)], c_[c][side[0]], c_[c][side[1]],
                                   b_[f1][slot_of(p_.face_edges[f1], e)]};
            const auto c0 = static_cast<Index>(8 * c + at(kCellEdges[k][0])),
                       c1 = static_cast<Index>(8 * c + at(kCellEdges[k][1]));
            t_.face_cells[face] = {std::min(c0, c1), std::max(c0, c1)};
        }
    }

    [[nodiscard]] std::size_t end_of(Index e, Index v) const { return p_.edges[e][0] == v ? 0 : 1; }

    void fill_cells() {
        t_.cell_edges.resize(t_.cells.size());
        t_.cell_faces.resize(t_.cells.size());
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            for (std::size_t child = 0; child < 8; ++child) fill_cell(static_cast<Index>(c), child);
        });
    }

    void fill_cell(Index c, std::size_t child) {
        const auto& faces = p_.cell_faces[c];
        for (std::size_t k = 0; k < 12; ++k) {
            auto low = lattice_place(child, at(kCellEdges[k][0])), high = lattice_place(child, at(kCellEdges[k][1]));
            if (high.kind < low.kind) std::swap(low, high);
            Index& edge = t_.cell_edges[8 * c + child][k];
            if (low.kind == LatticePlace::Corner) {
                const Index e = p_.cell_edges[c][high.number];
                edge = a_[e][end_of(e, p_.cells[c][low.number])];
            } else if (low.kind == LatticePlace::Edge) {
                const Index f = faces[high.number];
                edge = b_[f][slot_of(p_.face_edges[f], p_.cell_edges[c][low.number])];
            } else {
                edge = c_[c][low.number];
            }
        }
        for (std::size_t s = 0; s < 6; ++s) {
            // Sides that touch the child's corner of the parent are quarters of its faces, the others lie inside.
            const auto& corners = kCellFaces[s];
            Index& face = t_.cell_faces[8 * c + child][s];
            if (std::find(corners.begin(), corners.end(), static_cast<int>(child)) != corners.end()) {
                face = fv_[faces[s]][slot_of(p_.faces[faces[s]], p_.cells[c][child])];
            } else {
                for (const int corner : corners) {
                    const auto place = lattice_place(child, at(corner));
                    if (place.kind == LatticePlace::Edge) face = fe_[c][place.number];
                }
            }
        }
    }

    void fill_point_edges() {
        auto& offsets = t_.point_edges.offsets;
        offsets.assign(t_.point_count + 1, 0);
        const auto degree = [&](std::size_t q) {
            if (q < first_.edges) return p_.point_edges[q].size();
            if (q < first_.faces) return 2 + p_.edge_faces[q - first_.edges].size();
            return q < first_.cells ? std::size_t{4} + (p_.face_on_hull(static_cast<Index>(q - first_.faces)) ? 1 : 2) : 6;
        };
        for (std::size_t q = 0; q < t_.point_count; ++q) offsets[q + 1] = offsets[q] + degree(q);
        auto& values = t_.point_edges.values;
        values.resize(offsets.back());
        const auto put = [&](std::size_t q, auto... edges) {  // ascending: first those from smaller points, then its own
            std::size_t i = offsets[q];
            ((values[i++] = edges), ...);
            for (Index own = t_.edge_offsets[q]; own < t_.edge_offsets[q + 1]; ++own) values[i++] = own;
        };
        parallel_each(p_.point_count, [&](std::size_t v) { put(v); });
        parallel_each(p_.edges.size(), [&](std::size_t e) { put(first_.edges + e, a_[e][0], a_[e][1]); });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            auto b = b_[f];
            std::sort(b.begin(), b.end());
            put(first_.faces + f, b[0], b[1], b[2], b[3]);
        });
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            auto s = c_[c];
            std::sort(s.begin(), s.end());
            put(cell_point(static_cast<Index>(c)), s[0], s[1], s[2], s[3], s[4], s[5]);
        });
    }

    void fill_flags() {
        t_.edge_on_boundary.assign(t_.edges.size(), 0);
        t_.edge_is_crease.assign(t_.edges.size(), 0);
        t_.edge_has_ring.assign(t_.edges.size(), 1);
        t_.point_on_boundary.assign(t_.point_count, 0);
        std::copy(p_.point_on_boundary.begin(), p_.point_on_boundary.end(), t_.point_on_boundary.begin());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (const Index half : a_[e]) {
                t_.edge_on_boundary[half] = p_.edge_on_boundary[e];
                t_.edge_is_crease[half] = p_.edge_is_crease[e];
                t_.edge_has_ring[half] = p_.edge_has_ring[e];
            }
            t_.point_on_boundary[first_.edges + e] = p_.edge_on_boundary[e];
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            const bool boundary = p_.face_on_boundary(static_cast<Index>(f));
            t_.point_on_boundary[first_.faces + f] = boundary;
            for (const Index b : b_[f]) {
                t_.edge_on_boundary[b] = boundary;
                t_.edge_has_ring[b] = !boundary;
            }
        });
    }

    void size_rings() {
        auto& faces = t_.edge_faces.offsets;
        auto& cells = t_.edge_cells.offsets;
        faces.assign(t_.edges.size() + 1, 0);
        cells.assign(t_.edges.size() + 1, 0);
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (const Index half : a_[e]) {
                faces[half + 1] = p_.edge_faces[e].size();
                cells[half + 1] = p_.edge_cells[e].size();
            }
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            const bool hull = p_.face_on_hull(static_cast<Index>(f));
            for (const Index b : b_[f]) {
                faces[b + 1] = hull ? 3 : 4;
                cells[b + 1] = hull ? 2 : 4;
            }
        });
        parallel_each(t_.edges.size() - edge_c_, [&](std::size_t i) { faces[edge_c_ + i + 1] = cells[edge_c_ + i + 1] = 4; });
        for (std::size_t e = 0; e < t_.edges.size(); ++e) {
            faces[e + 1] += faces[e];
            cells[e + 1] += cells[e];
        }
        t_.edge_faces.values.resize(faces.back());
        t_.edge_cells.values.resize(cells.back());
    }

    /// Writes a closed ring: from its smallest face on to the smaller of that one's two neighbours.
    template <class Faces, class Cells>
    void put_ring(Index edge, const Faces& faces, const Cells& cells) {
        const std::size_t m = faces.size();
        const auto start = static_cast<std::size_t>(std::min_element(faces.begin(), faces.end()) - faces.begin());
        const bool forward = faces[(start + 1) % m] <= faces[(start + m - 1) % m];
        const auto to_faces = t_.edge_faces.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_faces.offsets[edge]);
        const auto to_cells = t_.edge_cells.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_cells.offsets[edge]);
        for (std::size_t j = 0; j < m; ++j) {
            const auto i = static_cast<std::ptrdiff_t>(j);
            to_faces[i] = faces[forward ? (start + j) % m : (start + m - j) % m];
            to_cells[i] = cells[forward ? (start + j) % m : (start + 2 * m - j - 1) % m];
        }
    }

    template <class Faces, class Cells>
    void put_fan(Index edge, const Faces& faces, const Cells& cells) {
        const auto to_faces = t_.edge_faces.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_faces.offsets[edge]);
        const auto to_cells = t_.edge_cells.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_cells.offsets[edge]);
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
                    const int a = kCellFaces[s][i], b = kCellFaces[s][(i + 1) % 4];
                    faces[i] = fe_[c][edge_between(a, b)];
                    cells[i] = static_cast<Index>(8 * c + at(b));
                }
                put_ring(c_[c][s], faces, cells);
            }
        });
    }

    void halve_ring(Index e, std::size_t end) {
        const Index v = p_.edges[e][end], half = a_[e][end];
        thread_local std::vector<Index> faces, cells;
        faces.clear();
        cells.clear();
        for (const Index f : p_.edge_faces[e]) faces.push_back(fv_[f][slot_of(p_.faces[f], v)]);
        for (const Index c : p_.edge_cells[e]) cells.push_back(static_cast<Index>(8 * c + slot_of(p_.cells[c], v)));
        const bool single_fan = faces.size() == cells.size() + 1 && t_.face_on_hull(faces.front());
        if (p_.edge_has_ring[e]) {
            put_ring(half, faces, cells);
        } else if (single_fan) {
            put_fan(half, faces, cells);
        } else {
            std::sort(faces.begin(), faces.end());
            thread_local std::vector<Index> ring_faces, ring_cells;
            walk_edge_ring(t_, faces, ring_faces, ring_cells);
            std::copy(ring_faces.begin(), ring_faces.end(),
                      t_.edge_faces.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_faces.offsets[half]));
            std::copy(ring_cells.begin(), ring_cells.end(),
                      t_.edge_cells.values.begin() + static_cast<std::ptrdiff_t>(t_.edge_cells.offsets[half]));
        }
    }

    /// About the child edge from the point of edge k of a face to the face's point.
    void ring_in_face(Index f, std::size_t k) {
        const Index e = p_.face_edges[f][k], v0 = p_.faces[f][k], v1 = p_.faces[f][(k + 1) % 4];
        const auto [c0, c1] = p_.face_cells[f];
        const auto inner = [&](Index c) { return fe_[c][slot_of(p_.cell_edges[c], e)]; };
        const auto child = [&](Index c, Index v) { return static_cast<Index>(8 * c + slot_of(p_.cells[c], v)); };
        const Index q0 = fv_[f][k], q1 = fv_[f][(k + 1) % 4];
        if (c1 == kNone) {
            put_fan(b_[f][k], std::array{q0, inner(c0), q1}, std::array{child(c0, v0), child(c0, v1)});
        } else {
            put_ring(b_[f][k], std::array{q0, inner(c0), q1, inner(c1)},
                     std::array{child(c0, v0), child(c0, v1), child(c1, v1), child(c1, v0)});
        }
    }

    /// By their sorted faces: the smallest one is a quarter of a parent's face, so cells stand old point by old point.
    void rank_cells() {
        t_.cell_rank.resize(t_.cells.size());
        std::vector<Index> offsets(p_.point_count + 1, 0);
        parallel_each(p_.point_count, [&](std::size_t v) {
            std::size_t sides = 0;  // three faces of every cell at the point
            for (Index q = corner_offsets_[v]; q < corner_offsets_[v + 1]; ++q) sides += t_.face_on_hull(q) ? 1 : 2;
            offsets[v + 1] = static_cast<Index>(sides / 3);
        });
        for (std::size_t v = 0; v < p_.point_count; ++v) offsets[v + 1] += offsets[v];
        parallel_each(p_.point_count, [&](std::size_t v) {
            Index next = offsets[v];
            for (Index q = corner_offsets_[v]; q < corner_offsets_[v + 1]; ++q) {
                std::array<Index, 2> cells = t_.face_cells[q];
                std::array<std::array<Index, 6>, 2> keys;
                for (std::size_t i = 0; i < 2; ++i) {
                    if (cells[i] == kNone) continue;
                    keys[i] = t_.cell_faces[cells[i]];
                    std::sort(keys[i].begin(), keys[i].end());
                    if (keys[i][0] != q) cells[i] = kNone;
                }
                if (cells[0] != kNone && cells[1] != kNone && keys[1] < keys[0]) std::swap(cells[0], cells[1]);
                for (const Index c : cells) {
                    if (c != kNone) t_.cell_rank[c] = next++;
                }
            }
        });
    }

    const Topology& p_;
    Topology t_;
    ChildNumbering first_;
    std::size_t edge_b_, edge_c_, face_e_;  // where child edges from edge points, from face points, faces in cells start
    FlatArray<Index> sorted_faces_;         // edge_faces, ascending
    std::vector<Index> face_cell_offsets_;  // how many cells the faces before this one have
    std::vector<Index> corner_offsets_;     // how many faces the points before this one have
    FlatArray<std::array<Index, 2>> a_;     // child edges at the ends of an edge
    FlatArray<std::array<Index, 4>> b_;     // child edges from the edges of a face to its point
    FlatArray<std::array<Index, 6>> c_;     // child edges from the sides of a cell to its point
    FlatArray<std::array<Index, 4>> fv_;    // child faces at the corners of a face
    FlatArray<std::array<Index, 12>> fe_;   // child faces at the edges of a cell
};

}  // namespace

Topology child_topology(const Topology& parent) {
    const std::size_t faces = 4 * parent.faces.size() + 12 * parent.cells.size();  // the most numerous of the child's parts
    if (faces >= kNone) {
        throw Error(ErrorCode::InvalidInput, "the refined mesh needs " + std::to_string(faces) + " faces", {},
                    "at most " + std::to_string(kNone - 1) + ": use fewer levels, or a build with SUBVOL_INDEX64");
    }
    return ChildBuilder(parent).build();
}

}  // namespace subvol::detail
