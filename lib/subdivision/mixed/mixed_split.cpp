// SPDX-License-Identifier: Apache-2.0
// The split that all schemes of tetrahedra share, without averaging: numbers of the new points, and the cells between them.
//
//            d
//           / \           A tetrahedron abcd becomes four tetrahedra at its corners and an octahedron between the middles of
//         ad───bd         its edges; on each face that is three corner triangles and a face of the octahedron in the middle.
//         / \ / \         An octahedron becomes six octahedra at its corners and eight tetrahedra at its faces, which meet in
//        a───ab──b        its centre. So cells do not become flatter from level to level, as they would if the octahedron were
//                         cut into tetrahedra.
//
//     tetrahedron  →  4 tetrahedra + 1 octahedron            prism       →  8 prisms
//     octahedron   →  6 octahedra + 8 tetrahedra             hexahedron  →  8 hexahedra
//     pyramid      →  6 pyramids + 4 tetrahedra
//
// Points of the next level, in this order: those of the parent; one for each edge; one for each quad; one for each octahedron;
// one for each hexahedron. Each kind is sorted by its corners, so the numbers do not depend on the order of the cells.
//
// The corners of an octahedron are three pairs of opposite ones, 0–1, 2–3 and 4–5, so corner w ^ 1 is opposite to w. The pair
// 0–1 is the diagonal on which the box spline has its middle.
#include "subvol/detail/mixed_levels.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "subvol/cell.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

template <std::size_t N>
void sort_unique(std::vector<std::array<Index, N>>& keys) {
    tbb::parallel_sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/// The places of the cells in the order of their sorted corners: rank[cell], and its inverse. Two cells with the same corners
/// keep their order.
template <std::size_t N>
void rank_cells(const std::vector<std::array<Index, N>>& cells, std::vector<Index>& rank, std::vector<Index>& of_rank) {
    struct Keyed {
        std::array<Index, N> key;
        Index cell;
        auto operator<=>(const Keyed&) const = default;
    };
    std::vector<Keyed> keyed(cells.size());
    parallel_each(cells.size(), [&](std::size_t c) {
        keyed[c] = {cells[c], static_cast<Index>(c)};
        std::sort(keyed[c].key.begin(), keyed[c].key.end());
    });
    tbb::parallel_sort(keyed.begin(), keyed.end());
    rank.resize(cells.size());
    of_rank.resize(cells.size());
    parallel_each(cells.size(), [&](std::size_t r) {
        rank[keyed[r].cell] = static_cast<Index>(r);
        of_rank[r] = keyed[r].cell;
    });
}

}  // namespace

SplitNumbers::SplitNumbers(const MixedMesh& parent, std::size_t points) : parent_points_(points) {
    std::size_t edges = 0;
    each_kind_of(parent, [&](CellKind kind, const auto& cells) { edges += cells.size() * table_of(kind).edges.size(); });
    edges_.resize(edges);
    std::size_t first = 0;
    each_kind_of(parent, [&](CellKind kind, const auto& cells) {
        const auto& table = table_of(kind);
        const std::size_t count = table.edges.size();
        parallel_each(cells.size(), [&](std::size_t c) {
            for (std::size_t e = 0; e < count; ++e) edges_[first + c * count + e] = edge_of(cells[c], table.edges[e]);
        });
        first += cells.size() * count;
        for (const auto& cell : cells) {
            for (const auto& face : table.faces) {
                if (face[3] < 0) continue;
                auto key = face_of(cell, face);
                std::sort(key.begin(), key.end());
                quads_.push_back(key);
            }
        }
    });
    sort_unique(edges_);
    sort_unique(quads_);
    edges_.shrink_to_fit();
    // Edges are looked up for every child: by the smaller end at once, then by bisection among the few edges that it has.
    edge_offsets_.assign(points + 1, 0);
    for (const auto& [a, b] : edges_) ++edge_offsets_[a + 1];
    std::partial_sum(edge_offsets_.begin(), edge_offsets_.end(), edge_offsets_.begin());
    rank_cells(parent.octahedra, octahedron_rank_, octahedron_of_rank_);
    rank_cells(parent.hexes, hex_rank_, hex_of_rank_);
    const std::size_t total = points + edges_.size() + quads_.size() + parent.octahedra.size() + parent.hexes.size();
    if (total >= kNone) throw Error(ErrorCode::InvalidInput, "the refined mesh has too many points", {}, "fewer levels");
    first_quad_ = points + edges_.size();
    first_octahedron_ = static_cast<Index>(first_quad_ + quads_.size());
    first_hex_ = static_cast<Index>(first_octahedron_ + parent.octahedra.size());
}

