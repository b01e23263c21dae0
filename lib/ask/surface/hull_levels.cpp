// SPDX-License-Identifier: Apache-2.0
// Refines the boundary of a mesh where its limit bends, without the cells behind it: the boundary rules of the schemes use
// points of the boundary alone.
//
//     level 0        level 1        level 2            faces that bend are split into four; the others are leaves.
//     ┌─────┬─────┐  ┌──┬──┬─────┐  ┌──┬──┬─────┐      A side that a finer neighbour has divided keeps its vertices,
//     │     │     │  │  │  │     │  │  │  │     │      so that triangles of the leaves meet without gaps:
//     │     │     │  ├──┼──┤     │  ├──┼┬─┤     │
//     │     │     │  │  │  │     │  │  ├┼─┤     │      ring of the right leaf: its four corners, and three vertices
//     └─────┴─────┘  └──┴──┴─────┘  └──┴┴─┴─────┘      on its left side
//
// Each level is a topology of boundary faces without cells. The vertices of the next level are computed where a face might be
// split. How far they are from the middles of their edges, and from the nearer diagonal of their face, is the bend of the
// level. A face is split if it bends by too much, or its parent bends by so much more that one look may have missed a bend that
// changes sides. The rules look one ring of faces about a face: a level has the children of the faces that are split, and of
// those around them.
//
// Faces of the control mesh are split unless they are flat (flat_faces.h): there nothing is computed. Fields are more
// coordinates of the points: their scales make a bend that is allowed as large as that of the places.
#include "hull_levels.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "flat_faces.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/detail/incident.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/scheme_rows.h"
#include "surface_shape.h"

namespace subvol::detail {

namespace {

using Vertex = std::uint32_t;

// The bend of a smooth surface falls to a quarter with each level. A face whose parent bends by more than six times the limit
// has either not been smooth, or its own bend is more than the limit.
constexpr double kMostOfParent = 6;

// The finest level that is made for the sake of fields, which may be as rough as the numbers of nodes.
constexpr int kLevelOfFields = 2;

/// One level of some faces of the boundary.
struct HullLevel {
    Topology surface;  // all faces are boundary faces without cells
    std::vector<PointKind> kinds;
    std::vector<Vertex> vertices;  // of the points
    std::vector<std::array<FacePlace, 4>> places;
    std::vector<Index> roots;           // for each face the face of the control mesh that it is a part of
    std::vector<double> parent_bends;   // for each face
    std::vector<Vertex> edge_vertices;  // in the middle of each edge; kNoVertex if it has not been computed
    std::vector<Vertex> face_vertices;
    std::vector<std::uint8_t> edge_split;  // an edge of a face that is split
    std::vector<Index> halves;        // for each edge its half at the first point in the next level, which the other follows
    std::vector<Index> candidates;    // faces that are either split or leaves
    std::vector<std::uint8_t> split;  // for each face
    std::vector<double> bends;        // for each face
    std::vector<double> field_bends;
};

FacePlace middle(const FacePlace& a, const FacePlace& b) {
    return {static_cast<std::uint16_t>((a[0] + b[0]) / 2), static_cast<std::uint16_t>((a[1] + b[1]) / 2)};
}

/// The boundary faces of a topology, with their edges and points.
struct BoundaryPart {
    std::vector<Index> faces, edges, points;

