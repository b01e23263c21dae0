// SPDX-License-Identifier: Apache-2.0
// Points x of a patch move as little as possible until no corner of the cells' descendants is too small:
//
//     min Σ wᵀ W w + μ Σ max(0, least − d)²,   w = (x − start) / edge,   d = determinant at a corner / volume
//
// The volume is the cell's mean determinant, and at least a part of that of the cells around, so that a folded cell has to
// grow. `least` is the cell's share; a corner that is sound in a cell to be kept may fall to 0.7 of what it has at the start.
//
// For μ = 100, then ten times as much, four values in all: Gauss-Newton steps, each by conjugate gradients, with the refinement
// multiplied out for the points of corners that lack something. A step is halved, ten times at most, until the cost falls by a
// hundredth, and ways are cut to each point's reach; if halving does not help, the next μ follows. Work is counted in tests of
// cells that would take as long.
#include "movable_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/sparse_rows.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

constexpr double kProducts = 8000;  // of vectors with numbers, that take as long as a test of a cell
constexpr double kKept = 0.7;       // a determinant that is small but sound may fall by a third

double determinant_at(const std::vector<Vec3>& x, const std::array<Index, 4>& p) {
    return glm::dot(x[p[1]] - x[p[0]], glm::cross(x[p[2]] - x[p[0]], x[p[3]] - x[p[0]]));
}

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += dot(a[k], b[k]);
    return sum;
}

}  // namespace

MovablePatch::MovablePatch(const HexMesh& patch, const SchemeOptions& scheme, int levels, std::vector<Vec3> start,
                           std::vector<Freedom> freedom, const std::vector<PatchCell>& cells)
    : tables_(refinement_tables(build_topology(patch), {.scheme = scheme, .levels = levels})),
      points_(patch.points),
      start_(std::move(start)),
      freedom_(std::move(freedom)) {
    for (const StencilTable& table : tables_.levels) rows_.push_back(table.csr());
    make_corners(patch, cells);
    constexpr double kTablesOfCell = 50;
    tests_ = kTablesOfCell * static_cast<double>(patch.cells.size());
}

void MovablePatch::make_corners(const HexMesh& patch, const std::vector<PatchCell>& cells) {
    const std::vector<Vec3> x = fine(start_);
    const std::size_t children = tables_.cells.size() / patch.cells.size();
    const auto corners_of = [&](std::size_t cell, const auto& visit) {
        for (std::size_t child = cell * children; child < (cell + 1) * children; ++child) {
            const auto& points = tables_.cells[child];
            for (std::size_t k = 0; k < 8; ++k) {
                const auto& [a, b, c] = kCornerNeighbors[k];
                visit(std::array<Index, 4>{points[k], points[a], points[b], points[c]});
            }
        }
    };
    // The mean determinant of a cell is its volume over the number of children. A cell that is folded or thin beside those
    // around it has to become a part of their mean.
    std::vector<double> means(patch.cells.size(), 0), at_points(patch.points.size(), 0), counts(patch.points.size(), 0);
    for (std::size_t c = 0; c < patch.cells.size(); ++c) {
        corners_of(c, [&](const std::array<Index, 4>& at) {
            means[c] += determinant_at(x, at) / (8.0 * static_cast<double>(children));
        });
        for (const Index p : patch.cells[c]) {
            at_points[p] += std::max(0.0, means[c]);
            counts[p] += 1;
        }
    }
    constexpr double kOfAround = 0.2;
    for (std::size_t c = 0; c < patch.cells.size(); ++c) {
        if (cells[c].role == CellRole::Around) continue;
        double around = 0;
        for (const Index p : patch.cells[c]) around += at_points[p] / counts[p] / 8;
        const double volume = std::max(means[c], kOfAround * around);
        if (!(volume > 0)) continue;
        corners_of(c, [&](const std::array<Index, 4>& at) {
            const double then = determinant_at(x, at) / volume;
            const bool sound = cells[c].role == CellRole::Kept && then > 0;
            corners_.push_back({at, volume, sound ? std::min(cells[c].share, kKept * then) : cells[c].share});
        });
    }
}

