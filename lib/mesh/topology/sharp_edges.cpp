// SPDX-License-Identifier: Apache-2.0
// Which edges of the boundary are sharp.
//
// A body of right angles and an O-grid of eight cells around bend by similar angles at their edges. What tells them apart is
// how the boundary goes on behind the two faces of an edge, here seen along it:
//
//        chamfer                 curve
//     ─────────●                 ●───●          the far edges of the two faces at ● bend as ● does: a curve
//               ╲              ╱       ╲
//                ●            ●         ●       one of them does not bend, or turns the other way: sharp
//                │            │         │
//
// The far edge of a quad is the one opposite. A triangle has two, and where a side of it is flat and a triangle lies beyond, as
// in a quad that was cut, also those of that triangle: the one that is most alike decides.
#include "subvol/sharp_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/cell_splits.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/facets.h"

namespace subvol::detail {
namespace {

/// A bend below this is none: planes that are given with few digits.
constexpr double kFlatDeg = 1;
/// Regular polygons of nine and six sides bend by the two angles, up to rounding.
constexpr double kRoundingDeg = 1e-3;
/// How much wider than the other a face of a curve may be; a chamfer between wide faces is more.
constexpr double kMostWider = 2;

/// A side of a cell. key: its corners, ascending, the last of a triangle kNone
struct FacetOfCell {
    std::array<Index, 4> key;
    Index cell;
    std::uint8_t side;
    auto operator<=>(const FacetOfCell&) const = default;
};

/// The corners of a side in cyclic order. places: of these among the corners of the cell; a triangle repeats its last one
template <std::size_t N>
std::array<Index, 4> corners_of(const std::array<Index, N>& cell, const std::array<std::size_t, 4>& places) {
    const auto& [i, j, k, l] = places;
    return {cell[i], cell[j], cell[k], k == l ? kNone : cell[l]};
}

/// The cells of all kinds, counted through.
class AllCells {
public:
    AllCells(std::span<const std::array<Index, 8>> hexes, const MixedCells& others) : hexes_(hexes), others_(others) {}

    [[nodiscard]] std::size_t size() const {
        return hexes_.size() + others_.tets.size() + others_.prisms.size() + others_.pyramids.size();
    }

    /// Calls call(corners of the cell, its sides by their places in the corners).
    template <class Call>
    void with(std::size_t cell, const Call& call) const {
        static constexpr std::array<std::array<std::size_t, 4>, 5> kPyramidSides{
            {{0, 3, 2, 1}, {0, 1, 4, 4}, {1, 2, 4, 4}, {2, 3, 4, 4}, {3, 0, 4, 4}}};
        std::size_t k = cell;
        if (k < hexes_.size()) return call(hexes_[k], kHexShape.faces);
        k -= hexes_.size();
        if (k < others_.tets.size()) return call(others_.tets[k], kTetShape.faces);
        k -= others_.tets.size();
        if (k < others_.prisms.size()) return call(others_.prisms[k], kPrismShape.faces);
        call(others_.pyramids[k - others_.prisms.size()], kPyramidSides);
    }

private:
    std::span<const std::array<Index, 8>> hexes_;
    const MixedCells& others_;
};

/// A facet of the boundary, or between the cells of two parts. normal: outward from the cell, of any length; parts: that of the
/// cell, and the one beyond; of a facet of the boundary kNone
struct Facet {
    std::array<Index, 4> corners;
    Index cell;
    std::array<Index, 2> parts;
    Vec3 normal, center;