    explicit BoundaryPart(const Topology& t)
        : faces(numbers_where<std::vector<Index>>(t.faces.size(),
                                                  [&](std::size_t f) { return t.face_on_boundary(static_cast<Index>(f)); })),
          edges(numbers_where<std::vector<Index>>(t.edges.size(), [&](std::size_t e) { return t.edge_on_boundary[e] != 0; })),
          points(numbers_where<std::vector<Index>>(t.point_count, [&](std::size_t p) { return t.point_on_boundary[p] != 0; })) {
    }
};

/// The place of each of some ascending numbers among them; kNone for others.
std::vector<Index> places_of(std::span<const Index> numbers, std::size_t count) {
    std::vector<Index> places(count, kNone);
    for (std::size_t i = 0; i < numbers.size(); ++i) places[numbers[i]] = static_cast<Index>(i);
    return places;
}

/// Fills in what follows from the faces and edges of a topology of boundary faces without cells.
void complete(Topology& surface) {
    surface.face_cells.assign(surface.faces.size(), {kNone, kNone});
    surface.edge_faces = lists_at_points(surface.face_edges, surface.edges.size());
    surface.point_edges = lists_at_points(surface.edges, surface.point_count);
    surface.edge_on_boundary.assign(surface.edges.size(), 1);
    surface.edge_has_ring.assign(surface.edges.size(), 0);
    surface.edge_cells.offsets.assign(surface.edges.size() + 1, 0);
    surface.point_on_boundary.assign(surface.point_count, 1);
}

/// Allots what is known of a level later.
void prepare(HullLevel& level) {
    level.edge_vertices.assign(level.surface.edges.size(), kNoVertex);
    level.face_vertices.assign(level.surface.faces.size(), kNoVertex);
    level.edge_split.assign(level.surface.edges.size(), 0);
    level.halves.assign(level.surface.edges.size(), kNone);
    level.split.assign(level.surface.faces.size(), 0);
    level.bends.assign(level.surface.faces.size(), 0);
    level.field_bends.assign(level.surface.faces.size(), 0);
}

class HullRefiner {
public:
    HullRefiner(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> chosen,
                const SchemeOptions& scheme, const HullLevelOptions& options)
        : topology_(topology), scheme_(scheme), options_(options), width_(options.fields.channels) {
        start(mesh, chosen);
    }

    HullLeaves run() {
        for (std::size_t l = 0; !levels_[l].candidates.empty(); ++l) {
            report_progress(options_.progress, "boundary", l, static_cast<std::size_t>(options_.max_level) + 1);
            choose(static_cast<int>(l));
            HullLevel next = child_of(levels_[l]);
            levels_.push_back(std::move(next));
        }
        HullLeaves found{std::move(vertices_), {}, 0};
        for (std::size_t l = 0; l < levels_.size(); ++l) add_leaves(static_cast<int>(l), found);
        std::ranges::stable_sort(found.leaves, {}, [&](const HullLeaf& leaf) {
            const Index cell = topology_.face_cells[leaf.face][0];
            return std::pair(cell, slot_of(topology_.cell_faces[cell], leaf.face));
        });
        return found;
    }

private:
    void start(const HexMesh& mesh, std::span<const std::uint8_t> chosen) {
        const BoundaryPart part(topology_);
        const std::vector<Index> edges = places_of(part.edges, topology_.edges.size()),
                                 points = places_of(part.points, topology_.point_count);
        HullLevel& level = levels_.emplace_back();
        Topology& surface = level.surface;
        surface.point_count = part.points.size();
        const std::vector<PointKind> kinds = classify_points(topology_);
        for (const Index p : part.points) {
            level.vertices.push_back(static_cast<Vertex>(vertices_.size()));
            vertices_.push_back(mesh.points[p]);
            const auto field = options_.fields.at(p);
            values_.insert(values_.end(), field.begin(), field.end());
            level.kinds.push_back(kinds[p]);
        }
        for (const Index e : part.edges) {
            surface.edges.push_back({points[topology_.edges[e][0]], points[topology_.edges[e][1]]});
            surface.edge_is_crease.push_back(topology_.edge_is_crease[e]);
        }
        const std::uint16_t n = hull_steps(options_.max_level);
        for (const Index f : part.faces) {
            if (topology_.face_on_hull(f) && (chosen.empty() || chosen[topology_.face_cells[f][0]] != 0))
                level.candidates.push_back(static_cast<Index>(surface.faces.size()));
            auto& face = surface.faces.emplace_back();
            auto& sides = surface.face_edges.emplace_back();
            for (std::size_t k = 0; k < 4; ++k) {
                face[k] = points[topology_.faces[f][k]];
                sides[k] = edges[topology_.face_edges[f][k]];
            }
            level.places.push_back({FacePlace{0, 0}, FacePlace{n, 0}, FacePlace{n, n}, FacePlace{0, n}});
            level.roots.push_back(f);
            level.parent_bends.push_back(HUGE_VAL);
        }
        complete(surface);
        prepare(level);
    }

