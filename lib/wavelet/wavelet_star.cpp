// SPDX-License-Identifier: Apache-2.0
#include "wavelet_star.h"

#include <algorithm>
#include <cmath>

#include "incident.h"

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

}  // namespace

void star_of(const Topology& topology, Index point, std::vector<Index>& star) {
    const ChildNumbering first(topology);
    star.clear();
    const auto add = [&](std::size_t number) { star.push_back(static_cast<Index>(number - first.edges)); };
    for (const Index e : topology.point_edges[point]) add(first.edges + e);
    each_face_at(topology, point, [&](Index f, std::size_t) { add(first.faces + f); });
    each_cell_at(topology, point, [&](Index c, std::size_t) { add(first.cells + topology.cell_ordinal[c]); });
    std::sort(star.begin(), star.end());
}

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

}  // namespace subvol::detail
