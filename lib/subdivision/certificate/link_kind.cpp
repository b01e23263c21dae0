// SPDX-License-Identifier: Apache-2.0
// Kinds of irregular points. Symbols as in the header.
//
// Roundings: χ, L and M are doubles that need not be exact, since A and ρ may be any with P = 1 c + χ A + ρ. What they lack of
// eigenvectors is R, C and the part of ρ that Π does not keep. These are below kOfSteps (checked). Each level adds them to q
// and to M; so ν is taken 10⁻⁶ smaller, and r 1 % smaller, than all that such small numbers can add up to.
#include "link_kind.h"

#include <tbb/task_arena.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "cell_parts.h"
#include "enclosure.h"
#include "fold_test.h"
#include "kept.h"
#include "spline_rows.h"

namespace subvol::detail {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOfTables = 0x1p-45;  // relative error of the sums of a row of rules
constexpr double kOfSteps = 1e-10;     // bound of R, C and of what Π lacks of a projection
constexpr double kSlower = 1e-6;
constexpr double kDown = 0.98;

MatrixXd with_constants(const MatrixXd& map) {
    MatrixXd kept(map.rows(), 4);
    kept << VectorXd::Ones(map.rows()), map;
    return kept;
}

// Three vectors of the largest eigenvalues after 1, of a basis in which T is diagonal; nothing if there is none. 1 is taken off
// by its left vector.
struct Subspace {
    MatrixXd map, left;
    Eigen::Vector3d rates;
};

MatrixXd orthonormal(const MatrixXd& columns) {
    return Eigen::HouseholderQR<MatrixXd>(columns).householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
}

std::optional<Subspace> subspace_of(const MatrixXd& step) {
    constexpr int kPowers = 400;
    const Eigen::Index n = step.rows();
    // All four right and left vectors at once, in bases that are orthonormal.
    MatrixXd start(n, 4);
    for (Eigen::Index k = 0; k < n; ++k) {
        for (Eigen::Index c = 0; c < 4; ++c)
            start(k, c) = c == 0 ? 1 : std::sin(1.0 + static_cast<double>((k + 1) * (2 * c + 1)));
    }
    MatrixXd right = orthonormal(start), left = right;
    for (int k = 0; k < kPowers; ++k) {
        right = orthonormal(step * right);
        left = orthonormal(step.transpose() * left);
    }
    // The small matrix of T on them: right vectors are those of its eigenvectors.
    const Eigen::Matrix4d small = right.transpose() * step * right;
    const Eigen::EigenSolver<Eigen::Matrix4d> solver(small, false);
    std::array<double, 4> values{};
    for (Eigen::Index c = 0; c < 4; ++c) {
        if (std::abs(solver.eigenvalues()(c).imag()) > 1e-6) return std::nullopt;
        values[static_cast<std::size_t>(c)] = solver.eigenvalues()(c).real();
    }
    std::ranges::sort(values, std::greater());
    if (!(std::abs(values[0] - 1) < 1e-8) || !(values[1] < 0.9) || !(values[3] > 0.05)) return std::nullopt;
    Subspace found;
    found.map.resize(n, 3);
    Eigen::Index filled = 0;
    constexpr double kSame = 1e-6;
    while (filled < 3) {
        // Values that are the same share a space, of which an orthonormal basis is taken.
        Eigen::Index count = 1;
        const auto value = [&](Eigen::Index k) { return values[static_cast<std::size_t>(k + 1)]; };
        while (filled + count < 3 && value(filled) - value(filled + count) < kSame) ++count;
        double mean = 0;
        for (Eigen::Index k = 0; k < count; ++k) mean += value(filled + k) / static_cast<double>(count);
        const Eigen::JacobiSVD<Eigen::Matrix4d> svd(small - mean * Eigen::Matrix4d::Identity(), Eigen::ComputeFullV);
        found.map.middleCols(filled, count) = orthonormal(right * svd.matrixV().rightCols(count));
        for (Eigen::Index k = 0; k < count; ++k) found.rates(filled + k) = mean;
        filled += count;
    }
    // Of the size of coordinates in cells.
    found.map *= std::sqrt(static_cast<double>(n)) * 1.2;
    const MatrixXd kept = with_constants(found.map);
    found.left = left * (kept.transpose() * left).inverse();
    return found;
}

// The spread of some rows over a window: for each point the length of its column, times its weight if the rows are scaled.
double size_of_rows(const Eigen::Ref<const RowsXd>& rows) {
    return rows.colwise().norm().sum();
}

/// Rows of a spline cell's derivatives, as Bernstein coefficients of degree 3; scaled.
using Derivatives = std::array<RowsXd, 3>;

// How large q may be so that the cell of χ + q does not fold: (1 − κ)/G. 0 or less if χ itself is not proved.
//
// map: χ, scaled; row_norm: of the rows to the spline's points
double reach_at_once(const Derivatives& derivatives, const MatrixXd& map, double row_norm) {
    std::array<MatrixXd, 3> of_map;
    Matrix3d mean;
    for (std::size_t a = 0; a < 3; ++a) {
        of_map[a].noalias() = derivatives[a] * map;
        mean.row(static_cast<Eigen::Index>(a)) = of_map[a].colwise().mean();
    }
    if (!(mean.determinant() > 0)) return 0;
    const Matrix3d inverse = mean.inverse();
    const double rounded = 0x1p-42 * 6 * row_norm * inverse.cwiseAbs().rowwise().sum().maxCoeff();
    double kappa = 0, size = 0;
    RowsXd three(3, derivatives[0].cols());
    for (Eigen::Index k = 0; k < 64; ++k) {
        Matrix3d j;
        for (Eigen::Index a = 0; a < 3; ++a) j.row(a) = of_map[static_cast<std::size_t>(a)].row(k);
        kappa = std::max(kappa, (inverse * j - Matrix3d::Identity()).norm());
        if (!(kappa < 1)) return 0;
        for (Eigen::Index a = 0; a < 3; ++a) {
            three.row(a) = inverse(a, 0) * derivatives[0].row(k) + inverse(a, 1) * derivatives[1].row(k) +
                           inverse(a, 2) * derivatives[2].row(k);
        }
        size = std::max(size, size_of_rows(three));
    }
    kappa += 9 * rounded * (1 + map.cwiseAbs().maxCoeff());
    size += 3 * rounded;
    return (1 - kappa) / size * (1 - 1e-9);
}

// The same by parts of the cell, where the whole one does not reach as far as wanted.
double cell_reach(const RowsXd& rows, const MatrixXd& map, double row_norm, double wanted) {
    RowsXd bezier = rows;
    for (const Eigen::Index axis : {0, 1, 2}) bezier = along_axis(bezier_of_spline(), bezier, axis);
    Derivatives derivatives;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        derivatives[static_cast<std::size_t>(axis)] = along_axis(derivative_of_bezier(), bezier, axis);
    }
    const double whole = reach_at_once(derivatives, map, row_norm);
    if (whole >= wanted) return whole;
    double parts = wanted;
    for (int part = 0; part < 8 && parts > whole; ++part) {
        Derivatives on_part = derivatives;
        for (RowsXd& some : on_part) {
            for (const Eigen::Index axis : {0, 1, 2}) some = along_axis(half_of_bezier((part >> axis & 1) != 0), some, axis);
        }
        parts = std::min(parts, reach_at_once(on_part, map, row_norm));
    }
    return std::max(whole, parts);
}

