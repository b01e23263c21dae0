// SPDX-License-Identifier: Apache-2.0
// Where cells of half the size meet a larger cell, corners of theirs lie in the middle of its edges and faces:
//
//      +-------+---+---+        The point h hangs: it is a corner of the two small cells, but not of the large one, so that no
//      |       |   |   |        face of the large cell is one of theirs, and the mesh is open between them.
//      |       h---+---+
//      |       |   |   |
//      +-------+---+---+
//
// Where that is asked for, the large cell becomes a polyhedron with the faces of the small ones. All cells whose edge has a
// hanging point get this point, so neighbours of any size have the same faces.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "assemble.h"
#include "polyhedra.h"
#include "subvol/detail/word_hash.h"

namespace subvol::detail {

namespace {

// The corners of a hexahedron's faces, seen from outside.
constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<std::array<std::size_t, 2>, 12> kEdges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

constexpr int kMostDepth = 8;  // halves of halves

// The points that may hang, by their places. Points inside a mesh of equal cells have eight of them, hanging ones fewer.
class HangingPoints {
public:
    /// with_edges: for `have_edge`
    HangingPoints(const MeshFile& found, bool with_edges) : points_(found.points) {
        std::vector<std::uint8_t> cells(points_.size());
        at_point_.assign(points_.size(), std::numeric_limits<float>::infinity());
        double longest = 0;
        shortest_ = std::numeric_limits<double>::infinity();
        for (const auto& hex : found.hexes.corners) {
            for (const Index p : hex) cells[p] += cells[p] < 8;
            for (const auto& [a, b] : kEdges) {
                const Vec3 along = points_[hex[b]] - points_[hex[a]];
                const double length = glm::dot(along, along);
                for (const Index p : {hex[a], hex[b]}) at_point_[p] = std::min(at_point_[p], static_cast<float>(length));
                if (length > 0) shortest_ = std::min(shortest_, length);
                longest = std::max(longest, length);
            }
        }
        if (!(longest > kHalf * shortest_) || !std::isfinite(longest)) return;
        least_edge_ = kHalf * shortest_;
        width_ = std::sqrt(shortest_) / 64;
        if (!(width_ > 1e-9 * std::sqrt(longest))) return;
        const auto may_hang = [&](std::size_t p) { return cells[p] > 0 && cells[p] < 8; };
        for (std::size_t p = 0; p < points_.size(); ++p) {
            if (may_hang(p))
                places_.emplace(detail::hash_of_place(std::array{cube(points_[p].x), cube(points_[p].y), cube(points_[p].z)}),
                                static_cast<Index>(p));
        }
        if (!with_edges) return;
        for (const auto& hex : found.hexes.corners) {
            for (const auto& [a, b] : kEdges) {
                if (may_hang(hex[a]) && may_hang(hex[b])) edges_.push_back(std::minmax(hex[a], hex[b]));
            }
        }
        std::ranges::sort(edges_);
        edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    }

    [[nodiscard]] bool empty() const { return places_.empty(); }

    /// The point in the middle of some others; kNone if there is none.
    template <class... Corners>
    [[nodiscard]] Index between(Index a, Index b, Corners... others) const {
        const Vec3 along = points_[b] - points_[a];
        // The small cells have edges of half the length at the ends of an edge, which few edges have at both.
        const double length = glm::dot(along, along);
        if (length < least_edge_) return kNone;
        if (sizeof...(others) == 0 && length < kHalf * std::max(at_point_[a], at_point_[b])) return kNone;
        const Vec3 middle = ((points_[a] + points_[b]) + ... + points_[others]) / static_cast<double>(2 + sizeof...(others));
        // The box of the tolerance lies in one cube of the lattice, or in two along an axis.
        const double tolerance = width_ / 16;
        std::array<std::array<double, 2>, 3> cubes;
        for (std::size_t k = 0; k < 3; ++k) {
            const double x = middle[static_cast<int>(k)];
            cubes[k] = {cube(x - tolerance), cube(x + tolerance)};
        }
        for (std::size_t corner = 0; corner < 8; ++corner) {
            std::array<double, 3> at{};
            bool is_new = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t side = corner >> k & 1;
                at[k] = cubes[k][side];
                is_new = is_new && (side == 0 || cubes[k][0] != cubes[k][1]);
            }
            if (!is_new) continue;
            const auto [first, last] = places_.equal_range(detail::hash_of_place(at));
            for (auto place = first; place != last; ++place) {
                if (glm::distance(points_[place->second], middle) <= tolerance) return place->second;
            }
        }
        return kNone;
    }

    /// Whether hexahedra have an edge between two points that may hang, in one piece or in halves.
    [[nodiscard]] bool have_edge(Index a, Index b, int depth = 0) const {
        if (std::ranges::binary_search(edges_, std::pair<Index, Index>(std::minmax(a, b)))) return true;
        const Index middle = depth < kMostDepth ? between(a, b) : kNone;
        return middle != kNone && have_edge(a, middle, depth + 1) && have_edge(middle, b, depth + 1);
    }

