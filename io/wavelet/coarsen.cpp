// SPDX-License-Identifier: Apache-2.0
// In a refined mesh the corners of each cell are an old point, three points of edges, three of faces and, across from the old
// one, the point of a cell. Which corner of one cell is the old point decides it for the cells next to it, and so for all that
// hang together by faces: there are eight ways to try. The right one has eight cells at every point of a cell.
#include "coarsen.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>

#include "subvol/cell.h"
#include "subvol/detail/incident.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using CornerNumber = std::uint8_t;

/// Corners as numbers with a bit for each axis, and back: the same map.
constexpr std::size_t swapped(std::size_t corner) {
    return corner ^ ((corner >> 1) & 1);
}

constexpr std::size_t flip(std::size_t corner, std::size_t axis) {
    return swapped(swapped(corner) ^ (std::size_t{1} << axis));
}

constexpr std::size_t across(std::size_t corner) {
    return swapped(swapped(corner) ^ 7);
}

constexpr std::size_t side_of(std::size_t corner, std::size_t axis) {
    return swapped(corner) >> axis & 1;
}

using GridPlace = std::array<std::int64_t, 3>;

/// Walks from the first cell across faces, with the axes in hand, and gives each cell a place in a grid and its corners in the
/// grid's order. The walk fails if it comes to a cell a second time at another place or in another orientation.
class GridWalk {
public:
    explicit GridWalk(const Topology& topology)
        : t_(topology), corners_(t_.cells.size()), places_(t_.cells.size()), seen_(t_.cells.size(), 0), order_{0} {
        seen_[0] = 1;
        for (CornerNumber k = 0; k < 8; ++k) corners_[0][k] = k;
    }

    /// Whether all cells have been found, each at one place.
    [[nodiscard]] bool run() {
        for (std::size_t next = 0; next < order_.size(); ++next) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (std::size_t side = 0; side < 2; ++side) {
                    if (!step(order_[next], axis, side)) return false;
                }
            }
        }
        return order_.size() == t_.cells.size();
    }

    /// The cells in the order of the grid; nothing if the grid has gaps.
    [[nodiscard]] std::optional<StructuredCells> grid() const {
        const std::size_t n = t_.cells.size();
        GridPlace low = places_[0], high = places_[0];
        for (const GridPlace& p : places_) {
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
        }
        StructuredCells grid;
        std::size_t total = 1;
        for (std::size_t a = 0; a < 3; ++a) {
            grid.counts[a] = static_cast<std::size_t>(high[a] - low[a]) + 1;
            if (grid.counts[a] > n / total) return std::nullopt;  // so that the product does not overflow
            total *= grid.counts[a];
        }
        if (total != n) return std::nullopt;
        grid.cells.assign(n, kNone);
        grid.corners.resize(n);
        for (std::size_t c = 0; c < n; ++c) {
            const auto at = [&](std::size_t a) { return static_cast<std::size_t>(places_[c][a] - low[a]); };
            const std::size_t i = at(0) + grid.counts[0] * (at(1) + grid.counts[1] * at(2));
            if (grid.cells[i] != kNone) return std::nullopt;
            grid.cells[i] = static_cast<Index>(c);
            grid.corners[i] = corners_[c];
        }
        return grid;
    }