/// A segment of χ + q, and its halves.
class SegmentReach {
public:
    SegmentReach(const SegmentRules& rules, const MatrixXd& map) : rules_(rules), map_(map) {
        const EdgeKind& kind = *rules.kind;
        const auto count = static_cast<Eigen::Index>(kind.weights.size());
        left_.resize(count, 6);
        kept_.resize(count, 5);
        for (Eigen::Index k = 0; k < count; ++k) {
            const auto p = static_cast<std::size_t>(k);
            const auto& left = kind.left[p];
            const auto& map_of_edge = kind.characteristic[p];
            left_.row(k) << left[0], left[1], left[2], left[3], kind.slow_left[p][0], kind.slow_left[p][1];
            kept_.row(k) << map_of_edge[0], map_of_edge[1], map_of_edge[2], kind.slow[p][0], kind.slow[p][1];
        }
    }

    // The largest r that can be proved at a depth, as far as `wanted` needs it. rows: to the window, scaled
    [[nodiscard]] double of(const RowsXd& rows, double wanted, int depth) const {
        const double whole = at_once(rows);
        if (whole >= wanted || depth == 0) return whole;
        double parts = wanted;
        const double row_norm = norm(rows);
        const RowsXd ring = rules_.ring.rows * rows;
        for (std::size_t piece = 0; piece < rules_.ring.points.size(); ++piece) {
            parts = std::min(parts, cell_reach(rules_.ring.of(piece, ring), map_, row_norm, parts));
            if (parts <= whole) return whole;
        }
        for (const SparseRowsXd& half : rules_.halves) {
            parts = std::min(parts, of(half * rows, wanted, depth - 1));
            if (parts <= whole) return whole;
        }
        return parts;
    }

private:
    // By the constants of the edge, for all q with |q| ≤ r.
    [[nodiscard]] double at_once(const RowsXd& rows) const {
        const EdgeKind& kind = *rules_.kind;
        const MatrixXd base = rows * map_, fit = left_.transpose() * base;
        const RowsXd fits = left_.transpose() * rows;
        const Matrix3d a = fit.middleRows(1, 3);
        if (!(a.determinant() > 1e-9 * a.row(0).norm() * a.row(1).norm() * a.row(2).norm())) return 0;
        const Matrix3d inverse = a.inverse();
        const double height = up(inverse.norm()), height_across = up(inverse.leftCols(2).norm()),
                     height_along = up(inverse.col(2).norm());
        const double fitted = up(size_of_rows(fits.middleRows(1, 3))), fitted_slow = up(size_of_rows(fits.bottomRows(2)));
        const MatrixXd rest = (base.rowwise() - fit.row(0)) - kept_ * fit.bottomRows(5);
        const MatrixXd q = rest * inverse, slow = fit.bottomRows(2) * inverse;
        RowsXd rests = rows.rowwise() - fits.row(0);
        rests -= kept_ * fits.bottomRows(5);
        const VectorXd sizes = rests.cwiseAbs().rowwise().sum();
        constexpr double kRounded = 1e-8;  // of L, χ, ψ and all sums, for numbers of the size of some cells
        const double rounded = kRounded * kind.spread * height * (1 + base.cwiseAbs().maxCoeff());
        const double slow_across = spectral_norm(slow.leftCols(2)), slow_along = slow.col(2).norm();
        const auto passes = [&](double r) {
            const double beta = height * fitted * r + rounded;
            if (!(beta < 0.5)) return false;
            const double factor = beta / (1 - beta);
            double across = 0, along = 0;
            for (Eigen::Index k = 0; k < q.rows(); ++k) {
                const double d = kind.weights[static_cast<std::size_t>(k)];
                const double y12 = std::hypot(q(k, 0), q(k, 1)) + height_across * sizes(k) * r + rounded;
                const double y3 = std::abs(q(k, 2)) + height_along * sizes(k) * r + rounded;
                const double mixed = std::hypot(y12, y3) * factor;
                across = std::max(across, (y12 + mixed) / d);
                along = std::max(along, (y3 + mixed) / d);
            }
            const double c12 = slow_across + height_across * fitted_slow * r + rounded;
            const double c3 = slow_along + height_along * fitted_slow * r + rounded;
            const double mixed = std::hypot(std::numbers::sqrt2 * c12, c3) * factor;
            const double bend_across = kind.slow_size * (c12 + mixed), bend_along = kind.slow_size * (c3 + mixed);
            return bend_across < 1 &&
                   across * (kind.across + bend_along * kind.along) / (1 - bend_across) + kind.along * along < 0.999;
        };
        constexpr double kMost = 0.25;
        constexpr int kTries = 10;
        double r = kMost;
        for (int k = 0; k < kTries; ++k, r /= 1.5) {
            if (passes(r)) return r;
        }
        return 0;
    }