bool SplitNumbers::has_edge(Index a, Index b) const {
    if (a > b) std::swap(a, b);
    const auto begin = edges_.data() + edge_offsets_[a];
    const auto end = edges_.data() + edge_offsets_[a + 1];
    return std::binary_search(begin, end, std::array<Index, 2>{a, b});
}

Index SplitNumbers::edge(Index a, Index b) const {
    if (a > b) std::swap(a, b);
    const auto begin = edges_.data() + edge_offsets_[a];
    const auto end = edges_.data() + edge_offsets_[a + 1];
    const auto found = std::lower_bound(begin, end, std::array<Index, 2>{a, b});
    assert(found != end && (*found)[1] == b);
    return static_cast<Index>(parent_points_ + static_cast<std::size_t>(found - edges_.data()));
}

Index SplitNumbers::quad(std::array<Index, 4> corners) const {
    std::sort(corners.begin(), corners.end());
    const auto found = std::lower_bound(quads_.begin(), quads_.end(), corners);
    assert(found != quads_.end() && *found == corners);
    return static_cast<Index>(first_quad_ + static_cast<std::size_t>(found - quads_.begin()));
}

namespace {

/// Writes the children of each cell to places that depend on its number alone.
class Splitter {
public:
    Splitter(const MixedMesh& parent, const SplitNumbers& n) : parent_(parent), n_(n) {}

    MixedMesh split() {
        tets_of_octahedra_ = 4 * parent_.tets.size();
        tets_of_pyramids_ = tets_of_octahedra_ + 8 * parent_.octahedra.size();
        child_.tets.resize(tets_of_pyramids_ + 4 * parent_.pyramids.size());
        child_.octahedra.resize(parent_.tets.size() + 6 * parent_.octahedra.size());
        child_.prisms.resize(8 * parent_.prisms.size());
        child_.pyramids.resize(6 * parent_.pyramids.size());
        child_.hexes.resize(8 * parent_.hexes.size());
        parallel_each(parent_.tets.size(), [&](std::size_t c) { split_tet(c); });
        parallel_each(parent_.octahedra.size(), [&](std::size_t c) { split_octahedron(c); });
        parallel_each(parent_.prisms.size(), [&](std::size_t c) { split_prism(c); });
        parallel_each(parent_.pyramids.size(), [&](std::size_t c) { split_pyramid(c); });
        parallel_each(parent_.hexes.size(), [&](std::size_t c) { split_hex(c); });
        return std::move(child_);
    }

private:
    /// The corner tetrahedra keep the parent's order of corners, and so its pair of edges; the diagonal joins their middles.
    void split_tet(std::size_t c) {
        const auto [a, b, d, e] = parent_.tets[c];
        const Index ab = n_.edge(a, b), ad = n_.edge(a, d), ae = n_.edge(a, e);
        const Index bd = n_.edge(b, d), be = n_.edge(b, e), de = n_.edge(d, e);
        child_.tets[4 * c] = {a, ab, ad, ae};
        child_.tets[4 * c + 1] = {ab, b, bd, be};
        child_.tets[4 * c + 2] = {ad, bd, d, de};
        child_.tets[4 * c + 3] = {ae, be, de, e};
        child_.octahedra[c] = {ab, de, ad, be, bd, ae};
    }

    /// The corner octahedra have diagonals parallel to the parent's. In the lattice of the box spline, the edges of which the
    /// next diagonal joins the middles are those that are parallel to no edge at the ends of this diagonal.
    void split_octahedron(std::size_t c) {
        const auto& q = parent_.octahedra[c];
        const Index o = n_.center_of_octahedron(c);
        for (std::size_t v = 0; v < 6; ++v) {
            auto& child = child_.octahedra[parent_.tets.size() + 6 * c + v];
            for (std::size_t w = 0; w < 6; ++w) child[w] = w == v ? q[v] : w == (v ^ 1u) ? o : n_.edge(q[v], q[w]);
        }
        for (std::size_t octant = 0; octant < 8; ++octant) {
            const Index x = q[octant & 1u], y = q[2 + (octant >> 1u & 1u)], z = q[4 + (octant >> 2u)];
            const Index xy = n_.edge(x, y), xz = n_.edge(x, z), yz = n_.edge(y, z);
            const bool even = octant == 0 || octant == 3 || octant == 5 || octant == 6;
            child_.tets[tets_of_octahedra_ + 8 * c + octant] = {yz, o, even ? xy : xz, even ? xz : xy};
        }
    }

