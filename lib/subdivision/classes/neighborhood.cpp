// SPDX-License-Identifier: Apache-2.0
// The code of a cell's surroundings: what a scheme's weights depend on, and nothing else.
//
// The walk begins at the cell, along the turn by which the colours of its corners come in the least order, and goes breadth
// first, at each cell to the sides 0 to 5 in the axes of the walk:
//
//           ┌───┬───┬───┐
//           │ 6 │ 4 │ 8 │        a cell in the middle, the cells across its sides, then those across the sides of these, as far
//           ├───┼───┼───┤        as they have one of the points around which all cells are wanted. Points are numbered as the
//           │ 1 │ 0 │ 2 │        walk comes to them.
//           ├───┼───┼───┤
//           │ 5 │ 3 │ 7 │        code = number of cells of the first layer,
//           └───┴───┴───┘               eight points of each cell, by octants of the walk,
//                                       0xffff and for each cell its tagged edges and sides, if one has any
//
// Two cells whose surroundings meet in the same way get the same code if they start with the same turn. Where colours are equal
// by symmetry any of these turns gives the same code; where they are equal by chance, the class is made twice, which costs a
// table and changes no result.
//
// A walk goes through faces. Cells that touch the others in an edge or a point alone are not found; `is_complete` notices by
// the number of cells at each point, and the cell then has no class.
#include "subvol/detail/neighborhood.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostPoints = 1500, kMostCells = 1000;  // more is left to refinement
// Cells around a point, as around an axis of 32 faces: rows of classes would have all of them, where those of a refinement have
// sums (ring_sums.h).
constexpr std::size_t kMostAround = 64;

}  // namespace

NeighborhoodWalk::NeighborhoodWalk(const HexMesh& mesh, const CellLinks& links)
    : mesh_(mesh),
      links_(links),
      cell_marks_(mesh.cells.size(), 0),
      point_marks_(mesh.points.size(), 0),
      numbers_(mesh.points.size(), 0) {
}

/// Forgets the walk before. Marks are numbers of walks, so that nothing has to be cleared until the numbers run out.
void NeighborhoodWalk::start(Neighborhood& found) {
    visited_.clear();
    cells_found_.clear();
    found.points.clear();
    found.code.assign(1, 0);
    if (++mark_ != 0) return;
    std::ranges::fill(cell_marks_, 0);
    std::ranges::fill(point_marks_, 0);
    mark_ = 1;
}

/// The number of a point in the walk; the next one if it is new.
std::uint16_t NeighborhoodWalk::number(Index point, Neighborhood& found) {
    if (point_marks_[point] != mark_) {
        point_marks_[point] = mark_;
        numbers_[point] = static_cast<std::uint16_t>(found.points.size());
        found.points.push_back(point);
        cells_found_.push_back(0);
    }
    return numbers_[point];
}

/// The turn by which the colours of the corners come in the least order.
std::uint8_t NeighborhoodWalk::first_turn(Index cell) const {
    std::array<std::uint64_t, 8> colors;  // by the cell's octants
    for (std::size_t octant = 0; octant < 8; ++octant)
        colors[octant] = links_.colors[mesh_.cells[cell][kCornerOctants[octant]]];
    std::uint8_t best = 0;
    for (std::uint8_t turn = 1; turn < 48; ++turn) {
        const auto& a = cell_turns()[turn].octants;
        const auto& b = cell_turns()[best].octants;
        std::size_t k = 0;
        while (k < 8 && colors[a[k]] == colors[b[k]]) ++k;
        if (k < 8 && colors[a[k]] < colors[b[k]]) best = turn;
    }
    return best;
}

void NeighborhoodWalk::add_first(Index cell, Neighborhood& found) {
    cell_marks_[cell] = mark_;
    found.turn = first_turn(cell);
    visited_.push_back({cell, found.turn});
    for (const std::size_t octant : cell_turns()[found.turn].octants) {
        const std::uint16_t n = number(mesh_.cells[cell][kCornerOctants[octant]], found);
        found.code.push_back(n);
        ++cells_found_[n];
    }
}

