// SPDX-License-Identifier: Apache-2.0
// The constants of an edge segment. Symbols as in the header.
//
// Coordinates are scaled: a vector of the window has its entries divided by d, a row is multiplied by d, so that all norms are
// largest row sums. All matrices are enclosures (enclosure.h); what is not exact in them is
//
//     T      weights, rounded (kOfWeights)
//     χ, λ   an eigenvector of frequency 1 among the sectors: five numbers and λ, enclosed by Newton's method
//     L      any vectors near the left eigenvectors, and a correction that makes Lᵀ(1, χ) = 1
//     Π, T̄   products of these
//
// The rules are those of an edge that all sectors share alike: turning the star, its mirror images and exchanging the ends of
// the segment leave them as they are. So sector 0 and the lower half stand for all, and of its three cells two.
#include "edge_kind.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

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

/// The points of a window.
class WindowPlan {
public:
    explicit WindowPlan(std::size_t cells) : star_{cells, EdgeWindow::kReach} {}

    [[nodiscard]] const Star& star() const { return star_; }
    [[nodiscard]] Row across() const { return row_of(star_.points()); }
    [[nodiscard]] Row points() const { return row_of(EdgeWindow::kLayers) * across(); }

    // Calls visit(point of the star, s, i, j) for each sector's points; those of spokes more than once.
    template <class Visit>
    void each(const Visit& visit) const {
        for (std::size_t s = 0; s < star_.cells; ++s) {
            for (int i = 0; i <= static_cast<int>(star_.reach); ++i) {
                for (int j = 0; j <= static_cast<int>(star_.reach); ++j) visit(row_of(star_.number(s, i, j)), s, i, j);
            }
        }
    }

private:
    Star star_;
};

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
bool is_as_expected(const EdgeRules& rules, const WindowPlan& plan, bool extrudes) {
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
        // Data that are constant along the edge: sums over layers are the same for all layers of both halves. Where the rules
        // of the edge itself differ, this holds for vectors of frequency 1 after all, which are 0 at the edge.
        const auto sums = [&](const MatrixXd& of, Row k) {
            VectorXd sum = VectorXd::Zero(n);
            for (Row l = 0; l < 4; ++l) sum += of.row(k).segment(l * n, n).transpose();
            return sum;
        };
        for (Row k = 0; k < half.rows(); ++k) {
            if (!extrudes && k % n == 0) continue;
            if (!((sums(half, k) - sums(rules.halves[0], k % n)).cwiseAbs().maxCoeff() <= 4 * kAlike)) return false;
        }
    }
    for (const MatrixXd& ring : rules.ring) {
        if (!(ring.minCoeff() >= 0) || !((ring.rowwise().sum().array() - 1).abs().maxCoeff() <= 4 * kAlike)) return false;
    }
    return true;
}

/// χ₁ and χ₂ as the real and imaginary parts of a vector of frequency 1: with ω a turn by a sector, points (s, i, 0) have ω^s
/// times a real number, points (s, i, i) ω^(s + 1/2) times one, (s, 2, 1) and (s, 1, 2) have ω^s c and ω^(s + 1) c̄.
class Frequency {
public:
    static constexpr Row kUnknowns = 6;  // of (1, 0), (2, 0), (1, 1), (2, 2), and the parts of c
    using Numbers = Eigen::Matrix<double, kUnknowns, 1>;

    explicit Frequency(const WindowPlan& plan)
        : plan_(plan), turn_(2 * std::numbers::pi / static_cast<double>(plan.star().cells)) {}

    // The vector with these numbers on a layer.
    [[nodiscard]] Eigen::VectorXcd spread(const Numbers& x) const {
        Eigen::VectorXcd z = Eigen::VectorXcd::Zero(plan_.across());
        plan_.each([&](Row p, std::size_t s, int i, int j) {
            const auto at = static_cast<double>(s);
            if (i > 0 && j == 0) z(p) = x(i - 1) * turned(at);
            if (i > 0 && j == i) z(p) = x(1 + i) * turned(at + 0.5);
            if (i == 2 && j == 1) z(p) = std::complex(x(4), x(5)) * turned(at);
            if (i == 1 && j == 2) z(p) = std::complex(x(4), -x(5)) * turned(at + 1);
        });
        return z;
    }