    const SegmentRules& rules_;
    const MatrixXd& map_;
    MatrixXd left_, kept_;  // of 1, χ and ψ; χ and ψ
};

}  // namespace

LinkKind make_link_kind(Scheme scheme, const PointLink& link) {
    LinkKind kind;
    const PointRules rules = point_rules(scheme, link);
    const auto subspace = subspace_of(rules.step);
    if (!subspace) return kind;
    const Eigen::Index n = rules.step.rows();
    kind.characteristic = subspace->map;
    kind.left = subspace->left;
    kind.rates.assign(subspace->rates.begin(), subspace->rates.end());
    kind.shell = spline_pieces(rules.shell);
    kind.weights = VectorXd::Ones(n);
    const PointStar star(link, PointWindow::kReach);
    star.each([&](std::size_t t, const std::array<int, 3>& s) {
        const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        kind.weights(static_cast<Eigen::Index>(star.number(t, s))) = std::max(1.0, square);
    });
    for (const auto& segment : rules.segments) {
        const SegmentRules& of_segment = segment_rules(scheme, segment.cells);
        if (!of_segment.kind->is_bounded()) return kind;
        kind.segments.push_back({&of_segment, segment.rows.sparseView()});
    }
    // The same orientation as the cells.
    if (rules.shell.empty()) return kind;
    const MatrixXd spline = rules.shell[0] * kind.characteristic;
    Matrix3d slope;
    slope << spline.row(37) - spline.row(21), spline.row(25) - spline.row(21), spline.row(22) - spline.row(21);
    if (slope.determinant() < 0) {
        kind.characteristic.col(2) *= -1;
        kind.left.col(3) *= -1;
    }

    const VectorXd inverse_weights = kind.weights.cwiseInverse();
    const auto enclosed = [](const MatrixXd& near) { return Enclosure{near, up(4 * kUnitRoundoff * norm(near))}; };
    const Enclosure kept = enclosed(inverse_weights.asDiagonal() * with_constants(kind.characteristic));
    const Enclosure lefts = enclosed(kind.left.transpose() * kind.weights.asDiagonal());
    Enclosure step{inverse_weights.asDiagonal() * rules.step * kind.weights.asDiagonal(), 0};
    step.off = up(kOfTables * norm(step.near));
    const Enclosure projection = minus({MatrixXd::Identity(n, n), 0}, times(kept, lefts));
    const Enclosure after = times(step, projection), drift = times(lefts, after), rest = times(projection, after);
    MatrixXd rates = MatrixXd::Zero(4, 4);
    rates.diagonal() << 1, subspace->rates;
    const Enclosure residual = minus(times(step, kept), times(kept, Enclosure{rates, 0}));
    const double not_unit = minus(times(lefts, kept), {MatrixXd::Identity(4, 4), 0}).most();
    kind.spread = std::max(projection.most(), lefts.most());
    if (!(std::max({residual.most(), drift.most(), not_unit}) * kind.spread < kOfSteps)) return kind;
    kind.rest = kind.weights.asDiagonal() * rest.near * inverse_weights.asDiagonal();

    const double slowest = subspace->rates.minCoeff() * (1 - kSlower);
    constexpr int kMostPowers = 60;
    constexpr double kFalls = 0.9;
    Enclosure power = rest;
    double scale = slowest;
    kind.growth = 1;
    bool falls = false;
    for (int k = 1; k <= kMostPowers; ++k) {
        const double size = up(power.most() / scale);
        if (size < kFalls) {
            falls = true;
            break;
        }
        kind.growth = std::max(kind.growth, size);
        power = times(rest, power);
        scale *= slowest;
    }
    if (!falls) return kind;

    const MatrixXd map = kept.near.rightCols(3);
    // A larger r saves less than it costs to prove: one shell of data for each halving.
    constexpr double kWanted = 0.03;
    double reach = kWanted;
    for (const RowsXd& shell : rules.shell) {
        const RowsXd rows = shell * kind.weights.asDiagonal();
        reach = std::min(reach, cell_reach(rows, map, norm(rows), reach));
        if (!(reach > 0)) return kind;
    }
    for (const auto& segment : kind.segments) {
        reach = std::min(
            reach,
            SegmentReach(*segment.rules, map).of(RowsXd(segment.rows) * kind.weights.asDiagonal(), reach, kMostHalvings));
    }
    constexpr double kLeast = 1e-4;
    kind.reach = reach > kLeast ? kDown * reach : 0;
    return kind;
}

