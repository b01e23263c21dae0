// SPDX-License-Identifier: Apache-2.0
// The rows of a level: averaging after the linear split. With L the split of mixed_split.cpp, which puts new points in the
// middle of what they belong to, and A an average over the cells at each point of the new level, a level's points are
//
//     p' = A L p,      row of v:   Σ over the cells c at v of  share(c) · Σ over the corners w of c of  weight(w, v) · (L p)_w
//
// Shares make a point regular if the solid angles around it are filled by regular cells of any kinds: 14 tetrahedra and
// octahedra, 12 prisms or 8 hexahedra meet at a point of their lattices, so a cell counts 1/14, 1/12 or 1/8 of it, divided by
// the sum of all at v.
//
//     tetrahedron     −1/16 v + 17/48 of each of the other three
//     octahedron       3/8  v +  1/12 of each of four neighbours + 7/24 of the opposite corner
//     prism            1/8  v +  1/8 of the corner along the axis + 3/16 of each of the four others
//     hexahedron       1/8 of each corner
//     pyramid          half an octahedron, with the weight of both ends on its apex; at its apex 1/12 v + 11/48 of each corner
//
// The rules are those of [shw2004], but for the apex of a pyramid, which is ours. A point between two kinds of cells has the
// eigenvalues ½, ½, ½, ¼ of a regular point then (docs/schemes.md). The box spline [cmq2002] is 1/8 of the point and 7/8 of the
// mean of its neighbours, diagonals included. On the boundary faces take the place of cells: the rules there do not see the
// inside.
#include "subvol/detail/mixed_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/stencil_block.h"

namespace subvol::detail {

namespace {

/// A cell, a face or a crease at a point.
struct AtPoint {
    Index point, item;
    auto operator<=>(const AtPoint&) const = default;
};

template <class Items>
Buckets<AtPoint> items_at_points(const Items& items, std::size_t points) {
    return bucket_sort<AtPoint>(
        items.size(), points,
        [&](std::size_t i, const auto& sink) {
            for (const Index p : items[i]) {
                if (p != kNone) sink(AtPoint{p, static_cast<Index>(i)});
            }
        },
        [](const AtPoint& record) { return std::size_t{record.point}; });
}

template <class Call>
void each_at(const Buckets<AtPoint>& buckets, Index point, const Call& call) {
    for (std::size_t i = buckets.offsets[point]; i < buckets.offsets[point + 1]; ++i) call(buckets.records[i].item);
}

std::size_t count_at(const Buckets<AtPoint>& buckets, Index point) {
    return buckets.offsets[point + 1] - buckets.offsets[point];
}

/// The weighted points of one row of the smoothing.
using Terms = std::vector<std::pair<Index, double>>;

/// The weights by which the points of a level, put in the middles by the linear split, are averaged.
class Smoothing {
public:
    Smoothing(const MixedLevel& level, TetScheme scheme) : level_(level), scheme_(scheme) {
        const MixedMesh& mesh = level.cells;
        at_faces_ = items_at_points(level.boundary.faces, level.points);
        at_creases_ = items_at_points(level.boundary.creases, level.points);
        at_tets_ = items_at_points(mesh.tets, level.points);
        at_octahedra_ = items_at_points(mesh.octahedra, level.points);
        at_prisms_ = items_at_points(mesh.prisms, level.points);
        at_pyramids_ = items_at_points(mesh.pyramids, level.points);
        at_hexes_ = items_at_points(mesh.hexes, level.points);
    }