std::vector<Vec3> MovablePatch::fine(const std::vector<Vec3>& points) const {
    std::vector<Vec3> fine(tables_.points());
    tables_.apply(std::span<const double>(&points.front().x, 3 * points.size()), 3,
                  std::span<double>(&fine.front().x, 3 * fine.size()));
    return fine;
}

std::vector<MovablePatch::Active> MovablePatch::lacking(const std::vector<Vec3>& points) const {
    const std::vector<Vec3> x = fine(points);
    std::vector<Active> lacks;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const Corner& at = corners_[k];
        const double lack = at.least - determinant_at(x, at.points) / at.volume;
        if (!(lack > 0)) continue;
        const auto& [p, a, b, c] = at.points;
        const Vec3 u = x[a] - x[p], v = x[b] - x[p], w = x[c] - x[p];
        Active& active = lacks.emplace_back(Active{k, lack, {}});
        active.gradient[1] = glm::cross(v, w) / at.volume;
        active.gradient[2] = glm::cross(w, u) / at.volume;
        active.gradient[3] = glm::cross(u, v) / at.volume;
        active.gradient[0] = -(active.gradient[1] + active.gradient[2] + active.gradient[3]);
    }
    return lacks;
}

double MovablePatch::cost(const std::vector<Vec3>& points, const std::vector<Active>& lacks, double weight) const {
    double sum = 0;
    for (const Active& at : lacks) sum += weight * at.lack * at.lack;
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (freedom_[p].reach == 0) continue;
        const Vec3 way = (points[p] - start_[p]) / freedom_[p].edge;
        sum += dot(way, freedom_[p].weight * way);
    }
    return sum;
}

// Few points are active, so their rows are multiplied out: that is cheaper than to refine the patch in each step.
MovablePatch::ActiveMatrix MovablePatch::matrix_of(const std::vector<Active>& lacks) const {
    ActiveMatrix made;
    std::vector<Index> active, rows(tables_.points(), kNone);
    for (const Active& at : lacks) {
        auto& corner = made.corners.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) {
            const Index p = corners_[at.corner].points[i];
            if (rows[p] == kNone) {
                rows[p] = static_cast<Index>(active.size());
                active.push_back(p);
            }
            corner[i] = rows[p];
        }
    }
    std::vector<double> sums(points_.size(), 0);
    const auto add = [&](const auto& self, std::size_t level, Index point, double weight, std::vector<Index>& touched) -> void {
        if (level == 0) {
            if (freedom_[point].reach == 0) return;
            if (sums[point] == 0) touched.push_back(point);
            sums[point] += weight * freedom_[point].edge;
            return;
        }
        const CsrMatrix& table = rows_[level - 1];
        for (std::size_t k = table.offsets[point]; k < table.offsets[point + 1]; ++k) {
            self(self, level - 1, table.columns[k], weight * table.weights[k], touched);
        }
    };
    std::vector<Index> touched;
    for (const Index p : active) {
        touched.clear();
        add(add, rows_.size(), p, 1, touched);
        std::ranges::sort(touched);
        for (const Index c : touched) {
            const double weight = std::exchange(sums[c], 0);
            if (weight == 0) continue;
            made.matrix.columns.push_back(c);
            made.matrix.weights.push_back(weight);
        }
        made.matrix.offsets.push_back(made.matrix.columns.size());
    }
    made.transpose = transpose_of(made.matrix, points_.size());
    return made;
}