    // What is split.

    /// Decides which candidates of a level are split, and computes the vertices that the next level and the leaves have.
    void choose(int number) {
        HullLevel& level = levels_[static_cast<std::size_t>(number)];
        const std::unique_ptr<SchemeRules> rules = make_rules(level.surface, scheme_, level.kinds);
        std::vector<Index> looked_at = level.candidates;
        if (number == 0) {
            // No vertex has been added yet: the first are the points.
            const std::vector<std::uint8_t> flat =
                flat_faces(level.surface, level.kinds, vertices_, {values_, width_}, options_.bend_world);
            std::erase_if(looked_at, [&](Index f) { return flat[f] != 0; });
        }
        compute(level, *rules, looked_at);
        measure_bends(level, number, looked_at);
        const std::size_t leaves = leaf_count_ + level.candidates.size();
        if (number < options_.max_level && 2 * (leaves + 3 * looked_at.size()) <= options_.max_triangles) {
            for (const Index f : looked_at) {
                const bool coarse = number == 0 || level.parent_bends[f] > kMostOfParent * options_.bend_world;
                level.split[f] = coarse || std::max(level.bends[f], level.field_bends[f]) > options_.bend_world ? 1 : 0;
            }
        }
        for (const Index f : level.candidates) {
            if (level.split[f] == 0) {
                ++leaf_count_;
                continue;
            }
            for (const Index e : level.surface.face_edges[f]) level.edge_split[e] = 1;
        }
        refined_ = around_split(level);
        compute(level, *rules, refined_);
        std::vector<Index> fans;  // leaves with vertices on their sides: triangles about their centre
        for (const Index f : level.candidates) {
            const auto& sides = level.surface.face_edges[f];
            if (level.split[f] == 0 && std::ranges::any_of(sides, [&](Index e) { return level.edge_split[e] != 0; }))
                fans.push_back(f);
        }
        compute(level, *rules, fans);
    }

    /// The faces that have a point of a face that is split.
    [[nodiscard]] static std::vector<Index> around_split(const HullLevel& level) {
        std::vector<std::uint8_t> near(level.surface.point_count, 0);
        for (const Index f : level.candidates) {
            if (level.split[f] == 0) continue;
            for (const Index p : level.surface.faces[f]) near[p] = 1;
        }
        return numbers_where<std::vector<Index>>(level.surface.faces.size(), [&](std::size_t f) {
            return std::ranges::any_of(level.surface.faces[f], [&](Index p) { return near[p] != 0; });
        });
    }

    /// The vertices in the middles of some faces and their edges, as far as they are not known.
    void compute(HullLevel& level, const SchemeRules& rules, std::span<const Index> faces) {
        const Vertex first = static_cast<Vertex>(vertices_.size());
        struct New {
            bool face;
            Index at;
        };
        std::vector<New> added;
        const auto add = [&](Vertex& vertex, New what) {
            if (vertex != kNoVertex) return;
            vertex = static_cast<Vertex>(first + added.size());
            added.push_back(what);
        };
        for (const Index f : faces) {
            for (const Index e : level.surface.face_edges[f]) add(level.edge_vertices[e], {false, e});
            add(level.face_vertices[f], {true, f});
        }
        vertices_.resize(first + added.size());
        values_.resize(vertices_.size() * width_);
        tbb::enumerable_thread_specific<StencilBuilder> scratch;
        parallel_each(added.size(), [&](std::size_t i) {
            StencilBuilder& row = scratch.local();
            row.clear();
            if (added[i].face) {
                rules.face_point(added[i].at, row);
            } else {
                rules.edge_point(added[i].at, row);
            }
            const StencilRuns stencil = row.finish();
            const auto sum = [&](auto zero, const auto& at) {
                std::size_t next = 0;
                auto total = zero;
                for (const auto& [weight, count] : stencil.runs) {
                    auto run = zero;
                    for (std::uint32_t k = 0; k < count; ++k) run += at(level.vertices[stencil.points[next++]]);
                    total += weight * run;
                }
                return total;
            };
            vertices_[first + i] = sum(Vec3(0.0), [&](Vertex v) -> const Vec3& { return vertices_[v]; });
            for (std::size_t c = 0; c < width_; ++c)
                values_[(first + i) * width_ + c] = sum(0.0, [&](Vertex v) { return values_[v * width_ + c]; });
        });
    }

