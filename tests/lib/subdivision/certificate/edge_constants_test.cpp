// SPDX-License-Identifier: Apache-2.0
// The constants of segments of irregular edges are proved again, by other code: in intervals, from the definitions of the
// schemes.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "edge_kind.h"
#include "lib/subdivision/certificate/star_mesh.h"

namespace subvol::detail {
namespace edge_kind_test {

/// A number that is known to lie between two doubles.
struct Interval {
    double low = 0, high = 0;

    Interval() = default;
    Interval(double x) : low(x), high(x) {}
    Interval(double a, double b) : low(a), high(b) {}

    [[nodiscard]] double most() const { return std::max(std::abs(low), std::abs(high)); }
};

Interval outward(double low, double high) {
    constexpr double kStep = 0x1p-52, kTiny = 1e-300;
    return {low - std::abs(low) * kStep - kTiny, high + std::abs(high) * kStep + kTiny};
}

Interval operator+(const Interval& a, const Interval& b) {
    return outward(a.low + b.low, a.high + b.high);
}

Interval operator-(const Interval& a, const Interval& b) {
    return outward(a.low - b.high, a.high - b.low);
}

Interval operator*(const Interval& a, const Interval& b) {
    const double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    return outward(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
}

Interval operator/(const Interval& a, double b) {
    return a * Interval(outward(1 / b, 1 / b));
}

using Row = std::vector<Interval>;
using Rows = std::vector<Row>;

Rows product(const Rows& a, const Rows& b) {
    Rows result(a.size(), Row(b[0].size()));
    tbb::parallel_for(std::size_t{0}, a.size(), [&](std::size_t k) {
        for (std::size_t i = 0; i < b.size(); ++i) {
            if (a[k][i].most() == 0) continue;
            for (std::size_t n = 0; n < b[i].size(); ++n) result[k][n] = result[k][n] + a[k][i] * b[i][n];
        }
    });
    return result;
}

// The constants anew: in true intervals, from the rules of the definition, with derivatives by blossoms of the spline rather
// than by Bézier points, all in unscaled coordinates. Of the library it has χ, which satisfies T χ = χ Λ to rounding, the
// approximate L, and the number of words.
class Prover {
public:
    Prover(Scheme scheme, const EdgeKind& kind) : kind_(kind), rules_(defined_rules(scheme, kind.cells)) {
        const std::size_t n = kind.weights.size();
        constexpr double kOfMap = 1e-10;
        for (std::size_t k = 0; k < n; ++k) {
            const auto& x = kind.characteristic[k];
            const auto near = [&](double y) { return outward(y - kOfMap, y + kOfMap); };
            kept_.push_back({1.0, near(x[0]), near(x[1]), x[2]});
            if (has_slow()) kept_.back().insert(kept_.back().end(), {near(kind.slow[k][0]), near(kind.slow[k][1])});
        }
        // L = L̃ (1 + η)⁻¹
        const std::size_t count = kept_[0].size();
        Rows lefts(count, Row(n));
        for (std::size_t k = 0; k < n; ++k) {
            for (std::size_t c = 0; c < count; ++c) lefts[c][k] = c < 4 ? kind.left[k][c] : kind.slow_left[k][c - 4];
        }
        Rows units = product(lefts, kept_);
        double eta = 0;
        for (std::size_t c = 0; c < count; ++c) {
            units[c][c] = units[c][c] - 1.0;
            for (const Interval& x : units[c]) eta = std::max(eta, x.most());
        }
        Row largest(n);
        for (std::size_t k = 0; k < n; ++k) {
            for (std::size_t c = 0; c < count; ++c) largest[k].high += lefts[c][k].most();
        }
        for (std::size_t c = 0; c < count; ++c) {
            for (std::size_t k = 0; k < n; ++k) {
                const double off = 10 * eta * largest[k].high;
                lefts[c][k] = lefts[c][k] + Interval(-off, off);
            }
        }
        Rows projection = product(kept_, lefts);
        for (std::size_t k = 0; k < n; ++k) {
            for (std::size_t i = 0; i < n; ++i) projection[k][i] = Interval(k == i ? 1.0 : 0.0) - projection[k][i];
        }
        projection_ = projection;
        for (const MatrixXd& half : rules_.halves) {
            const Rows after = product(rows_of(half), projection);
            rests_.push_back(product(projection, after));
            drifts_.push_back(product(lefts, after));
        }
    }

    // |T χ − χ Λ| and |T ψ − μ ψ|
    [[nodiscard]] double residual() const {
        double most = 0;
        for (std::size_t h = 0; h < 2; ++h) {
            for (std::size_t c = 0; c < 5; ++c) {
                Eigen::VectorXd x(static_cast<Eigen::Index>(kind_.weights.size()));
                for (Eigen::Index k = 0; k < x.size(); ++k) {
                    const auto p = static_cast<std::size_t>(k);
                    x(k) = c < 3 ? kind_.characteristic[p][c] : kind_.slow[p][c - 3];
                }
                const Eigen::VectorXd to = rules_.halves[h] * x - (c == 2 ? 0.5 : c < 2 ? kind_.rate : kind_.slow_rate) * x;
                most = std::max(most, (to.array() - (c == 2 ? h == 0 ? -0.25 : 0.25 : 0)).abs().maxCoeff());
            }
        }
        return most;
    }

    struct Found {
        double ring_across = 0, ring_along = 0, drift_across = 0, drift_along = 0, drift_slow = 0, falls = 0;
    };

    // |H ∂ψ| / (1 − κ): the largest of the coefficients, by the root of the larger eigenvalue of MᵀM.
    [[nodiscard]] double slow_size() const {
        if (!has_slow()) return 0;
        const Rows slopes = product(ring_rows(), kept_);
        double most = 0;
        for (std::size_t k = 0; k < slopes.size(); k += 3) {
            const double a = slopes[k][4].most(), b = slopes[k][5].most(), c = slopes[k + 1][4].most(),
                         d = slopes[k + 1][5].most();
            const double sign = slopes[k][4].low * slopes[k][5].low + slopes[k + 1][4].low * slopes[k + 1][5].low;
            const double p = a * a + c * c, q = b * b + d * d;
            most = std::max(most, std::sqrt((p + q) / 2 + std::hypot((p - q) / 2, sign)));
        }
        return most;
    }

    // For words of a length: the ring and the drift, and the norm of products that are one letter longer.
    [[nodiscard]] std::vector<Found> run(std::size_t words) const {
        std::vector<Found> found;
        Rows ring = ring_rows();
        std::vector<Rows> rows{product(ring, projection_)}, products;
        for (std::size_t j = 0; j < words; ++j) {
            Found at;
            const double across = std::pow(kind_.rate, static_cast<double>(j)), along = std::pow(0.5, static_cast<double>(j));
            for (const Rows& some : rows) {
                for (std::size_t k = 0; k < some.size(); k += 3) {
                    at.ring_across = std::max(at.ring_across, std::hypot(size(some[k]), size(some[k + 1])) / across);
                    at.ring_along = std::max(at.ring_along, size(some[k + 2]) / along);
                }
            }
            for (const Rows& drift : drifts_) {
                if (j == 0) include_drift(drift, at, across * kind_.rate, along / 2);
                for (const Rows& by : products) include_drift(product(drift, by), at, across * kind_.rate, along / 2);
            }
            std::vector<Rows> longer;
            if (j == 0) {
                longer = rests_;
            } else {
                for (const Rows& by : products) {
                    for (const Rows& rest : rests_) longer.push_back(product(by, rest));
                }
            }
            products = std::move(longer);
            for (const Rows& by : products) {
                for (std::size_t k = 0; k < by.size(); ++k) {
                    at.falls = std::max(at.falls, size(by[k]) / kind_.weights[k] / (across * kind_.rate));
                }
            }
            found.push_back(at);
            if (j + 1 == words) break;
            longer.clear();
            for (const Rows& some : rows) {
                for (const Rows& rest : rests_) longer.push_back(product(some, rest));
            }
            rows = std::move(longer);
        }
        return found;
    }

private:
    [[nodiscard]] static Rows rows_of(const MatrixXd& matrix) {
        Rows rows(static_cast<std::size_t>(matrix.rows()), Row(static_cast<std::size_t>(matrix.cols())));
        for (std::size_t k = 0; k < rows.size(); ++k) {
            for (std::size_t i = 0; i < rows[k].size(); ++i) {
                const double weight = matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
                if (weight != 0) rows[k][i] = {weight * (1 - 1e-14), weight * (1 + 1e-14)};
            }
        }
        return rows;
    }

    [[nodiscard]] double size(const Row& row) const {
        double sum = 0;
        for (std::size_t k = 0; k < row.size(); ++k) sum += row[k].most() * kind_.weights[k];
        return sum;
    }

    [[nodiscard]] bool has_slow() const { return kind_.cells > 4; }

    void include_drift(const Rows& rows, Found& at, double by_across, double by_along) const {
        at.drift_across = std::max(at.drift_across, std::hypot(size(rows[1]), size(rows[2])) / by_across);
        at.drift_along = std::max(at.drift_along, size(rows[3]) / by_along);
        if (has_slow()) at.drift_slow = std::max(at.drift_slow, std::hypot(size(rows[4]), size(rows[5])) / by_across);
    }

    // Weights of four uniform knots' control values in the blossom of the spline's piece on [0, 1]: three arguments, or in
    // place of the last one the direction (derivative / 3).
    [[nodiscard]] static std::array<Interval, 4> blossom(std::array<double, 3> t, bool derivative) {
        // Control value i has the knots i − 2, i − 1, i.
        std::array<std::array<Interval, 4>, 4> values{};
        for (std::size_t i = 0; i < 4; ++i) values[i][i] = 1.0;
        for (int round = 0; round < 3; ++round) {
            for (int i = 3; i > round; --i) {
                const double low = i - 3, span = 3 - round;  // knots low … low + span
                const auto at = static_cast<std::size_t>(i);
                const bool direction = derivative && round == 2;
                const double x = t[static_cast<std::size_t>(round)];
                for (std::size_t k = 0; k < 4; ++k) {
                    const Interval a = values[at - 1][k], b = values[at][k];
                    values[at][k] = direction ? (b - a) / span : a + (b - a) * Interval(x - low) / span;
                }
            }
        }
        return values[3];
    }

    // H ∂ for the coefficients of degree 3 on the four quarters of both cells; rows 1 and 2 divided by 1 − κ.
    [[nodiscard]] Rows ring_rows() const {
        Rows all;
        for (const MatrixXd& ring : rules_.ring) {
            const Rows points = rows_of(ring);
            for (int part = 0; part < 4; ++part) {
                const std::array<double, 3> low{part / 2 * 0.5, part % 2 * 0.5, 0}, high{low[0] + 0.5, low[1] + 0.5, 1};
                // Weights of each coefficient along an axis, of values and of derivatives raised to degree 3.
                std::array<std::array<std::array<Interval, 4>, 4>, 3> value, slope;
                for (std::size_t a = 0; a < 3; ++a) {
                    for (std::size_t k = 0; k < 4; ++k) {
                        std::array<double, 3> t{};
                        for (std::size_t n = 0; n < 3; ++n) t[n] = n < k ? high[a] : low[a];
                        value[a][k] = blossom(t, false);
                        // The mean over the arguments that are left out.
                        slope[a][k] = {};
                        for (std::size_t out = 0; out < 3; ++out) {
                            std::array<double, 3> others{};
                            std::size_t count = 0;
                            for (std::size_t n = 0; n < 3; ++n) {
                                if (n != out) others[count++] = t[n];
                            }
                            const auto weights = blossom(others, true);
                            for (std::size_t n = 0; n < 4; ++n) slope[a][k][n] = slope[a][k][n] + weights[n];
                        }
                    }
                }
                Rows rows;  // three derivatives of each coefficient
                for (std::size_t c = 0; c < 64; ++c) {
                    const std::array<std::size_t, 3> at{c / 16, c / 4 % 4, c % 4};
                    for (std::size_t a = 0; a < 3; ++a) {
                        Row row(points[0].size());
                        for (std::size_t p = 0; p < 64; ++p) {
                            const std::array<std::size_t, 3> from{p / 16, p / 4 % 4, p % 4};
                            Interval weight = 1.0;
                            for (std::size_t b = 0; b < 3; ++b) weight = weight * (a == b ? slope : value)[b][at[b]][from[b]];
                            if (weight.most() < 1e-290) continue;
                            for (std::size_t i = 0; i < row.size(); ++i) row[i] = row[i] + weight * points[p][i];
                        }
                        rows.push_back(std::move(row));
                    }
                }
                Rows of_map = product(rows, kept_);
                Eigen::Matrix2d mean = Eigen::Matrix2d::Zero();
                for (std::size_t c = 0; c < 64; ++c) {
                    for (std::size_t a = 0; a < 2; ++a) {
                        for (std::size_t b = 0; b < 2; ++b) {
                            mean(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) +=
                                of_map[3 * c + a][1 + b].low / 64;
                        }
                    }
                }
                const Eigen::Matrix2d h = mean.inverse();
                double kappa = 0;
                for (std::size_t c = 0; c < 64; ++c) {
                    double square = 0;
                    const Row u = rows[3 * c], v = rows[3 * c + 1];
                    for (std::size_t a = 0; a < 2; ++a) {
                        const Interval hu = h(static_cast<Eigen::Index>(a), 0), hv = h(static_cast<Eigen::Index>(a), 1);
                        for (std::size_t b = 1; b < 3; ++b) {
                            const Interval delta =
                                hu * of_map[3 * c][b] + hv * of_map[3 * c + 1][b] - Interval(a + 1 == b ? 1.0 : 0.0);
                            square += delta.most() * delta.most();
                        }
                        for (std::size_t i = 0; i < u.size(); ++i) rows[3 * c + a][i] = hu * u[i] + hv * v[i];
                    }
                    for (Interval& x : rows[3 * c + 2]) x = x * 2.0;
                    kappa = std::max(kappa, std::sqrt(square));
                }
                EXPECT_LT(kappa, 0.5);
                for (std::size_t c = 0; c < 64; ++c) {
                    for (std::size_t a = 0; a < 2; ++a) {
                        for (Interval& x : rows[3 * c + a]) x = x / (1 - kappa);
                    }
                }
                std::ranges::move(rows, std::back_inserter(all));
            }
        }
        return all;
    }

    const EdgeKind& kind_;
    EdgeRules rules_;
    Rows kept_, projection_;
    std::vector<Rows> rests_, drifts_;
};

TEST(EdgeKind, ConstantsAreProvedAgain) {
    for (const auto& [scheme, m] :
         {std::pair(Scheme::Bsxw, 3), std::pair(Scheme::CatmullClark, 3), std::pair(Scheme::Bsxw, 5)}) {
        const EdgeKind& kind = edge_kind(scheme, static_cast<std::size_t>(m));
        const std::string name = name_of(scheme, static_cast<std::size_t>(m));
        const Prover prover(scheme, kind);
        EXPECT_LT(prover.residual(), 1e-13) << name;
        const auto found = prover.run(kind.words);
        ASSERT_EQ(found.size(), kind.levels.size());
        constexpr double kSame = 1e-6;  // both are bounds, with errors of their own
        const double slow_size = prover.slow_size();
        EXPECT_NEAR(slow_size, kind.slow_size, kSame) << name;
        double across = 0, along = 0, largest_across = 0, largest_along = 0, drift_across = 0, drift_along = 0;
        std::vector<double> fed{0};  // Σ_{i<j} F_i (μ/λ)^(j − 1 − i)
        for (std::size_t j = 0; j < found.size(); ++j) {
            const EdgeKind::Level& level = kind.levels[j];
            EXPECT_NEAR(found[j].ring_across, level.ring_across, kSame * (1 + level.ring_across)) << name << " " << j;
            EXPECT_NEAR(found[j].ring_along, level.ring_along, kSame * (1 + level.ring_along)) << name << " " << j;
            EXPECT_NEAR(found[j].drift_across, level.drift_across, kSame * (1 + level.drift_across)) << name << " " << j;
            EXPECT_NEAR(found[j].drift_along, level.drift_along, kSame * (1 + level.drift_along)) << name << " " << j;
            EXPECT_NEAR(found[j].drift_slow, level.drift_slow, kSame) << name << " " << j;
            across = std::max(across, found[j].ring_across + drift_across + slow_size * fed.back());
            along = std::max(along, found[j].ring_along + drift_along);
            drift_across += found[j].drift_across;
            drift_along += found[j].drift_along;
            largest_across = std::max(largest_across, found[j].ring_across);
            largest_along = std::max(largest_along, found[j].ring_along);
            fed.push_back(fed.back() * kind.slow_rate / kind.rate + found[j].drift_slow);
        }
        const double falls = found.back().falls;
        const double falls_along = falls * std::pow(2 * kind.rate, static_cast<double>(kind.words));
        EXPECT_NEAR(falls, kind.falls_across, kSame) << name;
        ASSERT_LT(std::max(falls, falls_along), 1) << name;
        const double most_fed = std::max(*std::ranges::max_element(fed), fed.back() / (1 - falls));
        across = std::max(across, falls * largest_across + drift_across / (1 - falls) + slow_size * most_fed);
        along = std::max(along, falls_along * largest_along + drift_along / (1 - falls_along));
        EXPECT_NEAR(across, kind.across, kSame * across) << name;
        EXPECT_NEAR(along, kind.along, kSame * along) << name;
    }
}

}  // namespace edge_kind_test
}  // namespace subvol::detail