private:
    /// The corners of a cell on one of its sides, in the grid's orientation, and the points there.
    struct Side {
        std::array<Index, 4> points;
        std::array<std::size_t, 4> corners;

        [[nodiscard]] bool has(Index p) const { return std::find(points.begin(), points.end(), p) != points.end(); }
    };
    [[nodiscard]] Side side_at(Index cell, std::size_t axis, std::size_t side) const {
        Side found{};
        std::size_t count = 0;
        for (std::size_t k = 0; k < 8; ++k) {
            if (side_of(k, axis) != side) continue;
            found.corners[count] = k;
            found.points[count++] = t_.cells[cell][corners_[cell][k]];
        }
        return found;
    }

    /// The cell on the other side of the face with these points; kNone on the boundary.
    [[nodiscard]] Index across(Index cell, const Side& side) const {
        Index other = kNone;
        for (const Index f : t_.cell_faces[cell]) {
            const auto& face = t_.faces[f];
            const bool same = std::all_of(side.points.begin(), side.points.end(),
                                          [&](Index p) { return std::find(face.begin(), face.end(), p) != face.end(); });
            if (same) other = t_.face_cells[f][0] == cell ? t_.face_cells[f][1] : t_.face_cells[f][0];
        }
        return other;
    }

    /// The corners of the next cell in the grid's orientation: those on the shared side are at the opposite side of the next
    /// cell, and each of the others is the neighbour of one of them that is not on the face.
    [[nodiscard]] std::array<CornerNumber, 8> turned(Index other, const Side& side, std::size_t axis) const {
        std::array<CornerNumber, 8> corners{};
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t near = slot_of(t_.cells[other], side.points[i]);
            corners[flip(side.corners[i], axis)] = static_cast<CornerNumber>(near);
            for (std::size_t b = 0; b < 3; ++b) {
                if (!side.has(t_.cells[other][flip(near, b)])) {
                    corners[side.corners[i]] = static_cast<CornerNumber>(flip(near, b));
                }
            }
        }
        return corners;
    }

    /// Finds the cell across a side, if there is one; false if it contradicts what is known of it.
    [[nodiscard]] bool step(Index cell, std::size_t axis, std::size_t side) {
        const Side shared = side_at(cell, axis, side);
        const Index other = across(cell, shared);
        if (other == kNone) return true;
        const auto corners = turned(other, shared, axis);
        GridPlace place = places_[cell];
        place[axis] += side == 1 ? 1 : -1;
        if (seen_[other] != 0) return places_[other] == place && corners_[other] == corners;
        seen_[other] = 1;
        places_[other] = place;
        corners_[other] = corners;
        order_.push_back(other);
        return true;
    }

    const Topology& t_;
    std::vector<std::array<CornerNumber, 8>> corners_;
    std::vector<GridPlace> places_;
    std::vector<std::uint8_t> seen_;
    std::vector<Index> order_;
};

}  // namespace

std::optional<StructuredCells> structured_cells(const Topology& t) {
    GridWalk walk(t);
    return walk.run() ? walk.grid() : std::nullopt;
}

namespace {

constexpr CornerNumber kUnknown = 255;

enum Kind : std::uint8_t { OldPoint, EdgePoint, FacePoint, CellPoint, NoPoint };

Kind kind_of(std::size_t corner, std::size_t old_corner) {
    const std::size_t differing = swapped(corner) ^ swapped(old_corner);
    return static_cast<Kind>((differing & 1) + (differing >> 1 & 1) + (differing >> 2 & 1));
}

class Coarsener {
public:
    Coarsener(const HexMesh& fine, const Topology& topology)
        : fine_(fine), t_(topology), old_corner_(fine.cells.size(), kUnknown), kind_(topology.point_count, NoPoint) {}

    std::optional<CoarserMesh> run(std::string& why) {
        for (Index c = 0; c < t_.cells.size(); ++c) {
            if (old_corner_[c] == kUnknown && !choose_part(c, why)) return std::nullopt;
        }
        if (!make_cells(why) || !coarsen_tags(why)) return std::nullopt;
        return std::move(coarse_);
    }

private:
    /// Decides the cells that hang together with one.
    bool choose_part(Index first, std::string& why) {
        for (CornerNumber k = 0; k < 8; ++k) {
            std::string reason;
            if (spread(first, k, reason) && complete(reason)) return true;
            if (k == 0 || why.empty()) why = reason;
            for (const Index c : part_) old_corner_[c] = kUnknown;
            for (const Index p : marked_) kind_[p] = NoPoint;
        }
        return false;
    }

    bool mark(Index cell, std::string& why) {
        for (std::size_t k = 0; k < 8; ++k) {
            const Index p = t_.cells[cell][k];
            const Kind kind = kind_of(k, old_corner_[cell]);
            if (kind_[p] == NoPoint) {
                kind_[p] = kind;
                marked_.push_back(p);
            } else if (kind_[p] != kind) {
                why = "around point " + std::to_string(p) + " the cells do not alternate";
                return false;
            }
        }
        return true;
    }

    bool spread(Index first, CornerNumber corner, std::string& why) {
        part_.assign(1, first);
        marked_.clear();
        old_corner_[first] = corner;
        if (!mark(first, why)) return false;
        for (std::size_t next = 0; next < part_.size(); ++next) {
            const Index c = part_[next];
            for (const Index f : t_.cell_faces[c]) {
                const auto& [a, b] = t_.face_cells[f];
                const Index other = a == c ? b : a;
                if (other == kNone || old_corner_[other] != kUnknown) continue;
                old_corner_[other] = corner_across(c, f, other);
                part_.push_back(other);
                if (!mark(other, why)) return false;
            }
        }
        return true;
    }