/// Adds the cell across a side of a visited one, if it is new; false if there are too many.
bool NeighborhoodWalk::add(std::size_t from, std::size_t side, Neighborhood& found) {
    const auto [cell, turn] = visited_[from];
    const std::size_t own_side = cell_turns()[turn].sides[side];
    const Index next = links_.neighbors[cell][own_side];
    if (next == kNone || cell_marks_[next] == mark_) return true;
    if (visited_.size() >= kMostCells || found.points.size() + 4 > kMostPoints) return false;
    cell_marks_[next] = mark_;
    const std::uint8_t next_turn = composed(turn, links_.turn(cell, own_side));
    visited_.push_back({next, next_turn});
    // Beyond an upper side the new cell has the shared points at its lower octants, and the other way round: those points have
    // numbers already, at the octants of the cell before with this bit flipped.
    const std::size_t bit = std::size_t{1} << (side / 2), shared = (side & 1) != 0 ? 0 : bit;
    const auto& octants = cell_turns()[next_turn].octants;
    const auto& corners = mesh_.cells[next];
    const std::size_t first = 1 + 8 * from;
    for (std::size_t octant = 0; octant < 8; ++octant) {
        const bool is_shared = (octant & bit) == shared;
        const std::uint16_t n =
            is_shared ? found.code[first + (octant ^ bit)] : number(corners[kCornerOctants[octants[octant]]], found);
        found.code.push_back(n);
        ++cells_found_[n];
    }
    return true;
}

/// Adds the cells around the first `points` points, from each such cell across the sides that have one of them; false if there
/// are too many.
bool NeighborhoodWalk::walk_layer(std::size_t points, Neighborhood& found) {
    for (std::size_t i = 0; i < visited_.size(); ++i) {
        unsigned near = 0;  // octants at one of the points
        for (std::size_t octant = 0; octant < 8; ++octant) near |= unsigned{found.code[1 + 8 * i + octant] < points} << octant;
        constexpr std::array<unsigned, 6> kOctantsOfSide{0x55, 0xaa, 0x33, 0xcc, 0x0f, 0xf0};
        for (std::size_t side = 0; side < 6; ++side) {
            if ((near & kOctantsOfSide[side]) != 0 && !add(i, side, found)) return false;
        }
    }
    return true;
}

/// Whether all cells around the first `points` points have been found.
bool NeighborhoodWalk::is_complete(std::size_t points, const Neighborhood& found) const {
    for (std::size_t p = 0; p < points; ++p) {
        if (cells_found_[p] != links_.cells_at[found.points[p]]) return false;
    }
    return true;
}

/// The edge of kCellEdges between two corners.
constexpr auto kEdgesBetween = [] {
    std::array<std::array<std::uint8_t, 8>, 8> edges{};
    for (std::size_t k = 0; k < 12; ++k) {
        const auto [a, b] = kCellEdges[k];
        edges[a][b] = edges[b][a] = static_cast<std::uint8_t>(k);
    }
    return edges;
}();

/// The tagged edges of a cell as those of the walk.
std::uint16_t turned_edges(std::uint16_t own, const CellTurn& turn) {
    std::uint16_t edges = 0;
    for (std::size_t k = 0; k < 12 && own != 0; ++k) {
        // The walk's edge k is the cell's edge between the corners at which its ends lie.
        const auto corner = [&](std::size_t c) { return kCornerOctants[turn.octants[kCornerOctants[c]]]; };
        const std::uint8_t e = kEdgesBetween[corner(kCellEdges[k][0])][corner(kCellEdges[k][1])];
        edges |= static_cast<std::uint16_t>((own >> e & 1U) << k);
    }
    return edges;
}

/// After the cells: the tagged edges and sides of each, if one of them has any.
void NeighborhoodWalk::add_tags(Neighborhood& found) const {
    if (links_.creases.empty() && mesh_.sharp_faces.empty()) return;
    const std::size_t untagged = found.code.size();
    bool tagged = false;
    found.code.push_back(0xffff);
    for (const auto& [cell, turned] : visited_) {
        const CellTurn& turn = cell_turns()[turned];
        const std::uint16_t edges = links_.creases.empty() ? std::uint16_t{0} : turned_edges(links_.creases[cell], turn);
        std::uint16_t sides = 0;
        for (std::size_t side = 0; side < 6; ++side) {
            if (links_.is_sharp(cell, turn.sides[side])) sides |= static_cast<std::uint16_t>(1U << side);
        }
        found.code.push_back(edges);
        found.code.push_back(sides);
        tagged |= (edges | sides) != 0;
    }
    if (!tagged) found.code.resize(untagged);
}