    [[nodiscard]] std::size_t sides() const { return corners[3] == kNone ? 3 : 4; }
    /// The two points of a side, the smaller first.
    [[nodiscard]] std::array<Index, 2> edge(std::size_t side) const {
        const Index a = corners[side], b = corners[(side + 1) % sides()];
        return {std::min(a, b), std::max(a, b)};
    }
};

/// A facet by its corners; which side is outside, the middle of the cell decides, since cells may be of either hand.
template <std::size_t N>
Facet facet_of(std::span<const Vec3> points, const FacetOfCell& found, const std::array<Index, N>& cell,
               const std::array<std::size_t, 4>& places) {
    Facet facet{corners_of(cell, places), found.cell, {kNone, kNone}, {}, Vec3(0.0)};
    const auto at = [&](std::size_t k) { return points[facet.corners[k]]; };
    for (std::size_t k = 0; k < facet.sides(); ++k) facet.center += at(k) / static_cast<double>(facet.sides());
    facet.normal = facet.sides() == 3 ? glm::cross(at(1) - at(0), at(2) - at(0)) : glm::cross(at(2) - at(0), at(3) - at(1));
    Vec3 middle(0.0);
    for (const Index p : cell) middle += points[p] / static_cast<double>(N);
    if (glm::dot(facet.normal, facet.center - middle) < 0) facet.normal = -facet.normal;
    return facet;
}

/// Facets of the boundary, and those between cells of different parts.
struct Facets {
    std::vector<Facet> outside, between;
};

/// parts: of each cell; empty: there are none
Facets facets_of(std::span<const Vec3> points, const AllCells& cells, std::span<const Index> parts) {
    const auto sorted = bucket_sort<FacetOfCell>(
        cells.size(), points.size(),
        [&](std::size_t c, const auto& sink) {
            cells.with(c, [&](const auto& corners, const auto& sides) {
                for (std::size_t k = 0; k < sides.size(); ++k) {
                    FacetOfCell side{corners_of(corners, sides[k]), static_cast<Index>(c), static_cast<std::uint8_t>(k)};
                    std::sort(side.key.begin(), side.key.end());
                    sink(side);
                }
            });
        },
        [](const FacetOfCell& side) { return side.key[0]; });
    const auto& all = sorted.records;
    const auto starts = group_starts(all, [](const auto& a, const auto& b) { return a.key == b.key; });
    const auto is_outside = [&](std::size_t f) { return starts[f + 1] - starts[f] == 1; };
    const auto is_between = [&](std::size_t f) {
        return starts[f + 1] - starts[f] == 2 && parts[all[starts[f]].cell] != parts[all[starts[f] + 1].cell];
    };
    const auto made = [&](const std::vector<std::size_t>& chosen) {
        std::vector<Facet> facets(chosen.size());
        parallel_each(chosen.size(), [&](std::size_t i) {
            const FacetOfCell& side = all[starts[chosen[i]]];
            cells.with(side.cell, [&](const auto& corners, const auto& sides) {
                facets[i] = facet_of(points, side, corners, sides[side.side]);
            });
        });
        return facets;
    };
    Facets facets{made(numbers_where<std::vector<std::size_t>>(starts.size() - 1, is_outside)), {}};
    if (parts.empty()) return facets;
    const auto chosen = numbers_where<std::vector<std::size_t>>(starts.size() - 1, is_between);
    facets.between = made(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        Facet& facet = facets.between[i];
        facet.parts = {parts[all[starts[chosen[i]]].cell], parts[all[starts[chosen[i]] + 1].cell]};
        if (facet.parts[0] < facet.parts[1]) continue;
        std::swap(facet.parts[0], facet.parts[1]);
        facet.normal = -facet.normal;
    }
    return facets;
}

/// A side of a facet.
struct Side {
    Index facet = kNone;
    std::uint8_t number = 0;
    auto operator<=>(const Side&) const = default;
};

/// The boundary, or the facets between parts, with the bends at its edges.
class BentBoundary {
public:
    BentBoundary(std::span<const Vec3> points, std::vector<Facet>&& facets)
        : points_(points), facets_(std::move(facets)), beyond_(facets_.size()), bends_(facets_.size()) {
        struct EdgeOfFacet {
            std::array<Index, 2> ends;
            Side side;
            auto operator<=>(const EdgeOfFacet&) const = default;
        };
        const auto sorted = bucket_sort<EdgeOfFacet>(
            facets_.size(), points.size(),
            [&](std::size_t f, const auto& sink) {
                for (std::uint8_t k = 0; k < facets_[f].sides(); ++k) {
                    sink(EdgeOfFacet{facets_[f].edge(k), {static_cast<Index>(f), k}});
                }
            },
            [](const EdgeOfFacet& edge) { return edge.ends[0]; });
        const auto starts = group_starts(sorted.records, [](const auto& a, const auto& b) { return a.ends == b.ends; });
        // At other edges bodies touch, or three parts: they are creases without a tag.
        const auto joins_two = [&](std::size_t e) {
            if (starts[e + 1] - starts[e] != 2) return false;
            const auto* const records = sorted.records.data() + starts[e];
            return facets_[records[0].side.facet].parts == facets_[records[1].side.facet].parts;
        };
        parallel_each(starts.size() - 1, [&](std::size_t e) {
            if (!joins_two(e)) return;
            const Side one = sorted.records[starts[e]].side, other = sorted.records[starts[e] + 1].side;
            beyond_[one.facet][one.number] = other;
            beyond_[other.facet][other.number] = one;
            bends_[one.facet][one.number] = bends_[other.facet][other.number] = bend(facets_[one.facet], facets_[other.facet]);
        });
        for (std::size_t e = 0; e + 1 < starts.size(); ++e) {
            if (joins_two(e)) edges_.emplace_back(sorted.records[starts[e]].side);
        }
    }