    /// A face of a small cell has either its old point or the point of a cell.
    [[nodiscard]] CornerNumber corner_across(Index cell, Index face, Index other) const {
        const Index old_point = t_.cells[cell][old_corner_[cell]];
        const auto& quad = t_.faces[face];
        if (std::find(quad.begin(), quad.end(), old_point) != quad.end()) {
            return static_cast<CornerNumber>(slot_of(t_.cells[other], old_point));
        }
        return static_cast<CornerNumber>(across(slot_of(t_.cells[other], t_.cells[cell][across(old_corner_[cell])])));
    }

    bool complete(std::string& why) const {
        std::vector<Index> centers;
        for (const Index c : part_) centers.push_back(t_.cells[c][across(old_corner_[c])]);
        std::sort(centers.begin(), centers.end());
        for (std::size_t i = 0; i < centers.size();) {
            std::size_t n = 1;
            while (i + n < centers.size() && centers[i + n] == centers[i]) ++n;
            if (n != 8) {
                why = "point " + std::to_string(centers[i]) + " would be the middle of " + std::to_string(n) +
                      (n == 1 ? " cell" : " cells") + " instead of 8: a row of cells has an odd number";
                return false;
            }
            i += n;
        }
        return true;
    }

    bool make_cells(std::string& why) {
        std::vector<Index> number(t_.point_count, kNone);
        for (std::size_t p = 0; p < t_.point_count; ++p) {
            if (kind_[p] != OldPoint) continue;
            number[p] = static_cast<Index>(coarse_.points.size());
            coarse_.points.push_back(static_cast<Index>(p));
            coarse_.mesh.points.push_back(fine_.points[p]);
        }
        std::vector<Index> group(t_.point_count, kNone);
        std::vector<std::array<Index, 8>> groups;  // in the order of their first cells
        std::vector<std::uint8_t> sizes;
        for (Index c = 0; c < t_.cells.size(); ++c) {
            Index& g = group[t_.cells[c][across(old_corner_[c])]];
            if (g == kNone) {
                g = static_cast<Index>(groups.size());
                groups.emplace_back();
                sizes.push_back(0);
            }
            groups[g][sizes[g]++] = c;
        }
        for (const auto& cells : groups) {
            if (!make_cell(cells, number)) {
                why = "the eight cells at point " + std::to_string(t_.cells[cells[0]][across(old_corner_[cells[0]])]) +
                      " are not those of a hexahedron";
                return false;
            }
        }
        return true;
    }

    /// The point of a face that the middle of a coarse cell has as its neighbour in one of its small cells, along an axis of
    /// that.
    [[nodiscard]] Index face_point(Index cell, std::size_t axis) const {
        return t_.cells[cell][flip(across(old_corner_[cell]), axis)];
    }

    bool make_cell(const std::array<Index, 8>& cells, std::span<const Index> number) {
        // The first small cell gives the axes. Opposite face points never belong to one small cell.
        std::array<std::array<Index, 2>, 3> ends;
        for (std::size_t a = 0; a < 3; ++a) {
            const Index face = face_point(cells[0], a);
            Index opposite = kNone;
            for (const Index c : cells) {
                for (std::size_t b = 0; b < 3; ++b) {
                    const Index p = face_point(c, b);
                    if (p != face && !together(cells, face, p)) {
                        if (opposite != kNone && opposite != p) return false;
                        opposite = p;
                    }
                }
            }
            if (opposite == kNone) return false;
            const std::size_t side = side_of(old_corner_[cells[0]], a);
            ends[a][side] = face;
            ends[a][1 - side] = opposite;
        }
        std::array<Index, 8> corners, children;
        std::array<std::array<CornerNumber, 8>, 8> turned{};
        corners.fill(kNone);
        for (const Index c : cells) {
            std::size_t bits = 0;
            std::array<std::size_t, 3> local{3, 3, 3};  // the small cell's axis along each axis of the coarse cell
            for (std::size_t b = 0; b < 3; ++b) {
                const Index p = face_point(c, b);
                for (std::size_t a = 0; a < 3; ++a) {
                    for (std::size_t side = 0; side < 2; ++side) {
                        if (ends[a][side] != p) continue;
                        local[a] = b;
                        bits |= side << a;
                    }
                }
            }
            if (std::find(local.begin(), local.end(), 3) != local.end()) return false;
            const std::size_t k = swapped(bits);
            if (corners[k] != kNone) return false;
            corners[k] = number[t_.cells[c][old_corner_[c]]];
            children[k] = c;
            for (std::size_t q = 0; q < 8; ++q) {
                std::size_t corner = old_corner_[c];
                for (std::size_t a = 0; a < 3; ++a) {
                    if (side_of(q, a) != side_of(k, a)) corner = flip(corner, local[a]);
                }
                turned[k][q] = static_cast<CornerNumber>(corner);
            }
        }
        for (std::size_t k = 0; k < 8; ++k) {
            if (std::count(corners.begin(), corners.end(), corners[k]) != 1) return false;
        }
        coarse_.mesh.cells.push_back(corners);
        coarse_.children.push_back(children);
        coarse_.corners.push_back(turned);
        return true;
    }