    /// Two layers of four prisms. A triangle with its middles is cut into four; the quads at the sides have a point in their
    /// middle.
    void split_prism(std::size_t c) {
        const auto& p = parent_.prisms[c];
        // Corners and middles of a triangle, at the bottom, in the middle and at the top.
        std::array<std::array<Index, 6>, 3> layers;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            layers[0][i] = p[i];
            layers[0][3 + i] = n_.edge(p[i], p[j]);
            layers[1][i] = n_.edge(p[i], p[3 + i]);
            layers[1][3 + i] = n_.quad({p[i], p[j], p[3 + i], p[3 + j]});
            layers[2][i] = p[3 + i];
            layers[2][3 + i] = n_.edge(p[3 + i], p[3 + j]);
        }
        constexpr std::array<std::array<std::size_t, 3>, 4> kTriangles{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
        for (std::size_t layer = 0; layer < 2; ++layer) {
            for (std::size_t t = 0; t < 4; ++t) {
                auto& child = child_.prisms[8 * c + 4 * layer + t];
                for (std::size_t i = 0; i < 3; ++i) {
                    child[i] = layers[layer][kTriangles[t][i]];
                    child[3 + i] = layers[layer + 1][kTriangles[t][i]];
                }
            }
        }
    }

    /// Four pyramids at the corners of the base, one at the apex, one upside down below that with its apex in the middle of the
    /// base, and four tetrahedra that fill the gaps between them.
    void split_pyramid(std::size_t c) {
        const auto& p = parent_.pyramids[c];
        const Index f = n_.quad({p[0], p[1], p[2], p[3]});
        std::array<Index, 4> base, side;
        for (std::size_t i = 0; i < 4; ++i) {
            base[i] = n_.edge(p[i], p[(i + 1) % 4]);
            side[i] = n_.edge(p[i], p[4]);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            child_.pyramids[6 * c + i] = {p[i], base[i], f, base[(i + 3) % 4], side[i]};
            child_.tets[tets_of_pyramids_ + 4 * c + i] = {base[i], f, side[i], side[(i + 1) % 4]};
        }
        child_.pyramids[6 * c + 4] = {side[0], side[1], side[2], side[3], p[4]};
        child_.pyramids[6 * c + 5] = {side[3], side[2], side[1], side[0], f};
    }

    /// The 27 points of the hexahedron lie at half steps 0, 1, 2 along each axis. How many corners a point lies between, 1, 2,
    /// 4 or 8, says whether it belongs to a corner, an edge, a quad or the cell.
    void split_hex(std::size_t c) {
        const auto& h = parent_.hexes[c];
        // The corners between which a point lies, as half steps 0, 1, 2 along u, v and w.
        const auto point = [&](const std::array<int, 3>& place) {
            std::array<Index, 4> of{};
            std::size_t count = 0;
            for (std::size_t k = 0; k < 8; ++k) {
                bool near = true;
                for (std::size_t a = 0; a < 3; ++a) near &= place[a] == 1 || place[a] == 2 * kCornerParameters[k][a];
                if (near && count < 4) of[count] = h[k];
                count += near ? 1 : 0;
            }
            if (count == 8) return n_.center_of_hex(c);
            return count == 4 ? n_.quad(of) : count == 2 ? n_.edge(of[0], of[1]) : of[0];
        };
        for (std::size_t k = 0; k < 8; ++k) {
            for (std::size_t i = 0; i < 8; ++i) {
                std::array<int, 3> place;
                for (std::size_t a = 0; a < 3; ++a) place[a] = kCornerParameters[k][a] + kCornerParameters[i][a];
                child_.hexes[8 * c + k][i] = point(place);
            }
        }
    }

    const MixedMesh& parent_;
    const SplitNumbers& n_;
    MixedMesh child_;
    std::size_t tets_of_octahedra_ = 0, tets_of_pyramids_ = 0;
};

}  // namespace

MixedMesh split_cells(const MixedMesh& parent, const SplitNumbers& numbers) {
    return Splitter(parent, numbers).split();
}

}  // namespace subvol::detail
