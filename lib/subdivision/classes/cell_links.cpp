// SPDX-License-Identifier: Apache-2.0
// Walking from cell to cell with the axes in hand.
//
//     ┌──────┬──────┐      Two cells share a face. The neighbour's axes may lie in any of 48 ways: a permutation of u, v, w
//     │  ↑v  │  u←  │      with signs. `turns` has the way for each side, as if the neighbour were moved on to the cell.
//     │  └→u │   ↓v │      A walk multiplies turns (`composed`), so that it knows at each cell which side is the walk's +u.
//     └──────┴──────┘
//
// Octants number the corners of a cell by bits, u + 2v + 4w, since a turn acts on bits: it permutes and flips them. Corners in
// VTK's order are kCornerOctants of octants, and the other way round.
//
// The colours of points make the start of a walk unique. They are computed as in tests of graph isomorphism, by refinement of
// colours: a cell's colour is a hash of those of its points, a point's new colour the sum of those of its cells. A sum does not
// depend on the order of the cells, which may be any, and neither does it depend on the threads, as unsigned sums wrap around.
#include "subvol/detail/cell_links.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/detail/word_hash.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kTurns = 48;

constexpr std::array<CellTurn, kTurns> make_turns() {
    constexpr std::array<std::array<std::size_t, 3>, 6> kAxes{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
    std::array<CellTurn, kTurns> turns{};
    std::size_t n = 0;
    for (const auto& axes : kAxes) {
        for (std::size_t flips = 0; flips < 8; ++flips, ++n) {
            for (std::size_t octant = 0; octant < 8; ++octant) {
                std::size_t to = 0;
                for (std::size_t a = 0; a < 3; ++a) to |= ((octant ^ flips) >> a & 1) << axes[a];
                turns[n].octants[octant] = static_cast<std::uint8_t>(to);
            }
            for (std::size_t side = 0; side < 6; ++side) {
                const std::size_t a = side / 2;
                turns[n].sides[side] = static_cast<std::uint8_t>(2 * axes[a] + ((side & 1) ^ (flips >> a & 1)));
            }
        }
    }
    return turns;
}

constexpr std::array<CellTurn, kTurns> kCellTurns = make_turns();

/// The number of the turn that takes octants 0, 1 and 2 to these: they fix the origin, the u axis and the v axis, and with them
/// the permutation; the w axis is what is left, and its sign follows from the origin.
constexpr std::uint8_t turn_number(std::size_t of0, std::size_t of1, std::size_t of2) {
    for (std::size_t n = 0; n < kTurns; ++n) {
        const auto& o = kCellTurns[n].octants;
        if (o[0] == of0 && o[1] == of1 && o[2] == of2) return static_cast<std::uint8_t>(n);
    }
    return kTurns;
}

constexpr std::array<std::array<std::uint8_t, kTurns>, kTurns> make_products() {
    // Octant triples are few: a table of them makes the search for the product quick enough for the compiler.
    std::array<std::uint8_t, 512> number{};
    for (std::size_t n = 0; n < kTurns; ++n) {
        const auto& o = kCellTurns[n].octants;
        number[o[0] + 8U * o[1] + 64U * o[2]] = static_cast<std::uint8_t>(n);
    }
    std::array<std::array<std::uint8_t, kTurns>, kTurns> products{};
    for (std::size_t a = 0; a < kTurns; ++a) {
        for (std::size_t b = 0; b < kTurns; ++b) {
            const auto& first = kCellTurns[a].octants;
            const auto& second = kCellTurns[b].octants;
            products[a][b] = number[second[first[0]] + 8U * second[first[1]] + 64U * second[first[2]]];
        }
    }
    return products;
}

constexpr auto kProducts = make_products();

/// The turn across a side: the octants on the shared face stay at their points, the others follow.
std::uint8_t turn_across(const std::array<Index, 8>& cell, std::size_t side, const std::array<Index, 8>& neighbor,
                         std::size_t neighbor_side) {
    const std::size_t bit = std::size_t{1} << (side / 2), low = (side & 1) != 0 ? bit : 0;  // of the cell's octants on the side
    const std::size_t neighbor_bit = std::size_t{1} << (neighbor_side / 2);
    std::array<std::size_t, 8> to{};
    for (std::size_t octant = 0; octant < 8; ++octant) {
        if ((octant & bit) != low) continue;
        const Index point = cell[kCornerOctants[octant]];
        std::size_t corner = 0;
        while (neighbor[corner] != point) ++corner;
        // The neighbour's octant at this point, where the neighbour lies on the other side of the face.
        to[octant ^ bit] = kCornerOctants[corner];
        to[octant] = kCornerOctants[corner] ^ neighbor_bit;
    }
    return turn_number(to[0], to[1], to[2]);
}

/// The cell and the turn across each side of each cell.
void link_cells(const Topology& faces, CellLinks& links) {
    links.neighbors.resize(faces.cells.size());
    links.turns.resize(faces.cells.size());
    parallel_each(faces.cells.size(), [&](std::size_t c) {
        for (std::size_t side = 0; side < 6; ++side) {
            const Index face = faces.cell_faces[c][side];
            const auto [c0, c1] = faces.face_cells[face];
            const Index other = c0 == c ? c1 : c0;
            links.neighbors[c][side] = other;
            links.turns[c][side] = 0;
            if (other == kNone) continue;
            const auto& sides = faces.cell_faces[other];
            const auto there = static_cast<std::size_t>(std::find(sides.begin(), sides.end(), face) - sides.begin());
            links.turns[c][side] = turn_across(faces.cells[c], side, faces.cells[other], there);
        }
    });
}

/// The side of a cell, with the points by which it is compared with others that have the same smallest point: the opposite one
/// first, then the other two in order.
struct CellSide {
    std::array<Index, 3> points;
    Index cell;
    std::size_t side;
};

/// The same without the faces of a topology. Each side enters a list of its smallest point, and the sides in a list are
/// compared with each other; the lists take 24 bytes a cell. A cell's sides are found from both of its neighbours' sides, so it
/// does not matter in which order they have entered.
class SideLists {
public:
    explicit SideLists(const HexMesh& mesh)
        : mesh_(mesh), first_(mesh.points.size(), kNone), next_(kSides * mesh.cells.size()) {
        check_count(next_.size(), "sides of cells");
        parallel_each(next_.size(), [&](std::size_t side) {
            std::array<Index, 4> points;
            for (std::size_t k = 0; k < 4; ++k) points[k] = mesh_.cells[side / kSides][kCellFaces[side % kSides][k]];
            next_[side] = std::atomic_ref(first_[*std::ranges::min_element(points)])
                              .exchange(static_cast<Index>(side), std::memory_order_relaxed);
        });
    }

    /// Returns whether each face has at most two cells.
    [[nodiscard]] bool link(CellLinks& links) const {
        links.neighbors.resize(mesh_.cells.size());
        links.turns.resize(mesh_.cells.size());
        parallel_each(mesh_.cells.size(), [&](std::size_t c) {
            links.neighbors[c].fill(kNone);
            links.turns[c].fill(0);
        });
        std::atomic<bool> pairs{true};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first_.size(), 256), [&](const auto& points) {
            std::vector<CellSide> sides;
            for (std::size_t p = points.begin(); p != points.end(); ++p) {
                collect(static_cast<Index>(p), sides);
                for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
                    for (end = i + 1; end < sides.size() && sides[end].points == sides[i].points;) ++end;
                    if (end - i > 2) pairs = false;
                    if (end - i == 2) join(sides[i], sides[i + 1], links);
                }
            }
        });
        return pairs;
    }