/// The first layer are the cells around the eight corners, the second those around all points of the first.
bool NeighborhoodWalk::find(Index cell, int layers, Neighborhood& found) {
    start(found);
    add_first(cell, found);
    const auto many_at = [&](Index p) { return links_.cells_at[p] > kMostAround; };
    if (std::ranges::any_of(found.points, many_at)) return false;
    if (!walk_layer(8, found) || !is_complete(8, found)) return false;
    found.code[0] = static_cast<std::uint16_t>(visited_.size());
    const std::size_t near = found.points.size();
    if (layers > 1 && std::ranges::any_of(found.points, many_at)) return false;
    if (layers > 1 && (!walk_layer(near, found) || !is_complete(near, found))) return false;
    add_tags(found);
    return true;
}

constexpr std::size_t kPointsOfTwoLayers = 216;

/// The points of 27 cells, each one or two steps off along each axis, are those of the neighbourhood; without the second layer
/// those of the eight cells one step off along all axes.
struct GridCorner {
    std::array<std::size_t, 3> at;  // 0, 1 or 2 along each axis; 1: the middle

    explicit GridCorner(std::size_t n) : at{n % 3, n / 3 % 3, n / 9} {}
    [[nodiscard]] bool is_off_all_axes() const { return at[0] != 1 && at[1] != 1 && at[2] != 1; }
    /// layers: in whose points the cell of this corner lies
    [[nodiscard]] std::size_t point(std::size_t octant, std::size_t layers) const {
        const std::size_t side = 2 * layers + 2;
        const auto along = [&](std::size_t axis) { return layers * at[axis] + (octant >> axis & 1); };
        return along(0) + side * (along(1) + side * along(2));
    }
};

/// Cells with four cells around each edge leave open how many meet at a corner that only one of them has.
bool NeighborhoodWalk::eight_cells_meet(std::span<const Index> points) const {
    const bool all = points.size() == kPointsOfTwoLayers;
    for (std::size_t n = 0; n < 64; ++n) {
        const std::size_t inner = all ? n % 4 + 1 + 6 * (n / 4 % 4 + 1) + 36 * (n / 16 + 1) : n;
        if (links_.cells_at[points[inner]] != 8) return false;
    }
    return true;
}

/// As find_regular below, for cells whose axes lie alike, as most do: then there are no turns to be multiplied. None if they do
/// not.
std::optional<bool> NeighborhoodWalk::find_aligned(Index cell, std::span<Index> points) const {
    bool turned = false;
    const auto step = [&](Index from, std::size_t axis, std::size_t at) {
        const std::size_t side = 2 * axis + at / 2;
        turned |= links_.turns[from][side] != kIdentityTurn;
        return links_.neighbors[from][side];
    };
    if (!links_.regular[cell]) return false;
    std::array<Index, 27> near;
    constexpr std::array<std::size_t, 27> kOrder{13, 12, 14, 10, 9,  11, 16, 15, 17, 4,  3,  5,  1, 0,
                                                 2,  7,  6,  8,  22, 21, 23, 19, 18, 20, 25, 24, 26};
    for (const std::size_t n : kOrder) {
        const GridCorner corner(n);  // reached from the cell before it along the last axis on which it is off the middle
        near[n] = cell;
        if (n == 13) continue;
        const std::size_t axis = corner.at[2] != 1 ? 2 : corner.at[1] != 1 ? 1 : 0;
        constexpr std::array<std::size_t, 3> kStrides{1, 3, 9};
        near[n] = step(near[n - corner.at[axis] * kStrides[axis] + kStrides[axis]], axis, corner.at[axis]);
        if (turned) return {};
        if (!links_.regular[near[n]]) return false;
    }
    const std::size_t layers = points.size() == kPointsOfTwoLayers ? 2 : 1;
    for (std::size_t n = 0; n < 27; ++n) {
        const GridCorner corner(n);
        if (layers == 1 && !corner.is_off_all_axes()) continue;
        Index far = near[n];
        for (std::size_t axis = 0; layers == 2 && axis < 3; ++axis) {
            if (corner.at[axis] != 1) far = step(far, axis, corner.at[axis]);
            if (turned) return {};
            if (far == kNone) return false;
        }
        for (std::size_t octant = 0; octant < 8; ++octant) {
            points[corner.point(octant, layers)] = mesh_.cells[far][kCornerOctants[octant]];
        }
    }
    return eight_cells_meet(points);
}