    // The numbers of the real part of such a vector.
    [[nodiscard]] Numbers read(const VectorXd& x) const {
        const auto at = [&](std::size_t s, int i, int j) { return x(row_of(plan_.star().number(s, i, j))); };
        const double c = at(0, 2, 1);
        Numbers numbers;
        numbers << at(0, 1, 0), at(0, 2, 0), at(0, 1, 1) / std::cos(turn_ / 2), at(0, 2, 2) / std::cos(turn_ / 2), c,
            (c * std::cos(turn_) - at(1, 2, 1)) / std::sin(turn_);
        return numbers;
    }

private:
    [[nodiscard]] std::complex<double> turned(double sectors) const { return std::polar(1.0, sectors * turn_); }

    const WindowPlan& plan_;
    double turn_;
};

/// λ and χ, each within `error`.
struct Characteristic {
    double rate = 0, error = 0;
    MatrixXd values;  ///< for each point of the window
};

// The eigenvector of the rules of a layer on vectors of frequency 1, with 1 at (1, 0). For y near it and X near the inverse of
// F' at y, F the equations and |F''| ≤ 2, a solution is within r of y if |X F(y)| + |1 − X F'(y)| r + |X| r² ≤ r.
std::optional<Characteristic> characteristic(const EdgeRules& rules, const WindowPlan& plan) {
    const Frequency frequency(plan);
    const Row n = plan.across();
    MatrixXd layer = MatrixXd::Zero(n, n);
    for (Row l = 0; l < 4; ++l) layer += rules.halves[0].block(n, l * n, n, n);
    Eigen::Matrix<double, 6, 6> step;
    for (Row k = 0; k < 6; ++k) step.col(k) = frequency.read(layer * frequency.spread(Frequency::Numbers::Unit(k)).real());
    constexpr double kOfSteps = 0x1p-45;  // row sums of `step`: some 27 products in a row, and what `read` divides by
    Frequency::Numbers x = frequency.read(frequency.spread((Frequency::Numbers() << 1, 2, 1, 2, 2, 1).finished()).real());
    constexpr int kPowers = 100, kCorrections = 4;
    for (int k = 0; k < kPowers; ++k) {
        x = step * x;
        x /= x(0);
    }
    double rate = (step * x)(0);
    using Square = Eigen::Matrix<double, 6, 6>;
    const auto slope = [&] {
        Square f = step - rate * Square::Identity();
        f.col(0) = -x;  // the unknown in place of the first number is λ
        return f;
    };
    for (int k = 0; k < kCorrections; ++k) {
        const Frequency::Numbers change = slope().fullPivLu().solve(Frequency::Numbers(rate * x - step * x));
        rate += change(0);
        x.tail<5>() += change.tail<5>();
    }
    const auto most = [](const auto& matrix) { return matrix.cwiseAbs().rowwise().sum().maxCoeff(); };
    const Square f = slope(), inverse = f.fullPivLu().inverse();
    const double size = most(inverse), largest = x.cwiseAbs().maxCoeff();
    const double residual = size * (most(Frequency::Numbers(step * x - rate * x)) + 2 * kOfSteps * largest);
    const double slack = most(Square(Square::Identity() - inverse * f)) + 2 * size * kOfSteps;
    const double radius = 2 * residual;
    if (!(residual + slack * radius + size * radius * radius <= 0.99 * radius) || !(radius < 1e-10) || !(rate < 0.7)) {
        return std::nullopt;
    }
    const Eigen::VectorXcd z = frequency.spread(x);
    Characteristic found{rate, 2 * radius + 0x1p-48 * largest, MatrixXd(plan.points(), 3)};
    for (Row l = 0; l < 4; ++l) {
        found.values.block(l * n, 0, n, 1) = z.real();
        found.values.block(l * n, 1, n, 1) = z.imag();
        found.values.block(l * n, 2, n, 1).setConstant(static_cast<double>(l) - 1.5);
    }
    return found;
}