    [[nodiscard]] bool together(const std::array<Index, 8>& cells, Index p, Index q) const {
        return std::any_of(cells.begin(), cells.end(), [&](Index c) {
            bool has_p = false, has_q = false;
            for (std::size_t a = 0; a < 3; ++a) {
                has_p = has_p || face_point(c, a) == p;
                has_q = has_q || face_point(c, a) == q;
            }
            return has_p && has_q;
        });
    }

    /// A crease is one of the coarse mesh if both of its halves are; a sharp face if its quarters are.
    bool coarsen_tags(std::string& why) {
        std::vector<Index> number(t_.point_count, kNone);
        for (Index i = 0; i < coarse_.points.size(); ++i) number[coarse_.points[i]] = i;
        std::map<Index, std::vector<Index>> halves;
        for (const auto& [a, b] : fine_.creases) {
            const bool a_old = kind_[a] == OldPoint;
            const Index old_point = a_old ? a : b, middle = a_old ? b : a;
            if (kind_[old_point] != OldPoint || kind_[middle] != EdgePoint) return refuse_tags(why);
            halves[middle].push_back(number[old_point]);
        }
        for (const auto& [middle, ends] : halves) {
            if (ends.size() != 2) return refuse_tags(why);
            coarse_.mesh.creases.push_back({std::min(ends[0], ends[1]), std::max(ends[0], ends[1])});
        }
        std::sort(coarse_.mesh.creases.begin(), coarse_.mesh.creases.end());
        std::map<Index, std::vector<std::array<Index, 3>>> quarters;  // old point, then the edge points beside it
        for (const auto& quad : fine_.sharp_faces) {
            const auto middle = std::find_if(quad.begin(), quad.end(), [&](Index p) { return kind_[p] == FacePoint; });
            if (middle == quad.end()) return refuse_tags(why);
            const auto k = static_cast<std::size_t>(middle - quad.begin());
            const Index old_point = quad[(k + 2) % 4];
            if (kind_[old_point] != OldPoint) return refuse_tags(why);
            quarters[*middle].push_back({number[old_point], quad[(k + 1) % 4], quad[(k + 3) % 4]});
        }
        for (auto& [middle, parts] : quarters) {
            if (parts.size() != 4) return refuse_tags(why);
            std::array<Index, 4> face{parts[0][0]};
            Index edge = parts[0][1];
            std::array<bool, 4> used{true};
            for (std::size_t i = 1; i < 4; ++i) {
                std::size_t next = 4;
                for (std::size_t j = 1; j < 4; ++j) {
                    if (!used[j] && (parts[j][1] == edge || parts[j][2] == edge)) next = j;
                }
                if (next == 4) return refuse_tags(why);
                used[next] = true;
                face[i] = parts[next][0];
                edge = parts[next][1] == edge ? parts[next][2] : parts[next][1];
            }
            coarse_.mesh.sharp_faces.push_back(face);
        }
        return true;
    }

    static bool refuse_tags(std::string& why) {
        why = "creases or sharp faces end inside of a coarser cell's edge or face";
        return false;
    }

    const HexMesh& fine_;
    const Topology& t_;
    std::vector<CornerNumber> old_corner_;  // of each cell
    std::vector<Kind> kind_;                // of each point
    std::vector<Index> part_, marked_;
    CoarserMesh coarse_;
};

}  // namespace

std::optional<CoarserMesh> coarser_mesh(const HexMesh& fine, std::string& why) {
    why.clear();
    if (fine.cells.size() % 8 != 0) {
        why = std::to_string(fine.cells.size()) + " cells are not a multiple of 8";
        return std::nullopt;
    }
    return Coarsener(fine, build_topology(fine)).run(why);
}

}  // namespace subvol::detail