    /// The average at a point: over cells inside, over faces on the boundary, (1, 2, 1)/4 along a crease, the point itself at a
    /// corner. A point without cells, faces and creases stays.
    void row(Index v, Terms& terms) const {
        terms.clear();
        const PointKind kind = scheme_ == TetScheme::Linear ? PointKind::Corner : level_.boundary.kinds[v];
        if (kind == PointKind::Interior) {
            scheme_ == TetScheme::Boxspline ? mean_of_neighbors(v, terms) : mean_of_cells(v, terms);
        } else if (kind == PointKind::Smooth) {
            mean_of_faces(v, terms);
        } else if (kind == PointKind::Crease) {
            terms.emplace_back(v, 0.5);
            each_at(at_creases_, v, [&](Index c) {
                const auto& [a, b] = level_.boundary.creases[c];
                terms.emplace_back(a == v ? b : a, 0.25);
            });
        }
        if (terms.empty()) terms.emplace_back(v, 1.0);
    }

private:
    /// Tetoct. A cell counts as its share in the regular meshes of its kind: 14 tetrahedra and octahedra, 12 prisms or 8
    /// hexahedra at a point. A pyramid is half an octahedron: at its base it has half the octahedron's share, with the weight
    /// of both ends on its apex; at its apex the opposite end is the apex mirrored in the base.
    void mean_of_cells(Index v, Terms& terms) const {
        const MixedMesh& mesh = level_.cells;
        std::size_t apexes = 0;
        each_at(at_pyramids_, v, [&](Index c) { apexes += mesh.pyramids[c][4] == v ? 1 : 0; });
        const auto number = [](std::size_t n) { return static_cast<double>(n); };
        const double bases = number(count_at(at_pyramids_, v) - apexes);
        const double total = (number(count_at(at_tets_, v) + count_at(at_octahedra_, v) + apexes) + bases / 2) / 14 +
                             number(count_at(at_prisms_, v)) / 12 + number(count_at(at_hexes_, v)) / 8;
        if (total == 0) return;
        each_at(at_tets_, v, [&](Index c) {
            const double share = 1 / (14 * total);
            for (const Index p : mesh.tets[c]) terms.emplace_back(p, share * (p == v ? -1.0 / 16 : 17.0 / 48));
        });
        each_at(at_octahedra_, v, [&](Index c) {
            const double share = 1 / (14 * total);
            const auto& q = mesh.octahedra[c];
            for (std::size_t k = 0; k < 6; ++k) {
                terms.emplace_back(q[k], share * (q[k] == v ? 3.0 / 8 : q[k ^ 1u] == v ? 7.0 / 24 : 1.0 / 12));
            }
        });
        each_at(at_prisms_, v, [&](Index c) {
            const double share = 1 / (12 * total);
            const auto& q = mesh.prisms[c];
            for (std::size_t k = 0; k < 6; ++k) {
                terms.emplace_back(q[k], share * (q[k] == v || q[(k + 3) % 6] == v ? 1.0 / 8 : 3.0 / 16));
            }
        });
        each_at(at_pyramids_, v, [&](Index c) {
            const auto& q = mesh.pyramids[c];
            const bool apex = q[4] == v;
            const double share = (apex ? 1.0 : 0.5) / (14 * total);
            for (std::size_t k = 0; k < 4; ++k) {
                const double base = q[k] == v ? 3.0 / 8 : q[k ^ 2u] == v ? 7.0 / 24 : 1.0 / 12;
                terms.emplace_back(q[k], share * (apex ? 11.0 / 48 : base));
            }
            terms.emplace_back(q[4], share * (apex ? 1.0 / 12 : 1.0 / 6));
        });
        each_at(at_hexes_, v, [&](Index c) {
            for (const Index p : mesh.hexes[c]) terms.emplace_back(p, 1 / (8 * total) / 8);
        });
    }