private:
    static constexpr std::size_t kSides = 6;

    void collect(Index point, std::vector<CellSide>& sides) const {
        sides.clear();
        for (Index at = first_[point]; at != kNone; at = next_[at]) {
            const auto& cell = mesh_.cells[at / kSides];
            const auto& corners = kCellFaces[at % kSides];
            std::size_t k = 0;
            while (cell[corners[k]] != point) ++k;
            const Index a = cell[corners[(k + 1) % 4]], b = cell[corners[(k + 3) % 4]];
            sides.push_back(
                {{cell[corners[(k + 2) % 4]], std::min(a, b), std::max(a, b)}, static_cast<Index>(at / kSides), at % kSides});
        }
        std::ranges::sort(sides, {}, &CellSide::points);
    }

    void join(const CellSide& a, const CellSide& b, CellLinks& links) const {
        links.neighbors[a.cell][a.side] = b.cell;
        links.neighbors[b.cell][b.side] = a.cell;
        links.turns[a.cell][a.side] = turn_across(mesh_.cells[a.cell], a.side, mesh_.cells[b.cell], b.side);
        links.turns[b.cell][b.side] = turn_across(mesh_.cells[b.cell], b.side, mesh_.cells[a.cell], a.side);
    }

    const HexMesh& mesh_;
    std::vector<Index> first_;  // side of each point
    FlatArray<Index> next_;     // side in the list of each side: 6 · cell + side
};