MatrixXd with_ones(const MatrixXd& characteristic) {
    MatrixXd kept(characteristic.rows(), 4);
    kept << VectorXd::Ones(characteristic.rows()), characteristic;
    return kept;
}

// Vectors near the left eigenvectors of the mean of both halves. The first three are even under an exchange of the ends, the
// last is odd without an error: so its product with data that are constant along the edge is 0.
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
            for (Row c = 0; c < 4; ++c) left(k, c) = (before(k, c) + (c == 3 ? -1 : 1) * before(other, c)) / 2;
        }
        const MatrixXd units = kept.transpose() * left;
        left.leftCols(3) = (left.leftCols(3) * units.topLeftCorner(3, 3).inverse()).eval();
        left.col(3) /= units(3, 3);
    }
    for (Row k = 0; k < left.rows(); ++k) {
        const Row other = row_of(exchanged[static_cast<std::size_t>(k)]);
        if (other <= k) continue;
        left(other, 3) = -left(k, 3);
    }
    return left;
}

// How far these vectors are from their mean over all symmetries of the edge, which the theorem takes for L: row sums.
double asymmetry(const MatrixXd& left, const WindowPlan& plan, const VectorXd& weights) {
    const std::size_t m = plan.star().cells;
    const double turn = 2 * std::numbers::pi / static_cast<double>(m);
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
    turned.topLeftCorner(2, 2) << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
    double most = 0;
    const auto include = [&](const std::vector<std::size_t>& to, const Eigen::Matrix3d& by) {
        Eigen::Matrix4d all = Eigen::Matrix4d::Identity();
        all.bottomRightCorner(3, 3) = by;
        Eigen::Vector4d sums = Eigen::Vector4d::Zero();
        for (Row k = 0; k < left.rows(); ++k) {
            const Eigen::Vector4d expected = all * left.row(k).transpose();
            sums += (left.row(row_of(to[static_cast<std::size_t>(k)])).transpose() - expected).cwiseAbs() * weights(k);
        }
        most = std::max(most, sums.maxCoeff());
    };
    include(window_symmetry(m, 1, false, false), turned);
    include(window_symmetry(m, 0, true, false), Eigen::Vector3d(1, -1, 1).asDiagonal());
    include(window_symmetry(m, 0, false, true), Eigen::Vector3d(1, 1, -1).asDiagonal());
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

// Differences of neighbouring layers, with the weight d + d' of their points: a row whose product with data that are constant
// along the edge is 0 is one of differences, at most as large.
class LayerDifferences {
public:
    LayerDifferences(const WindowPlan& plan, const VectorXd& weights)
        : across_(plan.across()), points_(weights), pairs_(weights.head(3 * across_) + weights.tail(3 * across_)) {}

    // A row of the window as one of differences, the sum of its magnitudes.
    template <class RowOfWindow>
    [[nodiscard]] double size(const RowOfWindow& row) const {
        double sum = 0;
        for (Row p = 0; p < across_; ++p) {
            double total = 0;
            for (Row l = 0; l < 3; ++l) {
                total += row(l * across_ + p) / points_(l * across_ + p);
                sum += std::abs(total) * pairs_(l * across_ + p);
            }
        }
        return sum;
    }

    // The largest of the rows 3 k + 2 of such rows.
    [[nodiscard]] double along(const Enclosure& rows, Row first) const {
        double most = 0;
        for (Row k = first + 2; k < rows.near.rows(); k += 3) most = std::max(most, size(rows.near.row(k)));
        return up(most + kOfOff * rows.off);
    }

    // The norm of a product as it takes differences to differences.
    [[nodiscard]] double norm_of(const Enclosure& product) const {
        double most = 0;
        for (Row k = 0; k < 3 * across_; ++k) {
            const Eigen::RowVectorXd row =
                product.near.row(k + across_) * points_(k + across_) - product.near.row(k) * points_(k);
            most = std::max(most, size(row) / pairs_(k));
        }
        return up(most + kOfOff * product.off);
    }

private:
    // Sums of up to three entries, with weights of pairs that are at most 2.25 + 1 or so times those of the entry.
    static constexpr double kOfOff = 32;

    Row across_;
    VectorXd points_, pairs_;
};

}  // namespace