    /// The box spline: an eighth of the point and the mean of all that an edge or a diagonal joins with it. In the lattice,
    /// with its 14 neighbours, that is the second factor of the symbol.
    void mean_of_neighbors(Index v, Terms& terms) const {
        each_at(at_tets_, v, [&](Index c) {
            for (const Index p : level_.cells.tets[c]) terms.emplace_back(p, 0.0);
        });
        each_at(at_octahedra_, v, [&](Index c) {
            const auto& q = level_.cells.octahedra[c];
            for (std::size_t k = 0; k < 6; ++k) {
                if (k < 2 || q[k ^ 1u] != v) terms.emplace_back(q[k], 0.0);
            }
        });
        std::sort(terms.begin(), terms.end());
        terms.erase(std::unique(terms.begin(), terms.end()), terms.end());
        const double weight = terms.size() > 1 ? 7.0 / 8 / static_cast<double>(terms.size() - 1) : 0;
        for (auto& [point, w] : terms) w = point == v ? 1.0 / 8 : weight;
    }

    /// Loop's surface as a mean over triangles and a step towards it, and Catmull-Clark's over quads [ws2004]. The step is 1
    /// where six triangles or four quads meet; elsewhere it is chosen so that the limit is that of Loop and of Catmull and
    /// Clark.
    void mean_of_faces(Index v, Terms& terms) const {
        std::size_t triangles = 0, quads = 0;
        each_at(at_faces_, v, [&](Index f) { ++(level_.boundary.faces[f][3] == kNone ? triangles : quads); });
        const double n = static_cast<double>(triangles + quads);
        double step = 1;
        if (quads == 0 && triangles != 6) {
            const double root = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
            step = 5.0 / 3 - 8.0 / 3 * root * root;
        } else if (triangles == 0) {
            step = 4 / n;
        }
        const double total = static_cast<double>(triangles) / 6 + static_cast<double>(quads) / 4;
        each_at(at_faces_, v, [&](Index f) {
            const auto& face = level_.boundary.faces[f];
            const bool triangle = face[3] == kNone;
            const double share = step / total / (triangle ? 6 : 4);
            for (const Index p : face) {
                if (p != kNone) terms.emplace_back(p, share * (!triangle || p == v ? 1.0 / 4 : 3.0 / 8));
            }
        });
        if (step != 1) terms.emplace_back(v, 1 - step);
    }

    const MixedLevel& level_;
    TetScheme scheme_;
    Buckets<AtPoint> at_faces_, at_creases_, at_tets_, at_octahedra_, at_prisms_, at_pyramids_, at_hexes_;
};

/// Adds up the terms of each point. They are sorted by point and weight before, so that the sum does not depend on the order of
/// the cells.
void merge(Terms& terms) {
    std::sort(terms.begin(), terms.end());
    std::size_t count = 0;
    for (std::size_t i = 0; i < terms.size();) {
        auto sum = terms[i];
        while (++i < terms.size() && terms[i].first == sum.first) sum.second += terms[i].second;
        terms[count++] = sum;
    }
    terms.resize(count);
}

}  // namespace

MixedStep refine_level(const MixedLevel& parent, const SplitNumbers& numbers, TetScheme scheme) {
    MixedStep step;
    step.child.points = numbers.size();
    step.child.cells = split_cells(parent.cells, numbers);
    step.child.boundary = split_boundary(parent.boundary, numbers);
    // The row of a point over the new points, then each new point replaced by what the linear split makes it of.
    const Smoothing smoothing(step.child, scheme);
    std::vector<StencilTable::Block> blocks((numbers.size() + kBlockRows - 1) / kBlockRows);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        StencilBlockWriter writer;
        StencilBuilder row;
        Terms terms;
        writer.start(b * kBlockRows);
        for (std::size_t v = b * kBlockRows; v < std::min(numbers.size(), (b + 1) * kBlockRows); ++v) {
            smoothing.row(static_cast<Index>(v), terms);
            merge(terms);
            row.clear();
            for (const auto& term : terms) {
                numbers.linear(parent.cells, term.first, scheme == TetScheme::Boxspline,
                               [&](Index p, double w) { row.add(p, term.second * w); });
            }
            writer.push(row.finish());
        }
        blocks[b] = writer.block();
    });
    step.table = StencilTable(parent.points, 0, std::move(blocks));
    return step;
}

}  // namespace subvol::detail