const LinkKind& link_kind(Scheme scheme, const PointLink& link) {
    static Kept<std::pair<Scheme, PointLink>, LinkKind> kept;
    return kept.get({scheme, link}, [&] {
        // Other tasks would wait for this one's lock.
        return tbb::this_task_arena::isolate([&] { return make_link_kind(scheme, link); });
    });
}

// Any A and ρ with P = 1 c + χ A + ρ will do.
bool proves_point(const LinkKind& kind, std::span<const Vec3> points, std::span<const Vec3> motion, double error) {
    if (!kind.is_bounded() || static_cast<Eigen::Index>(points.size()) != kind.weights.size()) return false;
    const auto rows_of = [](std::span<const Vec3> values) {
        MatrixXd rows(static_cast<Eigen::Index>(values.size()), 3);
        for (Eigen::Index k = 0; k < rows.rows(); ++k) {
            const Vec3 x = values[static_cast<std::size_t>(k)] - values[0];
            rows.row(k) << x.x, x.y, x.z;
        }
        return rows;
    };
    const bool moves = !motion.empty();
    const MatrixXd window = rows_of(points);
    const MatrixXd moved = moves ? rows_of(motion) : MatrixXd::Zero(window.rows(), 3);
    const MatrixXd fit = kind.left.transpose() * window, fit_of_motion = kind.left.transpose() * moved;
    const Matrix3d a = fit.bottomRows(3);
    if (!(a.determinant() > 1e-12 * a.row(0).norm() * a.row(1).norm() * a.row(2).norm())) return false;
    const Matrix3d inverse = a.inverse();
    const double height = inverse.cwiseAbs().sum(), size = window.cwiseAbs().maxCoeff() + moved.cwiseAbs().maxCoeff();
    if (!((inverse * a - Matrix3d::Identity()).cwiseAbs().sum() < 1e-6)) return false;
    constexpr double kRounded = 1e-12;
    const Matrix3d turning = fit_of_motion.bottomRows(3) * inverse;  // N
    const double turned = moves ? turning.norm() + kind.spread * kRounded * size * height : 0;
    if (!(turned < 0.9)) return false;
    const double factor = turned / (1 - turned);  // of (1 + s N)⁻¹ − 1, as for segments
    // What coordinates and sums may be off, in the coordinates of χ.
    const double slack = kind.spread * (2 * error + kRounded * size) * height * (1 + factor);
    if (!(slack < 1e-3)) return false;
    const auto rest_of = [&](const MatrixXd& values, const MatrixXd& of_values) {
        return MatrixXd(((values.rowwise() - of_values.row(0)) - kind.characteristic * of_values.bottomRows(3)) * inverse);
    };
    const Eigen::DiagonalMatrix<double, 3> faster(1 / kind.rates[0], 1 / kind.rates[1], 1 / kind.rates[2]);
    // q and what it changes by.
    std::vector<MatrixXd> rests{rest_of(window, fit)};
    std::vector<MatrixXd> changes{rest_of(moved, fit_of_motion) - rests[0] * turning};
    const auto size_at = [&](std::size_t level) {
        return (rests[level].rowwise().norm() + changes[level].rowwise().norm()).cwiseQuotient(kind.weights).maxCoeff();
    };
    const double turned_change = factor * changes[0].rowwise().norm().cwiseQuotient(kind.weights).maxCoeff();
    // How many shells there are until q is small enough: some fifty where the rest falls slowly. Errors of q grow as q does,
    // and each level adds some roundings.
    constexpr std::size_t kMostShells = 64;
    const auto off_at = [&](std::size_t level) {
        const double steps = 1 + 4 * static_cast<double>(level) * kind.growth * (1 + size_at(0));
        return (2 * slack + turned_change) * kind.growth + steps * kOfSteps;
    };
    while (true) {
        const std::size_t level = rests.size() - 1;
        if (kind.growth * (size_at(level) + off_at(level)) < kind.reach) break;
        if (level == kMostShells) return false;
        rests.emplace_back(kind.rest * rests.back() * faster);
        changes.emplace_back(kind.rest * changes.back() * faster);
    }
    rests.pop_back();
    // Segments first: where their parts are not proved, no cell has to be tested.
    const auto near_at = [&](std::size_t level) { return MatrixXd(kind.characteristic + rests[level]); };
    const auto change_at = [&](const SparseRowsXd& rows, std::size_t level) {
        return moves ? MatrixXd(rows * changes[level]) : MatrixXd(0, 3);
    };
    const auto error_at = [&](std::size_t level) {
        return 3 * off_at(level) * kind.weights.maxCoeff();  // beyond the boundary three times as much
    };
    std::vector<DividedSegment> divided;
    for (std::size_t level = 0; level < rests.size(); ++level) {
        for (const auto& segment : kind.segments) {
            const DividedSegment whole{segment.rules, segment.rows * near_at(level), change_at(segment.rows, level),
                                       error_at(level)};
            if (!divide_segment(whole, kMostHalvings, divided)) return false;
        }
    }
    for (std::size_t level = 0; level < rests.size(); ++level) {
        const MatrixXd change = moves ? changes[level] : MatrixXd(0, 3);
        if (!proves_pieces(kind.shell, near_at(level), change, error_at(level))) return false;
    }
    return std::ranges::all_of(divided, proves_ring);
}

}  // namespace subvol::detail