// The Gauss-Newton step, by conjugate gradients, in edges. A is the change of the determinants with the points in their edges.
std::vector<Vec3> MovablePatch::step(const std::vector<Vec3>& points, const std::vector<Active>& lacks, double weight) {
    const ActiveMatrix active = matrix_of(lacks);
    const auto pulled = [&](const auto& by) {  // Aᵀ y
        std::vector<Vec3> forces(row_count(active.matrix), Vec3(0.0));
        for (std::size_t k = 0; k < lacks.size(); ++k) {
            const double pull = weight * by(k);
            for (std::size_t i = 0; i < 4; ++i) forces[active.corners[k][i]] += pull * lacks[k].gradient[i];
        }
        return product_with(active.transpose, forces);
    };
    std::vector<Vec3> rest = pulled([&](std::size_t k) { return lacks[k].lack; });
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (freedom_[p].reach > 0) rest[p] -= freedom_[p].weight * ((points[p] - start_[p]) / freedom_[p].edge);
    }
    const auto applied = [&](const std::vector<Vec3>& to) {
        const std::vector<Vec3> moved = product_with(active.matrix, to);
        std::vector<Vec3> sums = pulled([&](std::size_t k) {
            double change = 0;
            for (std::size_t i = 0; i < 4; ++i) change += dot(lacks[k].gradient[i], moved[active.corners[k][i]]);
            return change;
        });
        for (std::size_t p = 0; p < to.size(); ++p) sums[p] += freedom_[p].weight * to[p];
        return sums;
    };
    std::vector<Vec3> found(points.size(), Vec3(0.0));
    constexpr int kSteps = 40;
    constexpr double kEnough = 1e-4;
    double enough = 0;
    const auto entries = static_cast<double>(active.matrix.columns.size());
    constexpr double kOfMatrix = 8;  // products that take as long as to make it
    tests_ += kOfMatrix * entries / kProducts;
    conjugate_gradients(
        found, rest,
        [&](std::vector<Vec3>& gradient) {
            gradient = rest;
            return product(rest, rest);
        },
        [&](const std::vector<Vec3>& way, std::vector<Vec3>& image) {
            tests_ += (2 * entries + static_cast<double>(points.size())) / kProducts;
            image = applied(way);
        },
        product,
        [&](int step, double left) {
            if (step == 0) enough = kEnough * left;
            return step < kSteps && left > enough;
        });
    return found;
}

std::vector<Vec3> MovablePatch::move(const std::function<bool(double)>& goes_on) {
    double refined = static_cast<double>(corners_.size());
    for (const CsrMatrix& table : rows_) refined += static_cast<double>(table.columns.size());
    const auto moved = [&](const std::vector<Vec3>& step, double part) {
        std::vector<Vec3> points = points_;
        for (std::size_t p = 0; p < points.size(); ++p) {
            const Freedom& at = freedom_[p];
            if (at.reach == 0) continue;
            Vec3 way = points[p] + part * at.edge * step[p] - start_[p];
            const double length = glm::length(way);
            if (length > at.reach) way *= at.reach / length;
            points[p] = start_[p] + way;
        }
        return points;
    };
    std::vector<Active> lacks = lacking(points_);
    constexpr int kWeights = 4, kNewton = 6;
    double weight = 100;
    for (int k = 0; k < kWeights; ++k, weight *= 10) {
        double now = cost(points_, lacks, weight);
        for (int n = 0; n < kNewton; ++n) {
            if (!goes_on(static_cast<double>(k * kNewton + n) / (kWeights * kNewton))) return points_;
            const std::vector<Vec3> way = step(points_, lacks, weight);
            double part = 1;
            bool better = false;
            constexpr int kHalvings = 10;
            constexpr double kProgress = 1e-2;
            for (int h = 0; h < kHalvings && !better; ++h, part /= 2) {
                std::vector<Vec3> points = moved(way, part);
                std::vector<Active> next = lacking(points);
                tests_ += refined / kProducts;
                const double then = cost(points, next, weight);
                if (!(then < now * (1 - kProgress))) continue;
                better = true;
                points_ = std::move(points);
                lacks = std::move(next);
                now = then;
            }
            if (!better) break;
        }
    }
    return points_;
}

}  // namespace subvol::detail
