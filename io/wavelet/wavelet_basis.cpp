// SPDX-License-Identifier: Apache-2.0
// The weights of wavelets over the levels of a control mesh, from the rows of the scheme alone. A level's new points have the
// values f_new = S c + d, S the scheme's rows, c the coarser values and d the details. From coarse to fine are found
//
//     star   of an old point v: the new points on its edges and faces and in its cells
//     U, D   S_v − Σ U S_new has no term but D c_v: linear equations for the weights U over the star, solved by elimination.
//            Schemes that interpolate need none. Where D is near 0 the rule cannot be turned round: an error
//
// and then from fine to coarse the measures and the lift:
//
//     m      integrals of the basis functions in finest cells: at first 1/8 for each corner of a cell, then Sᵀ m
//     A      the integral of a detail, m_new + Σ U m_v, in equal shares to the old points near it, each over the point's m
//
// so that means stay what they are when details are left out. Sums go row by row: they do not depend on the threads.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/incident.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/error.h"
#include "subvol/refine.h"
#include "subvol/wavelet.h"

namespace subvol::detail {

namespace {

/// Equations with as many right sides as one, in rows: the last number of a row is the right side.
class Equations {
public:
    Equations(std::size_t count, std::size_t unknowns) : rows_(count), width_(unknowns + 1), numbers_(count * width_, 0.0) {}

    double& at(std::size_t row, std::size_t column) { return numbers_[row * width_ + column]; }

    /// Gaussian elimination with complete pivoting; unknowns that the equations leave open become 0. False if the equations
    /// contradict each other.
    bool solve(std::span<double> unknowns) {
        const std::size_t n = unknowns.size();
        std::vector<std::size_t> order(n);
        for (std::size_t i = 0; i < n; ++i) order[i] = i;
        std::size_t rank = 0;
        for (; rank < std::min(n, rows_) && pivot(rank, order); ++rank) eliminate(rank);
        for (std::size_t r = rank; r < rows_; ++r) {
            if (std::abs(at(r, n)) > kContradiction) return false;
        }
        std::vector<double> solution(n, 0.0);
        for (std::size_t r = rank; r-- > 0;) {
            double sum = at(r, n);
            for (std::size_t c = r + 1; c < rank; ++c) sum -= at(r, c) * solution[c];
            solution[r] = sum / at(r, r);
        }
        for (std::size_t i = 0; i < n; ++i) unknowns[order[i]] = solution[i];
        return true;
    }

private:
    static constexpr double kContradiction = 1e-11, kRank = 1e-11;  // the weights of rules are at most 1

    bool pivot(std::size_t step, std::vector<std::size_t>& order) {
        std::size_t row = step, column = step;
        double most = 0;
        for (std::size_t r = step; r < rows_; ++r) {
            for (std::size_t c = step; c + 1 < width_; ++c) {
                if (std::abs(at(r, c)) > most) {
                    most = std::abs(at(r, c));
                    row = r;
                    column = c;
                }
            }
        }
        if (most < kRank) return false;
        if (row != step) {
            for (std::size_t c = 0; c < width_; ++c) std::swap(at(row, c), at(step, c));
        }
        if (column != step) {
            for (std::size_t r = 0; r < rows_; ++r) std::swap(at(r, column), at(r, step));
            std::swap(order[column], order[step]);
        }
        return true;
    }

    void eliminate(std::size_t step) {
        for (std::size_t r = step + 1; r < rows_; ++r) {
            const double factor = at(r, step) / at(step, step);
            if (factor == 0) continue;
            for (std::size_t c = step; c < width_; ++c) at(r, c) -= factor * at(step, c);
        }
    }