/// Whether two cells have the same corners, and no third cell between them.
bool has_twins(const CellLinks& links) {
    return std::ranges::any_of(links.neighbors, [](const std::array<Index, 6>& cells) {
        return cells[0] != kNone && std::ranges::count(cells, cells[0]) == 6;
    });
}

template <std::size_t N>
std::array<Index, N> sorted(std::array<Index, N> points) {
    std::sort(points.begin(), points.end());
    return points;
}

template <std::size_t N>
std::vector<std::array<Index, N>> sorted_tags(std::vector<std::array<Index, N>> tags) {
    for (auto& points : tags) points = sorted(points);
    std::sort(tags.begin(), tags.end());
    return tags;
}

template <std::size_t N>
bool is_tagged(const std::vector<std::array<Index, N>>& tags, const std::array<Index, 8>& cell,
               const std::array<std::size_t, N>& corners) {
    std::array<Index, N> points;
    for (std::size_t i = 0; i < N; ++i) points[i] = cell[corners[i]];
    return std::binary_search(tags.begin(), tags.end(), sorted(points));
}

/// Marks the edges and sides of cells that are tagged as creases and sharp faces. Tags are lists of points in any order, so
/// they are compared as sorted points.
void mark_tags(const HexMesh& mesh, CellLinks& links) {
    if (!mesh.creases.empty()) {
        const auto creases = sorted_tags(mesh.creases);
        std::vector<std::uint8_t> at_crease(mesh.points.size(), 0);
        for (const auto& crease : creases) {
            for (const Index p : crease) at_crease[p] = 1;
        }
        links.creases.resize(mesh.cells.size());
        parallel_each(mesh.cells.size(), [&](std::size_t c) {
            if (std::ranges::none_of(mesh.cells[c], [&](Index p) { return at_crease[p] != 0; })) return;
            for (std::size_t k = 0; k < 12; ++k) {
                if (is_tagged(creases, mesh.cells[c], kCellEdges[k])) links.creases[c] |= static_cast<std::uint16_t>(1U << k);
            }
        });
    }
    if (!mesh.sharp_faces.empty()) {
        const auto faces = sorted_tags(mesh.sharp_faces);
        parallel_each(mesh.cells.size(), [&](std::size_t c) {
            for (std::size_t side = 0; side < 6; ++side) {
                if (is_tagged(faces, mesh.cells[c], kCellFaces[side])) links.turns[c][side] |= CellLinks::kSharp;
            }
        });
    }
}