    void measure_bends(HullLevel& level, int number, std::span<const Index> faces) const {
        parallel_each(faces.size(), [&](std::size_t i) {
            const Index f = faces[i];
            const auto corner = [&](std::size_t k) { return vertices_[level.vertices[level.surface.faces[f][k % 4]]]; };
            const Vec3& center = vertices_[level.face_vertices[f]];
            double bend =
                std::min(distance_to_line(center, corner(0), corner(2)), distance_to_line(center, corner(1), corner(3)));
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3& at = vertices_[level.edge_vertices[level.surface.face_edges[f][k]]];
                bend = std::max(bend, distance_to_line(at, corner(k), corner(k + 1)));
            }
            level.bends[f] = bend;
            level.field_bends[f] = number < kLevelOfFields ? bend_of_fields(level, f) : 0;
        });
    }

    /// How far the fields at the middles of a face's sides are from the means of the ends, and in its centre from those of the
    /// diagonals.
    [[nodiscard]] double bend_of_fields(const HullLevel& level, Index f) const {
        double bend = 0;
        for (std::size_t c = 0; c < width_; ++c) {
            const auto value = [&](Vertex v) { return values_[v * width_ + c]; };
            std::array<double, 4> corners;
            for (std::size_t k = 0; k < 4; ++k) corners[k] = value(level.vertices[level.surface.faces[f][k]]);
            const double center = value(level.face_vertices[f]);
            for (std::size_t k = 0; k < 4; ++k) {
                const double mid = value(level.edge_vertices[level.surface.face_edges[f][k]]);
                bend = std::max({bend, std::abs(mid - 0.5 * (corners[k] + corners[(k + 1) % 4])),
                                 std::abs(center - 0.5 * (corners[k] + corners[(k + 2) % 4]))});
            }
        }
        return bend;
    }

    // The next level.

    /// The children of the faces in `refined_`: child k of a face is at its corner k.
    HullLevel child_of(HullLevel& level) const {
        const Topology& parent = level.surface;
        HullLevel child;
        Topology& t = child.surface;
        std::vector<std::uint8_t> used_edges(parent.edges.size(), 0), used_points(parent.point_count, 0);
        for (const Index f : refined_) {
            for (const Index e : parent.face_edges[f]) used_edges[e] = 1;
            for (const Index p : parent.faces[f]) used_points[p] = 1;
        }
        std::vector<Index> points(parent.point_count, kNone), middles(parent.edges.size(), kNone);
        const auto add_point = [&](Vertex vertex, PointKind kind) {
            child.vertices.push_back(vertex);
            child.kinds.push_back(kind);
            return static_cast<Index>(child.vertices.size() - 1);
        };
        for (Index p = 0; p < parent.point_count; ++p) {
            if (used_points[p] != 0) points[p] = add_point(level.vertices[p], level.kinds[p]);
        }
        for (Index e = 0; e < parent.edges.size(); ++e) {
            if (used_edges[e] == 0) continue;
            const bool crease = parent.edge_is_crease[e] != 0;
            middles[e] = add_point(level.edge_vertices[e], crease ? PointKind::Crease : PointKind::Smooth);
            level.halves[e] = static_cast<Index>(t.edges.size());
            for (const Index end : parent.edges[e]) {
                t.edges.push_back({points[end], middles[e]});
                t.edge_is_crease.push_back(crease ? 1 : 0);
            }
        }
        for (const Index f : refined_) {
            const Index center = add_point(level.face_vertices[f], PointKind::Smooth);
            const auto first = static_cast<Index>(t.edges.size());
            for (const Index e : parent.face_edges[f]) {
                t.edges.push_back({middles[e], center});
                t.edge_is_crease.push_back(0);
            }
            const auto& places = level.places[f];
            const FacePlace inner = middle(places[0], places[2]);
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t before = (k + 3) % 4;
                const Index p = parent.faces[f][k], e0 = parent.face_edges[f][k], e1 = parent.face_edges[f][before];
                if (level.split[f] != 0) child.candidates.push_back(static_cast<Index>(t.faces.size()));
                t.faces.push_back({points[p], middles[e0], center, middles[e1]});
                t.face_edges.push_back({half_at(level, e0, p), static_cast<Index>(first + k),
                                        static_cast<Index>(first + before), half_at(level, e1, p)});
                child.places.push_back(
                    {places[k], middle(places[k], places[(k + 1) % 4]), inner, middle(places[before], places[k])});
                child.roots.push_back(level.roots[f]);
                child.parent_bends.push_back(level.bends[f]);
            }
        }
        t.point_count = child.vertices.size();
        complete(t);
        prepare(child);
        level.surface.point_edges = {};
        level.surface.edge_faces = {};
        return child;
    }