    [[nodiscard]] FoundSharpEdges sharp(SingleCells single) const {
        FoundSharpEdges found;
        std::size_t inward = 0;
        bool right = true;
        for (const Side side : edges_) {
            const Side other = beyond_[side.facet][side.number];
            const bool untagged = single == SingleCells::Leave && facets_[side.facet].cell == facets_[other.facet].cell;
            if (untagged || !is_sharp(side)) continue;
            found.edges.push_back(facets_[side.facet].edge(side.number));
            const double angle = bends_[side.facet][side.number];
            inward += angle < 0;
            right = right && std::abs(std::abs(angle) - 90) < kFlatDeg;
        }
        found.steps = right && 8 * inward > facets_.size();
        return found;
    }

    /// Adds the sharp edges between parts with all facets of the interfaces to which they belong. A crease inside a mesh is an
    /// edge of sharp faces, so an interface is sharp as a whole or not at all.
    ///
    /// cells, parts: those that the facets were made of
    void add_interfaces(const AllCells& cells, std::span<const Index> parts, FoundSharpEdges& found) const {
        std::vector<Bent> bent;
        for (const Side side : edges_) {
            if (is_sharp(side)) bent.push_back({facets_[side.facet].edge(side.number), side, 0, 0});
        }
        if (bent.empty()) return;
        count_cells(cells, parts, bent);
        std::erase_if(bent, [&](const Bent& edge) { return is_of_a_grid(edge); });
        DisjointSets interfaces(facets_.size());
        for (const Side side : edges_) interfaces.join(side.facet, beyond_[side.facet][side.number].facet);
        std::vector<std::uint8_t> sharp(facets_.size(), 0);
        for (const Bent& edge : bent) {
            sharp[interfaces.least(edge.side.facet)] = 1;
            found.edges_between.push_back(edge.ends);
        }
        for (Index f = 0; f < facets_.size(); ++f) {
            if (sharp[interfaces.least(f)] == 0) continue;
            auto corners = facets_[f].corners;
            if (corners[3] == kNone) corners[3] = corners[2];
            found.faces_between.push_back(corners);
        }
    }

private:
    /// An edge between two parts that is bent. around, inside: the cells at the edge, and those of them in the first part,
    /// twice
    struct Bent {
        std::array<Index, 2> ends;
        Side side;
        std::size_t around, inside;
    };

    /// bent: ascending
    void count_cells(const AllCells& cells, std::span<const Index> parts, std::vector<Bent>& bent) const {
        std::vector<std::uint8_t> at_edge(points_.size(), 0);
        for (const Bent& edge : bent) at_edge[edge.ends[0]] = at_edge[edge.ends[1]] = 1;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            cells.with(c, [&](const auto& corners, const auto& sides) {
                if (std::ranges::count_if(corners, [&](Index p) { return at_edge[p] != 0; }) < 2) return;
                for (const auto& side : sides) {
                    for (std::size_t k = 0; k < 4; ++k) {  // each edge of the cell is one of two sides
                        const Index a = corners[side[k]], b = corners[side[(k + 1) % 4]];
                        const std::array<Index, 2> ends{std::min(a, b), std::max(a, b)};
                        const auto edge = std::ranges::lower_bound(bent, ends, {}, &Bent::ends);
                        if (edge == bent.end() || edge->ends != ends) continue;
                        ++edge->around;
                        edge->inside += parts[c] == facets_[edge->side.facet].parts[0];
                    }
                }
            });
        }
    }

    /// Where one cell of four has a right angle, the limit keeps it without a crease, as it keeps every grid.
    [[nodiscard]] bool is_of_a_grid(const Bent& edge) const {
        constexpr double kAboutRightDeg = 20;
        const bool corner = edge.around == 8 && (edge.inside == 2 || edge.inside == 6);
        return corner && std::abs(std::abs(bends_[edge.side.facet][edge.side.number]) - 90) < kAboutRightDeg;
    }