/// Whether four cells lie around the edge at which two sides of a cell meet: across the one and then the other, and the other
/// way round, is the same cell.
bool has_four_cells(const CellLinks& links, Index cell, std::size_t a, std::size_t b) {
    const auto diagonal = [&](std::size_t first, std::size_t second) -> std::pair<Index, std::uint8_t> {
        const Index next = links.neighbors[cell][first];
        if (next == kNone) return {kNone, 0};
        const std::uint8_t turn = links.turn(cell, first);
        const std::size_t side = kCellTurns[turn].sides[second];
        return {links.neighbors[next][side], kProducts[turn][links.turn(next, side)]};
    };
    const auto one = diagonal(a, b);
    return one.first != kNone && one == diagonal(b, a);
}

/// Two sides of different axes meet at each of the twelve edges of a cell: 12 pairs a, b.
void mark_regular(CellLinks& links) {
    links.regular.resize(links.neighbors.size());
    parallel_each(links.regular.size(), [&](std::size_t i) {
        const auto cell = static_cast<Index>(i);
        bool regular = links.creases.empty() || links.creases[i] == 0;
        for (std::size_t side = 0; side < 6; ++side) regular = regular && !links.is_sharp(cell, side);
        for (std::size_t a = 0; a < 6 && regular; ++a) {
            for (std::size_t b = (a / 2 + 1) * 2; b < 6 && regular; ++b) regular = has_four_cells(links, cell, a, b);
        }
        links.regular[i] = regular;
    });
}

/// Colour refinement: cells are coloured by their sides and tags, then cells by their points and points by their cells,
/// whatever their order.
void color_points(const HexMesh& mesh, int rounds, CellLinks& links) {
    std::vector<std::uint64_t> next(mesh.points.size());
    links.colors.assign(mesh.points.size(), 1);
    for (int round = 0; round < rounds; ++round) {
        std::ranges::fill(next, 0);
        parallel_each(mesh.cells.size(), [&](std::size_t c) {
            std::uint64_t color = 0;
            if (round == 0) {
                for (std::size_t side = 0; side < 6; ++side) {
                    color +=
                        (links.neighbors[c][side] == kNone ? 1U : 0U) + (links.is_sharp(static_cast<Index>(c), side) ? 8U : 0U);
                }
                if (!links.creases.empty()) color += 64U * static_cast<unsigned>(std::popcount(links.creases[c]));
            }
            for (const Index p : mesh.cells[c]) color += mixed(links.colors[p]);
            color = mixed(color);
            for (const Index p : mesh.cells[c]) std::atomic_ref(next[p]).fetch_add(color, std::memory_order_relaxed);
        });
        std::swap(links.colors, next);
    }
}

}  // namespace

const std::array<CellTurn, 48>& cell_turns() {
    return kCellTurns;
}

std::uint8_t composed(std::uint8_t first, std::uint8_t second) {
    return kProducts[first][second];
}

namespace {

/// All but the neighbours and their turns, which are there.
void finish_links(const HexMesh& mesh, int color_rounds, CellLinks& links) {
    links.cells_at.assign(mesh.points.size(), 0);
    parallel_each(mesh.cells.size(), [&](std::size_t c) {
        for (const Index p : mesh.cells[c]) std::atomic_ref(links.cells_at[p]).fetch_add(1, std::memory_order_relaxed);
    });
    mark_tags(mesh, links);
    mark_regular(links);
    color_points(mesh, color_rounds, links);
}

}  // namespace

CellLinks build_links(const HexMesh& mesh) {
    CellLinks links;
    if (!SideLists(mesh).link(links) || has_twins(links)) {
        Topology faces;
        faces.point_count = mesh.points.size();
        faces.cells = mesh.cells;
        build_faces(faces);  // throws, and names the cells
    }
    finish_links(mesh, kColorRounds, links);
    return links;
}

CellLinks build_links(const HexMesh& mesh, const Topology& faces, int color_rounds) {
    CellLinks links;
    link_cells(faces, links);
    finish_links(mesh, color_rounds, links);
    return links;
}

}  // namespace subvol::detail
