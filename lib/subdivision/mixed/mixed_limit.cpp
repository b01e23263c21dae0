// SPDX-License-Identifier: Apache-2.0
// Limits of vertices as weights of the control points around them.
//
// The *star* of a vertex v is v and the corners of its cells. One refinement makes a star of the same shape, half as large: to
// each point w belongs a new point, the middle of the edge, quad or cell that v and w share, to v the point v itself. The new
// star is made of the old one alone, p' = S p, with the same matrix S at every level, because the new cells at v meet as the
// old ones do:
//
//         w₃──────w₂                  w₃──────w₂
//          \     /  \                  \      /  \         p' = S p, where
//           \   /    \       ──►        \  m₃──m₂ \        S has the rows of v, m₁, m₂, m₃, …
//            \ /      \                  \ /   /   \       and the columns of v, w₁, w₂, w₃, …
//             v───────w₁                  v──m₁────w₁
//
// Rows of S sum to 1, so 1 is an eigenvalue, and the largest. The star shrinks to the point l·p, with the left eigenvector l S
// = l, Σ l = 1. Powers find it: l ← l S, from l = (1, 0, 0, …). The next eigenvalue is about ½, so about 50 steps are
// enough for 10⁻¹⁴.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/mixed_levels.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/stencil_block.h"
#include "subvol/error.h"

namespace subvol {

namespace detail {

namespace {

struct CellAtPoint {
    Index point;
    Index cell;
    CellKind kind;
    auto operator<=>(const CellAtPoint&) const = default;
};

/// The refinement matrices of the stars of all points. The new points of the cells at a point depend on those cells alone, and
/// these cells refine to cells that meet in the same way: the matrix is the same at every level.
class Stars {
public:
    Stars(const MixedMesh& mesh, TetScheme scheme)
        : level_(level_of(mesh, scheme, {})),
          numbers_(level_.cells, level_.points),
          rows_(refine_level(level_, numbers_, scheme).table.csr()) {
        std::vector<std::size_t> starts;
        std::size_t total = 0;
        each_kind_of(level_.cells, [&](CellKind, const auto& cells) {
            starts.push_back(total);
            total += cells.size();
        });
        at_points_ = bucket_sort<CellAtPoint>(
            total, level_.points,
            [&](std::size_t i, const auto& sink) {
                const auto k = static_cast<std::size_t>(std::upper_bound(starts.begin(), starts.end(), i) - starts.begin()) - 1;
                const auto c = static_cast<Index>(i - starts[k]);
                with_cell(static_cast<CellKind>(k), c, [&](const auto& cell) {
                    for (const Index p : cell) sink(CellAtPoint{p, c, static_cast<CellKind>(k)});
                });
            },
            [](const CellAtPoint& record) { return std::size_t{record.point}; });
    }

    [[nodiscard]] std::size_t points() const { return level_.points; }
    [[nodiscard]] bool moves(Index v) const { return level_.boundary.kinds[v] != PointKind::Corner; }

    /// The points of the star, sorted, each with the new point that corresponds to it.
    void star_of(Index v, std::vector<std::pair<Index, Index>>& star) const {
        star.assign(1, {v, v});
        for (std::size_t i = at_points_.offsets[v]; i < at_points_.offsets[v + 1]; ++i) {
            const auto& [point, c, kind] = at_points_.records[i];
            with_cell(kind, c, [&, c = c, kind = kind](const auto& cell) {
                for (const Index w : cell) {
                    if (w != v) star.emplace_back(w, middle(kind, c, v, w));
                }
            });
        }
        std::sort(star.begin(), star.end());
        star.erase(std::unique(star.begin(), star.end()), star.end());
        // A point that two cells reach by different middles would need two columns; after one refinement there are no such
        // stars.
        for (std::size_t i = 1; i < star.size(); ++i) {
            if (star[i].first != star[i - 1].first) continue;
            throw Error(ErrorCode::InvalidInput,
                        "the cells at point " + std::to_string(v) + " reach point " + std::to_string(star[i].first) +
                            " in more than one way",
                        "limits of vertices", "refine the mesh once first");
        }
    }

    template <class Visit>
    void row(Index fine, const Visit& visit) const {
        for (std::size_t i = rows_.offsets[fine]; i < rows_.offsets[fine + 1]; ++i) visit(rows_.columns[i], rows_.weights[i]);
    }

private:
    template <class Call>
    void with_cell(CellKind kind, Index c, const Call& call) const {
        switch (kind) {
            case CellKind::Tet:
                return call(level_.cells.tets[c]);
            case CellKind::Octahedron:
                return call(level_.cells.octahedra[c]);
            case CellKind::Prism:
                return call(level_.cells.prisms[c]);
            case CellKind::Pyramid:
                return call(level_.cells.pyramids[c]);
            case CellKind::Hex:
                return call(level_.cells.hexes[c]);
        }
    }