    [[nodiscard]] static Index half_at(const HullLevel& level, Index edge, Index point) {
        return static_cast<Index>(level.halves[edge] + (level.surface.edges[edge][0] == point ? 0 : 1));
    }

    // Leaves.

    void add_leaves(int number, HullLeaves& found) const {
        const HullLevel& level = levels_[static_cast<std::size_t>(number)];
        for (const Index f : level.candidates) {
            if (level.split[f] != 0) continue;
            const auto& places = level.places[f];
            HullLeaf& leaf = found.leaves.emplace_back();
            leaf.face = level.roots[f];
            leaf.level = number;
            leaf.bend = level.bends[f];
            leaf.center = {level.face_vertices[f], middle(places[0], places[2])};
            for (std::size_t k = 0; k < 4; ++k) {
                const Index p = level.surface.faces[f][k], e = level.surface.face_edges[f][k];
                leaf.corners[k] = static_cast<std::uint32_t>(leaf.ring.size());
                leaf.middles[k] = level.edge_vertices[e];
                leaf.ring.push_back({level.vertices[p], places[k]});
                add_side(static_cast<std::size_t>(number), e, p, places[k], places[(k + 1) % 4], leaf.ring);
            }
            found.level = std::max(found.level, number);
        }
    }

    /// The vertices that finer leaves have on an edge of a level, from one of its ends to the other, without these.
    void add_side(std::size_t number, Index edge, Index from, const FacePlace& a, const FacePlace& b,
                  std::vector<LeafVertex>& ring) const {
        const HullLevel& level = levels_[number];
        if (level.edge_split[edge] == 0) return;
        const HullLevel& next = levels_[number + 1];
        const FacePlace between = middle(a, b);
        const Index first = half_at(level, edge, from), mid = next.surface.edges[first][1];
        add_side(number + 1, first, next.surface.edges[first][0], a, between, ring);
        ring.push_back({level.edge_vertices[edge], between});
        add_side(number + 1, level.halves[edge] + (first == level.halves[edge] ? 1 : 0), mid, between, b, ring);
    }

    const Topology& topology_;
    SchemeOptions scheme_;
    HullLevelOptions options_;
    std::size_t width_;  // channels of the fields
    std::vector<Vec3> vertices_;
    std::vector<double> values_;  // width_ numbers for each vertex
    std::vector<HullLevel> levels_;
    std::vector<Index> refined_;  // faces of the last level that have children
    std::size_t leaf_count_ = 0;
};

}  // namespace

HullLeaves refine_hull(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> chosen,
                       const SchemeOptions& scheme, const HullLevelOptions& options) {
    return HullRefiner(mesh, topology, chosen, scheme, options).run();
}

}  // namespace subvol::detail