EdgeKind make_edge_kind(const EdgeRules& rules, bool extrudes) {
    EdgeKind kind;
    kind.cells = rules.cells;
    const WindowPlan plan(rules.cells);
    if (rules.cells < 3 || !is_as_expected(rules, plan, extrudes)) return kind;
    const auto map = characteristic(rules, plan);
    if (!map) return kind;
    kind.rate = map->rate;
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
    const MatrixXd unscaled = with_ones(map->values);
    const MatrixXd left = left_vectors(rules, unscaled);

    constexpr double kOfScaling = 4 * kUnitRoundoff;
    Enclosure kept{inverse_weights.asDiagonal() * unscaled, 0};
    kept.off = up(2 * map->error + kOfScaling * norm(kept.near));
    Enclosure lefts{left.transpose() * weights.asDiagonal(), 0};
    lefts.off = up(kOfScaling * norm(lefts.near) + asymmetry(left, plan, weights));
    const double not_unit = minus(times(lefts, kept), {MatrixXd::Identity(4, 4), 0}).most();
    lefts.off = up(lefts.off + 1.01 * not_unit * lefts.most());  // what makes Lᵀ(1, χ) = 1
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

    constexpr std::size_t kManyWords = 5, kMostWords = 6;
    constexpr double kFalls = 0.5, kFallsAtMany = 0.75, kFallsAtMost = 0.97;
    const double rate = map->rate - map->error;
    const LayerDifferences differences(plan, weights);
    std::vector<Enclosure> rows{times(ring->rows, projection)};
    std::vector<Enclosure> products{{MatrixXd::Identity(count, count), 0}};
    double falls_across = 1, falls_along = 1;
    Sizes largest_ring, before, all, pairs_of_ring, pairs_of_drift;
    double power_across = 1, power_along = 1;  // λʲ and 2^−j, as lower bounds
    std::size_t words = 0;
    while (true) {
        Sizes of_ring, of_drift, pairs_ring, pairs_drift;
        for (const Enclosure& at : rows) {
            of_ring.include(sizes_of(at, 0));
            if (extrudes) pairs_ring.include({0, differences.along(at, 0)});
        }
        for (const Enclosure& product : products) {
            for (const Enclosure& drift : drifts) {
                const Enclosure at = words == 0 ? drift : times(drift, product);
                of_drift.include(sizes_of(at, 1));
                if (extrudes) pairs_drift.include({0, differences.along(at, 1)});
            }
        }
        of_ring = of_ring.over(power_across, power_along);
        of_drift = of_drift.over(power_across * rate * (1 - kOfScaling), power_along / 2);
        kind.levels.push_back({of_ring.across, of_ring.along, of_drift.across, of_drift.along});
        all.include({up(of_ring.across + before.across), up(of_ring.along + before.along)});
        before = {up(before.across + of_drift.across), up(before.along + of_drift.along)};
        largest_ring.include(of_ring);
        pairs_of_ring.include({0, up(pairs_ring.along / power_along)});
        pairs_of_drift.along = up(pairs_of_drift.along + pairs_drift.along / (power_along / 2));

        ++words;
        power_across *= rate * (1 - kOfScaling);
        power_along /= 2;
        std::vector<Enclosure> longer;
        for (const Enclosure& product : products) {
            for (const Enclosure& rest : rests) longer.push_back(words == 1 ? rest : times(product, rest));
        }
        products = std::move(longer);
        double most = 0, most_pairs = 0;
        for (const Enclosure& product : products) {
            most = std::max(most, product.most());
            if (extrudes) most_pairs = std::max(most_pairs, differences.norm_of(product));
        }
        falls_across = up(most / power_across);
        falls_along = up((extrudes ? most_pairs : most) / power_along);
        const double falls = std::max(falls_across, falls_along);
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
    kind.falls_across = falls_across;
    kind.falls_along = falls_along;
    // Beyond these words: the ring is at most ω times the largest before, and the drifts are a geometric series.
    if (!extrudes) {
        pairs_of_ring.along = largest_ring.along;
        pairs_of_drift.along = before.along;
    }
    const double drift_across = before.across / (1 - falls_across);
    const double drift_along = before.along + pairs_of_drift.along * falls_along / (1 - falls_along);
    kind.across = up(up(std::max(all.across, falls_across * largest_ring.across + drift_across)));
    kind.along = up(up(std::max(all.along, falls_along * pairs_of_ring.along + drift_along)));
    for (Row k = 0; k < count; ++k) {
        kind.characteristic.push_back({map->values(k, 0), map->values(k, 1), map->values(k, 2)});
        kind.left.push_back({left(k, 0), left(k, 1), left(k, 2), left(k, 3)});
        kind.weights.push_back(weights(k));
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
            return make_edge_kind(edge_rules(scheme, cells), scheme == Scheme::Bsxw);
        });
    });
}