    /// The new point between v and w, two corners of a cell: on their edge, else in the middle of an octahedron, of a quad that
    /// has both, or of the hexahedron. The cell itself is asked for the edge, since another cell may join the same two points
    /// by one.
    Index middle(CellKind kind, Index c, Index v, Index w) const {
        if (numbers_.has_edge(v, w) && has_edge(kind, c, v, w)) return numbers_.edge(v, w);
        if (kind == CellKind::Octahedron) return numbers_.center_of_octahedron(c);
        Index found = kNone;
        with_cell(kind, c, [&](const auto& cell) {
            for (const auto& face : table_of(kind).faces) {
                if (face[3] < 0) continue;
                const auto corners = face_of(cell, face);
                const auto has = [&](Index p) { return std::find(corners.begin(), corners.end(), p) != corners.end(); };
                if (has(v) && has(w)) found = numbers_.quad(corners);
            }
        });
        return found != kNone ? found : numbers_.center_of_hex(c);
    }

    bool has_edge(CellKind kind, Index c, Index v, Index w) const {
        bool found = false;
        with_cell(kind, c, [&](const auto& cell) {
            for (const auto& [a, b] : table_of(kind).edges) {
                found |= (at(cell, a) == v && at(cell, b) == w) || (at(cell, a) == w && at(cell, b) == v);
            }
        });
        return found;
    }

    MixedLevel level_;
    SplitNumbers numbers_;
    CsrMatrix rows_;
    Buckets<CellAtPoint> at_points_;
};

/// Finds the left eigenvector of a star by powers of its matrix. The matrix is sparse, so its terms are listed once and each
/// step goes through the list; corners, which no rule moves, are their own limit.
class LimitRow {
public:
    explicit LimitRow(const Stars& stars) : stars_(stars) {}

    void write(Index v, StencilBuilder& row) {
        if (!stars_.moves(v)) return row.add(v, 1.0);
        stars_.star_of(v, star_);
        collect_terms();
        weights_.assign(star_.size(), 0.0);
        weights_[place(v)] = 1;
        constexpr int kMostSteps = 200;
        constexpr double kLimitTol = 1e-14;  // of a weight in a step; what is left is a geometric series of ratio about ½
        // The start is l = (1, 0, 0, …), the point itself; every start with a sum of 1 leads to the same l.
        double change = 1;
        for (int step = 0; step < kMostSteps && change > kLimitTol; ++step) {
            next_.assign(star_.size(), 0.0);
            for (const Term& term : terms_) next_[term.column] += weights_[term.row] * term.weight;
            change = 0;
            for (std::size_t r = 0; r < star_.size(); ++r) change = std::max(change, std::abs(next_[r] - weights_[r]));
            weights_.swap(next_);
        }
        for (std::size_t r = 0; r < star_.size(); ++r) row.add(star_[r].first, weights_[r]);
    }

private:
    struct Term {
        std::size_t row, column;
        double weight;
    };

    void collect_terms() {
        terms_.clear();
        for (std::size_t r = 0; r < star_.size(); ++r) {
            stars_.row(star_[r].second, [&](Index p, double w) { terms_.push_back({r, place(p), w}); });
        }
    }

    [[nodiscard]] std::size_t place(Index p) const {
        const auto found = std::lower_bound(star_.begin(), star_.end(), std::pair<Index, Index>{p, 0});
        return static_cast<std::size_t>(found - star_.begin());
    }

    const Stars& stars_;
    std::vector<std::pair<Index, Index>> star_;
    std::vector<Term> terms_;
    std::vector<double> weights_, next_;
};

}  // namespace

StarMatrix star_matrix(const MixedMesh& mesh, TetScheme scheme, Index point) {
    const Stars stars(mesh, scheme);
    std::vector<std::pair<Index, Index>> star;
    stars.star_of(point, star);
    std::stable_partition(star.begin(), star.end(), [&](const auto& entry) { return entry.first == point; });
    StarMatrix result;
    for (const auto& entry : star) result.points.push_back(entry.first);
    for (const auto& entry : star) {
        std::vector<double> row(star.size());
        stars.row(entry.second, [&](Index p, double w) {
            row[static_cast<std::size_t>(std::find(result.points.begin(), result.points.end(), p) - result.points.begin())] = w;
        });
        result.weights.insert(result.weights.end(), row.begin(), row.end());
    }
    return result;
}

}  // namespace detail

StencilTable limit_table(const MixedMesh& mesh, TetScheme scheme) {
    const detail::Stars stars(mesh, scheme);
    std::vector<StencilTable::Block> blocks((stars.points() + detail::kBlockRows - 1) / detail::kBlockRows);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        detail::StencilBlockWriter writer;
        detail::StencilBuilder row;
        detail::LimitRow limit(stars);
        writer.start(b * detail::kBlockRows);
        for (std::size_t v = b * detail::kBlockRows; v < std::min(stars.points(), (b + 1) * detail::kBlockRows); ++v) {
            row.clear();
            limit.write(static_cast<Index>(v), row);
            writer.push(row.finish());
        }
        blocks[b] = writer.block();
    });
    return {stars.points(), 0, std::move(blocks)};
}

}  // namespace subvol
