// SPDX-License-Identifier: Apache-2.0
// The constants of an edge segment. Symbols as in the header.
//
// Coordinates are scaled: a vector of the window has its entries divided by d, a row is multiplied by d, so that all norms are
// largest row sums. All matrices are enclosures (enclosure.h); what is not exact in them is
//
//     T      weights, rounded (kOfWeights)
//     χ, ψ   eigenvectors of frequency 1 and 2 among the sectors, enclosed (edge_modes.h)
//     L      any vectors near the left eigenvectors, and a correction that makes Lᵀ(1, χ) = 1
//     Π, T̄   products of these
//
// The rules are those of an edge that all sectors share alike: turning the star, its mirror images and exchanging the ends of
// the segment leave them as they are. So sector 0 and the lower half stand for all, and of its three cells two.
#include "edge_kind.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "edge_modes.h"
#include "enclosure.h"
#include "kept.h"
#include "spline_rows.h"

namespace subvol::detail {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Weights are quotients that are rounded once (edge_window.h). Symmetries and sums of weights may be off by some roundings.
constexpr double kOfWeights = kUnitRoundoff;
constexpr double kAlike = 0x1p-48;

// How far L may be off; a test of points allows for more.
constexpr double kOfLefts = 1e-9;

using Row = Eigen::Index;

Row row_of(std::size_t i) {
    return static_cast<Row>(i);
}

// Whether a symmetry takes the rules of one half to those of another.
bool is_alike(const MatrixXd& a, const MatrixXd& b, const std::vector<std::size_t>& to) {
    for (Row k = 0; k < a.rows(); ++k) {
        for (Row i = 0; i < a.cols(); ++i) {
            const double other = b(row_of(to[static_cast<std::size_t>(k)]), row_of(to[static_cast<std::size_t>(i)]));
            if (!(std::abs(a(k, i) - other) <= kAlike)) return false;
        }
    }
    return true;
}

// What the theorem takes for granted of the rules: means, the symmetries, layers that are at equal distances.
bool is_as_expected(const EdgeRules& rules, const WindowPlan& plan) {
    const Row n = plan.across();
    const std::size_t m = rules.cells;
    VectorXd w(plan.points());
    for (Row k = 0; k < w.size(); ++k) w(k) = static_cast<double>(k / n) - 1.5;
    for (std::size_t h = 0; h < 2; ++h) {
        const MatrixXd& half = rules.halves[h];
        const double middle = h == 0 ? -0.25 : 0.25;
        if (!(half.minCoeff() >= 0) || !((half.rowwise().sum().array() - 1).abs().maxCoeff() <= 4 * kAlike) ||
            !((half * w - w / 2 - VectorXd::Constant(w.size(), middle)).cwiseAbs().maxCoeff() <= 8 * kAlike) ||
            !is_alike(half, half, window_symmetry(m, 1, false, false)) ||
            !is_alike(half, half, window_symmetry(m, 0, true, false)) ||
            !is_alike(half, rules.halves[1 - h], window_symmetry(m, 0, false, true))) {
            return false;
        }
        // Data that are constant along the edge: sums over layers are the same for all layers of both halves. The rules of the
        // edge itself may differ: vectors of frequency 1 and 2 are 0 there.
        const auto sums = [&](const MatrixXd& of, Row k) {
            VectorXd sum = VectorXd::Zero(n);
            for (Row l = 0; l < 4; ++l) sum += of.row(k).segment(l * n, n).transpose();
            return sum;
        };
        for (Row k = 0; k < half.rows(); ++k) {
            if (k % n == 0) continue;
            if (!((sums(half, k) - sums(rules.halves[0], k % n)).cwiseAbs().maxCoeff() <= 4 * kAlike)) return false;
        }
    }
    for (const MatrixXd& ring : rules.ring) {
        if (!(ring.minCoeff() >= 0) || !((ring.rowwise().sum().array() - 1).abs().maxCoeff() <= 4 * kAlike)) return false;
    }
    return true;
}

// The vectors that refinement keeps but for factors and a translation: 1, χ and ψ.
MatrixXd kept_vectors(const EdgeMode& mode, const std::optional<EdgeMode>& slow) {
    const MatrixXd across = mode.values();
    MatrixXd kept(across.rows(), slow ? 6 : 4);
    for (Row k = 0; k < kept.rows(); ++k)
        kept.row(k).head(4) << 1, across.row(k), static_cast<double>(k / mode.layer.size()) - 1.5;
    if (slow) kept.rightCols(2) = slow->values();
    return kept;
}

// Vectors near the left eigenvectors of the mean of both halves. That of w is odd under an exchange of the ends without an
// error, so that its product with data that are constant along the edge is 0; the others are even.
MatrixXd left_vectors(const EdgeRules& rules, const MatrixXd& kept) {
    const MatrixXd mean = (rules.halves[0] + rules.halves[1]) / 2;
    const std::size_t m = rules.cells;
    const std::vector<std::size_t> exchanged = window_symmetry(m, 0, false, true);
    MatrixXd left = kept * (kept.transpose() * kept).inverse();
    constexpr int kPowers = 200;
    for (int power = 0; power <= kPowers; ++power) {
        const MatrixXd before = power == 0 ? left : MatrixXd(mean.transpose() * left);
        for (Row k = 0; k < left.rows(); ++k) {
            const Row other = row_of(exchanged[static_cast<std::size_t>(k)]);
            left.row(k) = (before.row(k) + before.row(other)) / 2;
            left(k, 3) = (before(k, 3) - before(other, 3)) / 2;
        }
        MatrixXd units = kept.transpose() * left;
        const double of_w = units(3, 3);
        units.row(3).setZero();
        units.col(3).setZero();
        units(3, 3) = of_w;
        left = (left * units.inverse()).eval();
    }
    for (Row k = 0; k < left.rows(); ++k) {
        const Row other = row_of(exchanged[static_cast<std::size_t>(k)]);
        if (other > k) left(other, 3) = -left(k, 3);
    }
    return left;
}

// How far these vectors are from their mean over all symmetries of the edge, which the theorem takes for L: row sums.
double asymmetry(const MatrixXd& left, const WindowPlan& plan, const VectorXd& weights) {
    const std::size_t m = plan.star().cells;
    const double turn = 2 * std::numbers::pi / static_cast<double>(m);
    const Row count = left.cols();
    const auto turned = [](double angle) {
        return (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
    };
    MatrixXd by_turn = MatrixXd::Identity(count, count), by_mirror = by_turn, by_exchange = by_turn;
    for (Row c = 1; c < count; c += 3) {  // χ and ψ, of frequency 1 and 2
        by_turn.block<2, 2>(c, c) = turned(static_cast<double>(c == 1 ? 1 : 2) * turn);
        by_mirror(c + 1, c + 1) = -1;
    }
    by_exchange(3, 3) = -1;
    double most = 0;
    const auto include = [&](const std::vector<std::size_t>& to, const MatrixXd& by) {
        VectorXd sums = VectorXd::Zero(count);
        for (Row k = 0; k < left.rows(); ++k) {
            const VectorXd expected = by * left.row(k).transpose();
            sums += (left.row(row_of(to[static_cast<std::size_t>(k)])).transpose() - expected).cwiseAbs() * weights(k);
        }
        most = std::max(most, sums.maxCoeff());
    };
    include(window_symmetry(m, 1, false, false), by_turn);
    include(window_symmetry(m, 0, true, false), by_mirror);
    include(window_symmetry(m, 0, false, true), by_exchange);
    // A symmetry is a product of at most m + 2 of these, each of which takes row sums to at most 1.5 times as much.
    return 2 * static_cast<double>(m + 2) * up(most);
}

/// The derivatives in the parts of the ring, as rows over the window: for each Bernstein coefficient of degree 3 the three rows
/// of H ∂. Those of rows 1 and 2 are divided by 1 − κ.
struct RingRows {
    Enclosure rows;
    double kappa = 0;
};

std::optional<RingRows> ring_rows(const EdgeRules& rules, const Enclosure& kept, const VectorXd& weights) {
    const double middle = std::numbers::pi / static_cast<double>(rules.cells);
    RingRows all;
    all.rows.near.resize(2 * 4 * 64 * 3, weights.size());
    Row filled = 0;
    for (const MatrixXd& ring : rules.ring) {
        RowsXd bezier = ring * weights.asDiagonal();
        const double size = norm(bezier);
        for (const Row axis : {0, 1, 2}) bezier = along_axis(bezier_of_spline(), bezier, axis);
        // Each sector's ring lies about the middle of the sector, so that χ goes round the edge once.
        const MatrixXd places = bezier * kept.near.middleCols(1, 2);
        const double least = (places * Eigen::Vector2d(std::cos(middle), std::sin(middle))).minCoeff();
        if (!(least > 1e-6)) return std::nullopt;
        std::array<RowsXd, 3> derivatives;
        for (Row axis = 0; axis < 3; ++axis) {
            derivatives[static_cast<std::size_t>(axis)] = along_axis(derivative_of_bezier(), bezier, axis);
        }
        for (int part = 0; part < 4; ++part) {
            std::array<RowsXd, 3> on_part;
            for (std::size_t c = 0; c < 3; ++c) {
                on_part[c] = along_axis(half_of_bezier(part / 2 != 0), derivatives[c], 0);
                on_part[c] = along_axis(half_of_bezier(part % 2 != 0), on_part[c], 1);
            }
            // Mean of the coefficients of the part: a place near its centre. Along the edge χ has the slope ½.
            Eigen::Matrix2d slope;
            for (Row a = 0; a < 2; ++a) {
                slope.row(a) = (on_part[static_cast<std::size_t>(a)].colwise().mean() * kept.near.middleCols(1, 2));
            }
            if (!(slope.determinant() > 0)) return std::nullopt;
            const Eigen::Matrix2d inverse = slope.inverse();
            constexpr double kInverseAlong = 2;
            MatrixXd rows(64 * 3, weights.size());
            for (Row k = 0; k < 64; ++k) {
                for (Row a = 0; a < 2; ++a) {
                    rows.row(3 * k + a) = inverse(a, 0) * on_part[0].row(k) + inverse(a, 1) * on_part[1].row(k);
                }
                rows.row(3 * k + 2) = kInverseAlong * on_part[2].row(k);
            }
            // Six steps of up to 64 products each, whose magnitudes are at most those of weights, differences and H.
            constexpr double kOfSteps = 0x1p-43, kOfDifferences = 6;
            const double off = kOfSteps * kOfDifferences * size * std::max(kInverseAlong, norm(inverse));
            const Enclosure of_map = times(Enclosure{rows, off}, kept);
            double kappa = 0;
            for (Row k = 0; k < 64; ++k) {
                Eigen::Matrix2d delta = of_map.near.block(3 * k, 1, 2, 2);
                delta -= Eigen::Matrix2d::Identity();
                kappa = std::max(kappa, delta.norm());
            }
            kappa = up(kappa + 2 * of_map.off);
            if (!(kappa < 1)) return std::nullopt;
            const double factor = up(1 / (1 - kappa));
            for (Row k = 0; k < 64; ++k) rows.middleRows(3 * k, 2) *= factor;
            all.rows.near.middleRows(filled, rows.rows()) = rows;
            all.rows.off = std::max(all.rows.off, up(off * factor + kUnitRoundoff * norm(rows)));
            all.kappa = std::max(all.kappa, kappa);
            filled += rows.rows();
        }
    }
    return all;
}

/// Rows 1 and 2 together, and row 3.
struct Sizes {
    double across = 0, along = 0;

    void include(const Sizes& other) {
        across = std::max(across, other.across);
        along = std::max(along, other.along);
    }
    [[nodiscard]] Sizes over(double by_across, double by_along) const { return {up(across / by_across), up(along / by_along)}; }
};

// The largest of triples of rows, which start at `first`.
Sizes sizes_of(const Enclosure& rows, Row first) {
    const VectorXd sums = rows.near.cwiseAbs().rowwise().sum();
    Sizes sizes;
    for (Row k = first; k < sums.size(); k += 3) sizes.include({std::hypot(sums(k), sums(k + 1)), sums(k + 2)});
    return {up(sizes.across + 2 * rows.off), up(sizes.along + rows.off)};
}

// Those of the rows of L: of χ₁ and χ₂, of w, and of ψ.
struct Drift {
    double across = 0, along = 0, slow = 0;

    void include(const Enclosure& rows) {
        const VectorXd sums = rows.near.cwiseAbs().rowwise().sum();
        const auto pair = [&](Row k) { return up(std::hypot(sums(k), sums(k + 1)) + 2 * rows.off); };
        across = std::max(across, pair(1));
        along = std::max(along, up(sums(3) + rows.off));
        if (sums.size() > 4) slow = std::max(slow, pair(4));
    }
    [[nodiscard]] Drift over(double by_across, double by_along) const {
        return {up(across / by_across), up(along / by_along), up(slow / by_across)};
    }
};

// |H ∂ψ| / (1 − κ) on the ring, whose coefficients have these rows.
double slow_size(const Enclosure& rows, const Enclosure& slow) {
    const Enclosure slopes = times(rows, slow);
    double size = 0;
    for (Row k = 0; k < slopes.near.rows(); k += 3) size = std::max(size, spectral_norm(slopes.near.block<2, 2>(k, 0)));
    return up(size + 2 * slopes.off);
}

}  // namespace

EdgeKind make_edge_kind(const EdgeRules& rules) {
    EdgeKind kind;
    kind.cells = rules.cells;
    const WindowPlan plan(rules.cells);
    if (rules.cells < 3 || !is_as_expected(rules, plan)) return kind;
    const auto map = edge_mode(rules, plan, 1);
    const auto slow = rules.cells > 4 ? edge_mode(rules, plan, 2) : std::nullopt;
    if (!map || (rules.cells > 4 && !slow)) return kind;
    kind.rate = map->rate;
    kind.slow_rate = slow ? slow->rate : 0;
    const Row count = plan.points();
    const double turn = 2 * std::numbers::pi / static_cast<double>(rules.cells);
    VectorXd weights(count);
    plan.each([&](Row p, std::size_t, int i, int j) {
        const double square = i * i + j * j + 2 * i * j * std::cos(turn);
        for (Row l = 0; l < 4; ++l) {
            const double w = static_cast<double>(l) - 1.5;
            weights(l * plan.across() + p) = std::max(1.0, square + w * w);
        }
    });
    const VectorXd inverse_weights = weights.cwiseInverse();
    const MatrixXd unscaled = kept_vectors(*map, slow);
    const MatrixXd left = left_vectors(rules, unscaled);

    constexpr double kOfScaling = 4 * kUnitRoundoff;
    Enclosure kept{inverse_weights.asDiagonal() * unscaled, 0};
    kept.off = up(2 * map->error + 2 * (slow ? slow->error : 0) + kOfScaling * norm(kept.near));
    Enclosure lefts{left.transpose() * weights.asDiagonal(), 0};
    lefts.off = up(kOfScaling * norm(lefts.near) + asymmetry(left, plan, weights));
    const double not_unit = minus(times(lefts, kept), {MatrixXd::Identity(kept.near.cols(), kept.near.cols()), 0}).most();
    lefts.off = up(lefts.off + 1.01 * not_unit * lefts.most());  // what makes Lᵀ(1, χ, ψ) = 1
    if (!(lefts.off < kOfLefts)) return kind;
    const Enclosure projection = minus({MatrixXd::Identity(count, count), 0}, times(kept, lefts));
    kind.spread = std::max(projection.most(), lefts.most());
    std::array<Enclosure, 2> steps, rests, drifts;
    for (std::size_t h = 0; h < 2; ++h) {
        steps[h].near = inverse_weights.asDiagonal() * rules.halves[h] * weights.asDiagonal();
        steps[h].off = up((kOfWeights + kOfScaling) * norm(steps[h].near));
        const Enclosure after = times(steps[h], projection);
        rests[h] = times(projection, after);
        drifts[h] = times(lefts, after);
    }
    const auto ring = ring_rows(rules, kept, weights);
    if (!ring) return kind;
    kind.kappa = ring->kappa;
    if (slow) kind.slow_size = slow_size(ring->rows, {kept.near.rightCols(2), kept.off});

    constexpr std::size_t kManyWords = 5, kMostWords = 6;
    constexpr double kFalls = 0.5, kFallsAtMany = 0.75, kFallsAtMost = 0.97;
    const double rate = map->rate - map->error;
    const double slower = slow ? up((slow->rate + slow->error) / rate) : 0;  // μ/λ
    std::vector<Enclosure> rows{times(ring->rows, projection)};
    std::vector<Enclosure> products{{MatrixXd::Identity(count, count), 0}};
    Sizes largest_ring, before, all;
    double fed = 0, most_fed = 0;              // what q' adds to C until a level, of the size of λʲ
    double power_across = 1, power_along = 1;  // λʲ and 2^−j, as lower bounds
    double falls = 1;
    std::size_t words = 0;
    while (true) {
        Sizes of_ring;
        Drift of_drift;
        for (const Enclosure& at : rows) of_ring.include(sizes_of(at, 0));
        for (const Enclosure& product : products) {
            for (const Enclosure& drift : drifts) of_drift.include(words == 0 ? drift : times(drift, product));
        }
        of_ring = of_ring.over(power_across, power_along);
        of_drift = of_drift.over(power_across * rate * (1 - kOfScaling), power_along / 2);
        kind.levels.push_back({of_ring.across, of_ring.along, of_drift.across, of_drift.along, of_drift.slow});
        all.include({up(of_ring.across + before.across + kind.slow_size * fed), up(of_ring.along + before.along)});
        before = {up(before.across + of_drift.across), up(before.along + of_drift.along)};
        largest_ring.include(of_ring);
        fed = up(fed * slower + of_drift.slow);
        most_fed = std::max(most_fed, fed);

        ++words;
        power_across *= rate * (1 - kOfScaling);
        power_along /= 2;
        std::vector<Enclosure> longer;
        for (const Enclosure& product : products) {
            for (const Enclosure& rest : rests) longer.push_back(words == 1 ? rest : times(product, rest));
        }
        products = std::move(longer);
        double most = 0;
        for (const Enclosure& product : products) most = std::max(most, product.most());
        kind.falls_across = up(most / power_across);
        kind.falls_along = up(most / power_along);
        falls = std::max(kind.falls_across, kind.falls_along);
        if (falls <= kFalls || (words == kManyWords && falls <= kFallsAtMany)) break;
        if (words == kMostWords) {
            if (!(falls <= kFallsAtMost)) return kind;
            break;
        }
        longer.clear();
        for (const Enclosure& at : rows) {
            for (const Enclosure& rest : rests) longer.push_back(times(at, rest));
        }
        rows = std::move(longer);
    }
    kind.words = words;
    // Beyond these words: the ring is at most ω times the largest before, the drifts are a geometric series, and what is fed is
    // at most what was fed in these and ω times the largest.
    most_fed = std::max(most_fed, up(fed / (1 - kind.falls_across)));
    const double beyond_across = kind.falls_across * largest_ring.across + before.across / (1 - kind.falls_across);
    const double beyond_along = kind.falls_along * largest_ring.along + before.along / (1 - kind.falls_along);
    kind.across = up(up(std::max(all.across, beyond_across + kind.slow_size * most_fed)));
    kind.along = up(up(std::max(all.along, beyond_along)));
    for (Row k = 0; k < count; ++k) {
        kind.characteristic.push_back({unscaled(k, 1), unscaled(k, 2), unscaled(k, 3)});
        kind.left.push_back({left(k, 0), left(k, 1), left(k, 2), left(k, 3)});
        kind.weights.push_back(weights(k));
        kind.slow.push_back(slow ? std::array{unscaled(k, 4), unscaled(k, 5)} : std::array{0.0, 0.0});
        kind.slow_left.push_back(slow ? std::array{left(k, 4), left(k, 5)} : std::array{0.0, 0.0});
    }
    return kind;
}

const EdgeKind& edge_kind(Scheme scheme, std::size_t cells) {
    static Kept<std::pair<Scheme, std::size_t>, EdgeKind> kept;
    return kept.get({scheme, cells}, [&] {
        // Other tasks would wait for this one's lock.
        return tbb::this_task_arena::isolate([&] {
            constexpr std::size_t kMostCells = 8;
            if (cells > kMostCells) return EdgeKind{};
            return make_edge_kind(edge_rules(scheme, cells));
        });
    });
}

}  // namespace subvol::detail