// Any A and ρ with P = 1 c + χ A + ρ would do but for the drift; those that are computed are near the true ones.
namespace {

/// The fit of χ to the values of a window: row c of A is a[c].
struct Fit {
    Vec3 center{0.0}, size{0.0};
    Mat3 a{0.0};

    Fit(const EdgeKind& kind, std::span<const Vec3> values) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            const Vec3 x = values[k] - values[0];
            const auto& left = kind.left[k];
            center += x * left[0];
            for (int c = 0; c < 3; ++c) a[c] += x * left[static_cast<std::size_t>(c) + 1];
            size = glm::max(size, glm::abs(x));
        }
    }
    [[nodiscard]] Vec3 rest(const EdgeKind& kind, std::span<const Vec3> values, std::size_t k) const {
        const auto& map = kind.characteristic[k];
        return values[k] - values[0] - center - a[0] * map[0] - a[1] * map[1] - a[2] * map[2];
    }
};

double frobenius(const Mat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

}  // namespace

bool proves_segment(const EdgeKind& kind, std::span<const Vec3> points, std::span<const Vec3> motion, double error) {
    if (!kind.is_bounded() || points.size() != kind.weights.size()) return false;
    const Fit fit(kind, points), moved(kind, motion);
    const Mat3& a = fit.a;
    const double det = glm::determinant(a);
    if (!(det > 1e-12 * glm::length(a[0]) * glm::length(a[1]) * glm::length(a[2]))) return false;
    const Mat3 inverse = glm::inverse(a);  // q = inverse · ρ, with A transposed
    double height = 0, residual = 0;
    const Mat3 unit = inverse * a - Mat3(1.0);
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
            height += std::abs(inverse[c][r]);
            residual += std::abs(unit[c][r]);
        }
    }
    constexpr double kOfRests = 1e-8;  // of L, χ and of sums of some hundred products
    const Vec3 size = fit.size + moved.size;
    const Mat3 turning = inverse * moved.a;  // N, transposed
    const double turned = motion.empty() ? 0 : frobenius(turning) + kOfRests * height * (size.x + size.y + size.z);
    if (!(turned < 0.9)) return false;
    const double factor = turned / (1 - turned);  // of (1 + s N)⁻¹ − 1
    const double slack = kind.spread * (2 * error + kOfRests * std::max({size.x, size.y, size.z})) * height * (1 + factor);
    if (!(residual < 1e-6) || !(slack < 1e-2)) return false;
    double across = 0, along = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3 q = inverse * fit.rest(kind, points, k);
        const Vec3 r = motion.empty() ? Vec3(0.0) : inverse * moved.rest(kind, motion, k) - turning * q;
        const double more = factor * glm::length(r);
        across = std::max(across, (std::hypot(q.x, q.y) + std::hypot(r.x, r.y) + more) / kind.weights[k]);
        along = std::max(along, (std::abs(q.z) + std::abs(r.z) + more) / kind.weights[k]);
    }
    const auto with_error = [&](double q) { return (q + 2 * slack * (1 + across + along)) * (1 + 1e-5); };
    return kind.across * with_error(across) + kind.along * with_error(along) < 1;
}

}  // namespace subvol::detail