bool NeighborhoodWalk::find_regular(Index cell, std::span<Index> points) const {
    if (const auto aligned = find_aligned(cell, points)) return *aligned;
    const auto step = [&](Visited from, std::size_t side) -> Visited {
        if (from.cell == kNone) return from;
        const std::size_t own = cell_turns()[from.turn].sides[side];
        return {links_.neighbors[from.cell][own], composed(from.turn, links_.turn(from.cell, own))};
    };
    // From the middle along u, then v, then w: cell i + 3j + 9k lies one step off along each axis where i, j, k is 0 or 2.
    std::array<Visited, 27> near;
    for (std::size_t n = 0; n < 27; ++n) {
        const std::array<std::size_t, 3> at{n % 3, n / 3 % 3, n / 9};
        Visited now{cell, kIdentityTurn};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!links_.regular[now.cell]) return false;
            if (at[axis] != 1) now = step(now, 2 * axis + at[axis] / 2);
        }
        if (!links_.regular[now.cell]) return false;
        near[n] = now;
    }
    const std::size_t layers = points.size() == kPointsOfTwoLayers ? 2 : 1;
    for (std::size_t n = 0; n < 27; ++n) {
        const GridCorner corner(n);
        if (layers == 1 && !corner.is_off_all_axes()) continue;
        Visited now = near[n];
        for (std::size_t axis = 0; layers == 2 && axis < 3; ++axis) {  // two steps off
            if (corner.at[axis] != 1) now = step(now, 2 * axis + corner.at[axis] / 2);
            if (now.cell == kNone) return false;
        }
        const auto& octants = cell_turns()[now.turn].octants;
        for (std::size_t octant = 0; octant < 8; ++octant) {
            points[corner.point(octant, layers)] = mesh_.cells[now.cell][kCornerOctants[octants[octant]]];
        }
    }
    return eight_cells_meet(points);
}

/// The code read back as a mesh: its cells with their corners in VTK's order, and its tags.
Patch patch_of(const Neighborhood& neighborhood) {
    const auto& code = neighborhood.code;
    const auto tags = static_cast<std::size_t>(std::find(code.begin() + 1, code.end(), 0xffff) - code.begin());
    Patch patch{.mesh = {}, .wanted = 1, .first_layer = code[0]};
    patch.mesh.points.assign(neighborhood.points.size(), Vec3(0.0));
    for (std::size_t first = 1; first < tags; first += 8) {
        auto& cell = patch.mesh.cells.emplace_back();
        for (std::size_t k = 0; k < 8; ++k) cell[k] = code[first + kCornerOctants[k]];
    }
    for (std::size_t i = 0; tags < code.size() && i < patch.mesh.cells.size(); ++i) {
        const auto& cell = patch.mesh.cells[i];
        for (std::size_t k = 0; k < 12; ++k) {
            if ((code[tags + 1 + 2 * i] >> k & 1) == 0) continue;
            const Index a = cell[kCellEdges[k][0]], b = cell[kCellEdges[k][1]];
            patch.mesh.creases.push_back({std::min(a, b), std::max(a, b)});
        }
        for (std::size_t side = 0; side < 6; ++side) {
            if ((code[tags + 2 + 2 * i] >> side & 1) == 0) continue;
            auto& face = patch.mesh.sharp_faces.emplace_back();
            for (std::size_t k = 0; k < 4; ++k) face[k] = cell[kCellFaces[side][k]];
        }
    }
    // Cells share edges, so a crease is met once for each of its cells. A sharp face is met twice; the refinement takes both
    // for one.
    const auto unique = [](auto& list) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    unique(patch.mesh.creases);
    return patch;
}

}  // namespace subvol::detail