    /// By how many degrees the boundary turns from one facet to the next; below 0 where it turns inward. Facets without an area
    /// bend nowhere.
    static double bend(const Facet& one, const Facet& other) {
        const double lengths = glm::length(one.normal) * glm::length(other.normal);
        if (!(lengths > 0)) return 0;
        const double cosine = std::clamp(glm::dot(one.normal, other.normal) / lengths, -1.0, 1.0);
        const double angle = std::acos(cosine) * 180 / std::numbers::pi;
        return glm::dot(one.normal, other.center - one.center) > 0 ? -angle : angle;
    }

    [[nodiscard]] bool is_sharp(Side side) const {
        const Side other = beyond_[side.facet][side.number];
        const double angle = std::abs(bends_[side.facet][side.number]);
        return angle > kSharpAngleDeg + kRoundingDeg && (angle > kCurveAngleDeg + kRoundingDeg || !on_curve(side, other));
    }

    [[nodiscard]] bool on_curve(Side one, Side other) const {
        const std::vector<double> here = widths(one), there = widths(other);
        return std::ranges::any_of(here, [&](double width) {
            return std::ranges::any_of(
                there, [&](double beyond) { return width <= kMostWider * beyond && beyond <= kMostWider * width; });
        });
    }

    /// The distances to the far edges of a facet that bend as the edge does.
    [[nodiscard]] std::vector<double> widths(Side side) const {
        std::vector<double> found;
        const auto take = [&](Side far) {
            if (is_alike(bends_[far.facet][far.number], bends_[side.facet][side.number]))
                found.push_back(glm::distance(middle(far), middle(side)));
        };
        if (facets_[side.facet].sides() == 4) {
            take(turned(side, 2));
            return found;
        }
        for (std::size_t k = 1; k < 3; ++k) {
            const Side far = turned(side, k);
            take(far);
            const Side beyond = beyond_[far.facet][far.number];
            if (std::abs(bends_[far.facet][far.number]) > kFlatDeg || beyond.facet == kNone) continue;
            if (facets_[beyond.facet].sides() != 3) continue;
            for (std::size_t l = 1; l < 3; ++l) take(turned(beyond, l));
        }
        return found;
    }

    /// The side so many sides further around the facet.
    [[nodiscard]] Side turned(Side side, std::size_t by) const {
        return {side.facet, static_cast<std::uint8_t>((side.number + by) % facets_[side.facet].sides())};
    }

    static bool is_alike(double far, double angle) {
        return far * angle > 0 && std::abs(far) >= std::abs(angle) / 2 && std::abs(far) <= kCurveAngleDeg + kRoundingDeg;
    }

    [[nodiscard]] Vec3 middle(Side side) const {
        const auto [a, b] = facets_[side.facet].edge(side.number);
        return (points_[a] + points_[b]) / 2.0;
    }

    std::span<const Vec3> points_;
    std::vector<Facet> facets_;
    std::vector<std::array<Side, 4>> beyond_;   // the facet across each side, and which side of that it is
    std::vector<std::array<double, 4>> bends_;  // at each side; 0 where not two facets meet
    std::vector<Side> edges_;                   // one side of each edge of two facets, in the order of the points
};

}  // namespace

FoundSharpEdges find_sharp_edges(std::span<const Vec3> points, std::span<const std::array<Index, 8>> hexes,
                                 const MixedCells& others, std::span<const Index> parts, SingleCells single) {
    const AllCells cells(hexes, others);
    Facets facets = facets_of(points, cells, parts);
    FoundSharpEdges found = BentBoundary(points, std::move(facets.outside)).sharp(single);
    if (!facets.between.empty()) BentBoundary(points, std::move(facets.between)).add_interfaces(cells, parts, found);
    return found;
}

}  // namespace subvol::detail

namespace subvol {

SharpEdges keep_sharp_edges(HexMesh& mesh) {
    detail::FoundSharpEdges found = detail::find_sharp_edges(mesh.points, mesh.cells, {}, {});
    auto& edges = found.edges;
    if (!mesh.creases.empty()) {
        auto tagged = mesh.creases;
        std::sort(tagged.begin(), tagged.end());
        std::erase_if(edges, [&](const auto& edge) { return std::binary_search(tagged.begin(), tagged.end(), edge); });
    }
    mesh.creases.insert(mesh.creases.end(), edges.begin(), edges.end());
    return {edges.size(), found.steps};
}

}  // namespace subvol