    std::size_t rows_, width_;
    std::vector<double> numbers_;
};

template <class Visit>
void each_term(const StencilRuns& row, const Visit& visit) {
    std::size_t next = 0;
    for (const auto& [weight, count] : row.runs) {
        for (std::uint32_t i = 0; i < count; ++i) visit(row.points[next++], weight);
    }
}

struct Term {
    Index point;
    std::size_t column;  // of the star; its size stands for the row of the point itself
    double weight;
};

/// The numbers, among the new points, of those on the edges and faces and in the cells of a point, ascending.
void star_of(const Topology& topology, Index point, std::vector<Index>& star) {
    const ChildNumbering first(topology);
    star.clear();
    const auto add = [&](std::size_t number) { star.push_back(static_cast<Index>(number - first.edges)); };
    for (const Index e : topology.point_edges[point]) add(first.edges + e);
    each_face_at(topology, point, [&](Index f, std::size_t) { add(first.faces + f); });
    each_cell_at(topology, point, [&](Index c, std::size_t) { add(first.cells + topology.cell_ordinal[c]); });
    std::sort(star.begin(), star.end());
}

/// The weights u with which the rows of the new points of a star, taken from the row of its point, leave no other term.
///
/// even:    one weight for each point of the star
/// returns: the weight D of the point itself that is left; 0 if there are no such weights
double solve_even_rule(const SchemeRows& rows, Index point, std::span<const Index> star, std::span<double> even) {
    std::vector<Term> terms;
    std::vector<Index> others;
    StencilBuilder builder;
    const auto add_row = [&](std::size_t number, std::size_t column) {
        builder.clear();
        rows.write_row(number, builder);
        each_term(builder.finish(), [&](Index p, double weight) {
            terms.push_back({p, column, weight});
            if (p != point) others.push_back(p);
        });
    };
    for (std::size_t i = 0; i < star.size(); ++i) add_row(rows.columns() + star[i], i);
    add_row(point, star.size());
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    Equations equations(others.size(), star.size());
    for (const Term& term : terms) {
        if (term.point == point) continue;
        const auto row = static_cast<std::size_t>(std::lower_bound(others.begin(), others.end(), term.point) - others.begin());
        equations.at(row, term.column) += term.weight;
    }
    if (!equations.solve(even)) return 0;
    double own = 0;
    for (const Term& term : terms) {
        if (term.point == point) own += term.column == star.size() ? term.weight : -even[term.column] * term.weight;
    }
    return own;
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

/// Where less than this of a point's own value is left, the rule is not turned round: values would be multiplied by its
/// inverse. Known values are 1/8 and more, and 0: Catmull-Clark's where three cells meet at an edge.
constexpr double kSmallestOwn = 1e-3;

void find_stars(const Topology& topology, WaveletStep& step) {
    auto& offsets = step.star.offsets;
    auto& values = step.star.values;
    offsets.assign(topology.point_count + 1, 0);
    parallel_each(topology.point_count, [&](std::size_t v) {
        thread_local std::vector<Index> star;
        star_of(topology, static_cast<Index>(v), star);
        offsets[v + 1] = star.size();
    });
    for (std::size_t v = 0; v < topology.point_count; ++v) offsets[v + 1] += offsets[v];
    values.resize(offsets.back());
    parallel_each(topology.point_count, [&](std::size_t v) {
        thread_local std::vector<Index> star;
        star_of(topology, static_cast<Index>(v), star);
        std::copy(star.begin(), star.end(), values.begin() + static_cast<std::ptrdiff_t>(offsets[v]));
    });
}

void find_even_rules(const SchemeRows& rows, const std::string& level, WaveletStep& step) {
    step.even.resize(step.star.values.size());
    step.own.resize(rows.columns());
    parallel_each(rows.columns(), [&](std::size_t v) {
        const std::size_t begin = step.star.offsets[v];
        step.own[v] = solve_even_rule(rows, static_cast<Index>(v), step.star[v],
                                      std::span(step.even).subspan(begin, step.star[v].size()));
    });
    for (std::size_t v = 0; v < rows.columns(); ++v) {
        if (std::abs(step.own[v]) >= kSmallestOwn) continue;
        throw Error(ErrorCode::InvalidInput, "the scheme's rule cannot be turned round at point " + std::to_string(v), level,
                    "that of mcq, bsxw and linear can on every mesh; that of cc not where three cells meet at an edge");
    }
}

/// Three neighbours of each new point, in the first of its cells.
void find_neighbours(const std::vector<std::array<Index, 8>>& cells, std::size_t old_points, WaveletStep& step) {
    const auto place = [](const std::array<int, 3>& p) {
        return static_cast<std::size_t>(4 * p[2] + (p[1] != 0 ? 3 - p[0] : p[0]));
    };
    step.beside.resize(step.new_points());
    for (std::size_t c = cells.size(); c-- > 0;) {
        for (std::size_t k = 0; k < 8; ++k) {
            if (cells[c][k] < old_points) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                auto next = kCornerParameters[k];
                next[a] = 1 - next[a];
                step.beside[cells[c][k] - old_points][a] = cells[c][place(next)];
            }
        }
    }
}

/// Sᵀ m, row after row so that the sums do not depend on threads.
std::vector<double> transposed(const StencilTable& table, std::span<const double> m) {
    std::vector<double> sums(table.columns(), 0.0);
    std::copy_n(m.begin(), table.kept(), sums.begin());
    for (const auto& block : table.blocks()) {
        const Index* point = block.points.data();
        for (std::size_t i = 0; i < block.row_patterns.size(); ++i) {
            const std::size_t pattern = block.row_patterns[i];
            for (std::size_t r = block.pattern_offsets[pattern]; r < block.pattern_offsets[pattern + 1]; ++r) {
                for (std::uint32_t k = 0; k < block.runs[r].count; ++k) {
                    sums[*point++] += block.runs[r].weight * m[block.first_row + i];
                }
            }
        }
    }
    return sums;
}

/// A detail and what it adds to old points have an integral; its share of each point near it has the opposite one.
void find_lift(WaveletStep& step, std::span<const double> coarse) {
    const std::size_t old_points = step.refine.columns();
    std::vector<double> integral(step.measure.begin() + static_cast<std::ptrdiff_t>(old_points), step.measure.end());
    std::vector<std::uint32_t> shares(step.new_points(), 0);
    for (std::size_t v = 0; v < old_points; ++v) {
        for (std::size_t i = step.star.offsets[v]; i < step.star.offsets[v + 1]; ++i) {
            const Index o = step.star.values[i];
            if (!step.even.empty()) integral[o] += step.even[i] * step.measure[v];
            if (coarse[v] > 0) ++shares[o];
        }
    }
    step.lift.assign(step.star.values.size(), 0.0);
    parallel_each(old_points, [&](std::size_t v) {
        if (coarse[v] <= 0) return;
        for (std::size_t i = step.star.offsets[v]; i < step.star.offsets[v + 1]; ++i) {
            const Index o = step.star.values[i];
            step.lift[i] = integral[o] / (shares[o] * coarse[v]);
        }
    });
}

}  // namespace

WaveletBasis wavelet_basis(const Topology& control, const WaveletOptions& options) {
    check_levels(options.levels);
    WaveletBasis basis;
    basis.control_points = control.point_count;
    basis.cells = control.cells;
    basis.creases = control.creases;
    for (std::size_t f = 0; f < control.face_is_sharp.size(); ++f) {
        if (control.face_is_sharp[f]) basis.sharp_faces.push_back(control.faces[f]);
    }
    Topology current;
    const Topology* parent = &control;
    for (int level = 1; level <= options.levels; ++level) {
        RefinementTables tables = refinement_tables(*parent, {.scheme = options.scheme, .progress = options.progress});
        WaveletStep& step = basis.steps.emplace_back();
        step.refine = std::move(tables.levels.front());
        find_stars(*parent, step);
        if (!interpolates(options.scheme.kind)) {
            find_even_rules(SchemeRows(*parent, options.scheme), "level " + std::to_string(level), step);
        }
        find_neighbours(tables.cells, step.refine.columns(), step);
        basis.cells = std::move(tables.cells);
        basis.creases = std::move(tables.creases);
        basis.sharp_faces = std::move(tables.sharp_faces);
        if (level < options.levels) {
            Topology child = child_topology(*parent);
            current = std::move(child);
            parent = &current;
        }
    }
    std::vector<double> measure(basis.points(), 0.0);
    for (const auto& cell : basis.cells) {
        for (const Index p : cell) measure[p] += 1.0 / 8;
    }
    for (std::size_t l = basis.steps.size(); l-- > 0;) {
        WaveletStep& step = basis.steps[l];
        step.measure = std::move(measure);
        measure = transposed(step.refine, step.measure);
        find_lift(step, measure);
    }
    basis.measure = std::move(measure);
    return basis;
}

}  // namespace subvol