    /// Whether a point hangs on an edge of a hexahedron; faces with hanging points have such edges.
    [[nodiscard]] bool touches(const std::array<Index, 8>& hex) const {
        return std::ranges::any_of(kEdges, [&](const auto& edge) { return between(hex[edge[0]], hex[edge[1]]) != kNone; });
    }

private:
    [[nodiscard]] double cube(double x) const { return std::floor(x / width_) + 0.0; }  // -0 is 0
    static constexpr double kHalf = 3.2;  // squared lengths of an edge and of its half, with room for bent edges
    const std::vector<Vec3>& points_;
    std::vector<float> at_point_;  // the square of the shortest edge there
    double shortest_ = 0, least_edge_ = 0, width_ = 0;
    std::unordered_multimap<std::uint64_t, Index> places_;
    std::vector<std::pair<Index, Index>> edges_;  // of hexahedra, between these points; the smaller one first
};

// Appends the points between two corners, without these.
void add_between(const HangingPoints& hanging, Index a, Index b, std::vector<Index>& into, int depth = 0) {
    const Index middle = depth < kMostDepth ? hanging.between(a, b) : kNone;
    if (middle == kNone || middle == a || middle == b) return;
    add_between(hanging, a, middle, into, depth + 1);
    into.push_back(middle);
    add_between(hanging, middle, b, into, depth + 1);
}

// The faces that a quad has with its hanging points: four where small cells meet it, two where these are halves in one
// direction, else one with more points. Points on all sides, without an edge across, are those of cells beside the quad.
void add_faces(const HangingPoints& hanging, const std::array<Index, 4>& quad, CellFaces& faces, int depth = 0) {
    const auto [a, b, c, d] = quad;
    if (depth < kMostDepth) {
        const std::array<Index, 4> sides{hanging.between(a, b), hanging.between(b, c), hanging.between(c, d),
                                         hanging.between(d, a)};
        const auto is_cut = [&](std::size_t k) {
            return sides[k] != kNone && sides[k + 2] != kNone && hanging.have_edge(sides[k], sides[k + 2]);
        };
        const std::array<bool, 2> cut{is_cut(0), is_cut(1)};
        const Index middle = std::ranges::find(sides, kNone) == sides.end() ? hanging.between(a, c, b, d) : kNone;
        if (middle != kNone && cut[0] == cut[1]) {
            for (std::size_t k = 0; k < 4; ++k) {
                add_faces(hanging, {quad[k], sides[k], middle, sides[(k + 3) % 4]}, faces, depth + 1);
            }
            return;
        }
        if (cut[0] != cut[1]) {
            const std::size_t k = cut[0] ? 0 : 1;
            add_faces(hanging, {quad[k], sides[k], sides[k + 2], quad[(k + 3) % 4]}, faces, depth + 1);
            add_faces(hanging, {sides[k], quad[k + 1], quad[k + 2], sides[k + 2]}, faces, depth + 1);
            return;
        }
    }
    auto& face = faces.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
        face.push_back(quad[k]);
        add_between(hanging, quad[k], quad[(k + 1) % 4], face);
    }
}

CellFaces faces_of(const HangingPoints& hanging, const std::array<Index, 8>& hex) {
    CellFaces faces;
    for (const auto& [a, b, c, d] : kFaces) add_faces(hanging, {hex[a], hex[b], hex[c], hex[d]}, faces);
    return faces;
}

bool is_plain(const CellFaces& faces) {
    return faces.size() == 6 && std::ranges::all_of(faces, [](const auto& face) { return face.size() == 4; });
}

// Numbers that the cells have where their reader gave them none.
void number_cells(MeshFile& found) {
    std::size_t next = 0;
    each_kind(found, [&](auto& cells) {
        if (cells.numbers.size() != cells.corners.size()) {
            cells.numbers.resize(cells.corners.size());
            std::iota(cells.numbers.begin(), cells.numbers.end(), static_cast<Index>(next));
        }
        next += cells.corners.size();
    });
}

}  // namespace

void say_hanging_points(MeshFile& found) {
    const HangingPoints hanging(found, false);
    if (hanging.empty()) return;
    std::set<Index> points;
    for (const auto& hex : found.hexes.corners) {
        if (!hanging.touches(hex)) continue;
        for (const auto& [a, b] : kEdges) points.insert(hanging.between(hex[a], hex[b]));
        for (const auto& [a, b, c, d] : kFaces) points.insert(hanging.between(hex[a], hex[c], hex[b], hex[d]));
    }
    points.erase(kNone);
    if (points.empty()) return;
    found.warnings.push_back(
        counted(points.size(), "point hangs", "points hang") +
        " in the middle of edges or faces of larger cells, where the mesh is open: --weld splits these cells");
}

void join_hanging_points(MeshFile& found) {
    const HangingPoints hanging(found, true);
    if (hanging.empty()) return;
    number_cells(found);
    Polyhedra polyhedra;
    std::size_t split = 0;
    std::vector<bool> is_split(found.hexes.corners.size());
    for (std::size_t c = 0; c < found.hexes.corners.size(); ++c) {
        if (!hanging.touches(found.hexes.corners[c])) continue;
        CellFaces faces = faces_of(hanging, found.hexes.corners[c]);
        if (is_plain(faces)) continue;
        polyhedra.add(found.hexes.numbers[c], std::move(faces));
        is_split[c] = true;
        ++split;
    }
    if (split == 0) return;
    drop_where(found.hexes, [&](std::size_t c) { return is_split[c]; });
    found.warnings.push_back(counted(split, "cell", "cells") + " with hanging points split so that all cells fit together");
    polyhedra.take_into(found, false);
}

}  // namespace subvol::detail
