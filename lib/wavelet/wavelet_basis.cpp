// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>

#include "child_topology.h"
#include "refine_steps.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/refine.h"
#include "subvol/wavelet.h"
#include "wavelet_star.h"

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
