// SPDX-License-Identifier: Apache-2.0
// Segments of irregular edges: their rules, their constants, which are proved again by other code, and what they prove.
#include "edge_kind.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "fold_checker.h"
#include "lib/subdivision/certificate/scheme_definition.h"
#include "subvol/certificate.h"
#include "subvol/refine.h"

namespace subvol::detail {
namespace edge_kind_test {

using Eigen::MatrixXd;

constexpr double kPi = 3.14159265358979323846;

std::string name_of(Scheme scheme, std::size_t cells) {
    return (scheme == Scheme::Bsxw ? "bsxw " : "cc ") + std::to_string(cells);
}

EdgeKind kind_of(Scheme scheme, std::size_t cells) {
    return make_edge_kind(edge_rules(scheme, cells), scheme == Scheme::Bsxw);
}

// A star: sectors of reach × reach cells about an edge, in layers. Sectors are as wide as each other.
struct StarMesh {
    Star star;
    std::size_t layers;
    HexMesh mesh;

    [[nodiscard]] std::size_t point(std::size_t s, int i, int j, std::size_t layer) const {
        return layer * star.points() + star.number(s, i, j);
    }
};

StarMesh make_star(std::size_t cells, std::size_t reach, std::size_t layers) {
    StarMesh made{{cells, reach}, layers, {}};
    made.mesh.points.resize(made.star.points() * (layers + 1));
    const double turn = 2 * kPi / static_cast<double>(cells);
    const int last = static_cast<int>(reach);
    for (std::size_t l = 0; l <= layers; ++l) {
        for (std::size_t s = 0; s < cells; ++s) {
            const double a = turn * static_cast<double>(s), b = a + turn;
            for (int i = 0; i <= last; ++i) {
                for (int j = 0; j <= last; ++j) {
                    made.mesh.points[made.point(s, i, j, l)] = {i * std::cos(a) + j * std::cos(b),
                                                                i * std::sin(a) + j * std::sin(b), static_cast<double>(l)};
                    if (i == last || j == last || l == layers) continue;
                    std::array<Index, 8> cell{};
                    for (std::size_t k = 0; k < 8; ++k) {
                        const int u = k == 1 || k == 2 || k == 5 || k == 6 ? 1 : 0, v = k % 4 >= 2 ? 1 : 0;
                        cell[k] = static_cast<Index>(made.point(s, i + u, j + v, l + k / 4));
                    }
                    made.mesh.cells.push_back(cell);
                }
            }
        }
    }
    return made;
}

void move_at_random(HexMesh& mesh, double amount, unsigned seed) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> off(-amount, amount);
    for (Vec3& x : mesh.points) x += Vec3(off(dice), off(dice), off(dice));
}

// The cells at the segment that starts at a layer.
std::vector<Index> cells_at_segment(const StarMesh& star, std::size_t layer) {
    std::vector<Index> cells;
    for (Index c = 0; c < star.mesh.cells.size(); ++c) {
        const auto& cell = star.mesh.cells[c];
        const auto has = [&](std::size_t p) { return std::ranges::find(cell, static_cast<Index>(p)) != cell.end(); };
        if (has(star.point(0, 0, 0, layer)) && has(star.point(0, 0, 0, layer + 1))) cells.push_back(c);
    }
    return cells;
}

// Two steps along the star are one in the definition's mesh.
EdgeRules defined_rules(Scheme scheme, std::size_t cells) {
    constexpr std::size_t kFirst = 2;
    const StarMesh mesh = make_star(cells, 3, 5);
    const test::Definition definition(mesh.mesh.cells);
    const Star window{cells, EdgeWindow::kReach};
    const auto columns = static_cast<Eigen::Index>(EdgeWindow::kLayers * window.points());
    std::map<Index, Eigen::Index> column;
    std::vector<std::array<int, 4>> places;  // s, i, j, layer of each point of the window
    places.resize(static_cast<std::size_t>(columns));
    for (int l = -1; l <= 2; ++l) {
        for (std::size_t s = 0; s < cells; ++s) {
            for (int i = 0; i <= 2; ++i) {
                for (int j = 0; j <= 2; ++j) {
                    const std::size_t p = static_cast<std::size_t>(l + 1) * window.points() + window.number(s, i, j);
                    column[static_cast<Index>(mesh.point(s, i, j, static_cast<std::size_t>(l + 2)))] =
                        static_cast<Eigen::Index>(p);
                    places[p] = {static_cast<int>(s), i, j, l};
                }
            }
        }
    }
    // The weights of the point (s, i, j) in a layer, in half steps from the segment's start.
    const auto put = [&](MatrixXd& rows, Eigen::Index row, int s, int i, int j, int layer) {
        if (j < 0) return std::tuple(s == 0 ? static_cast<int>(cells) - 1 : s - 1, -j, i, layer, &rows, row);
        return std::tuple(s, i, j, layer, &rows, row);
    };
    const auto fill = [&](const auto& at) {
        const auto& [s, i, j, layer, rows, row] = at;
        std::set<Index> corners;
        for (int k = 0; k < 8; ++k) {
            const auto half = [&](int x, int up) {
                return (x + (x % 2 != 0 && up != 0 ? 1 : 0) - (x % 2 != 0 && up == 0 ? 1 : 0)) / 2;
            };
            corners.insert(static_cast<Index>(mesh.point(static_cast<std::size_t>(s), half(i, k & 1), half(j, k & 2),
                                                         static_cast<std::size_t>(half(layer + 4, k & 4)))));
        }
        rows->row(row).setZero();
        for (const auto& [p, weight] : definition.weights(scheme, corners)) {
            if (weight != 0) (*rows)(row, column.at(p)) = weight;
        }
    };
    static_assert(kFirst == 2);
    EdgeRules rules{cells, {}, {}};
    for (int h = 0; h < 2; ++h) {
        MatrixXd& rows = rules.halves[static_cast<std::size_t>(h)];
        rows.resize(columns, columns);
        for (Eigen::Index k = 0; k < columns; ++k) {
            const auto& [s, i, j, l] = places[static_cast<std::size_t>(k)];
            fill(put(rows, k, s, i, j, h + l));
        }
        MatrixXd& ring = rules.ring[static_cast<std::size_t>(h)];
        ring.resize(64, columns);
        for (int p = 0; p < 64; ++p) fill(put(ring, p, 0, p / 16, h - 1 + p / 4 % 4, p % 4 - 1));
    }
    return rules;
}

TEST(EdgeKind, RulesAreThoseOfTheDefinition) {
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {3, 5, 6, 8}) {
            const EdgeRules rules = edge_rules(scheme, m), expected = defined_rules(scheme, m);
            for (std::size_t h = 0; h < 2; ++h) {
                EXPECT_LT((rules.halves[h] - expected.halves[h]).cwiseAbs().maxCoeff(), 1e-14) << name_of(scheme, m);
                EXPECT_LT((rules.ring[h] - expected.ring[h]).cwiseAbs().maxCoeff(), 1e-14) << name_of(scheme, m);
            }
        }
    }
}

// The constants as the documentation has them. Those of Catmull-Clark with 7 and 8 cells are not bounded: an eigenvalue of the
// rest is too near ½.
struct Stated {
    Scheme scheme;
    std::size_t cells;
    double across, along;
};
constexpr std::array<Stated, 8> kStated{{{Scheme::Bsxw, 3, 5.63, 4.23},
                                         {Scheme::Bsxw, 5, 11.89, 7.15},
                                         {Scheme::Bsxw, 6, 15.15, 7.9},
                                         {Scheme::Bsxw, 7, 18.34, 8.4},
                                         {Scheme::Bsxw, 8, 25.61, 8.75},
                                         {Scheme::CatmullClark, 3, 5.63, 4.22},
                                         {Scheme::CatmullClark, 5, 11.89, 7.15},
                                         {Scheme::CatmullClark, 6, 15.15, 11.22}}};

TEST(EdgeKind, ConstantsAreThoseStated) {
    for (const Stated& stated : kStated) {
        const EdgeKind& kind = edge_kind(stated.scheme, stated.cells);
        const double cosine = std::cos(2 * kPi / static_cast<double>(stated.cells));
        const double rate = (5 + cosine + std::sqrt((1 + cosine) * (9 + cosine))) / 16;  // as of Catmull-Clark surfaces
        EXPECT_NEAR(kind.rate, rate, 1e-12) << name_of(stated.scheme, stated.cells);
        EXPECT_LE(kind.across, stated.across) << name_of(stated.scheme, stated.cells);
        EXPECT_LE(kind.along, stated.along) << name_of(stated.scheme, stated.cells);
        EXPECT_GT(kind.across, stated.across - 0.01) << name_of(stated.scheme, stated.cells);
        EXPECT_GT(kind.along, stated.along - 0.01) << name_of(stated.scheme, stated.cells);
    }
    EXPECT_FALSE(edge_kind(Scheme::CatmullClark, 7).is_bounded());
    EXPECT_FALSE(edge_kind(Scheme::CatmullClark, 8).is_bounded());
    EXPECT_FALSE(edge_kind(Scheme::Bsxw, 9).is_bounded());
}

// No weight may be off by 1e-9.
TEST(EdgeKind, OtherRulesHaveNoConstants) {
    const EdgeRules rules = edge_rules(Scheme::CatmullClark, 5);
    ASSERT_TRUE(make_edge_kind(rules, false).is_bounded());
    EXPECT_FALSE(make_edge_kind(rules, true).is_bounded());  // data along the edge do not stay constant at the edge itself
    std::mt19937 dice(4);
    for (int k = 0; k < 200; ++k) {
        EdgeRules other = rules;
        MatrixXd& rows = k % 4 == 3 ? other.ring[dice() % 2] : other.halves[dice() % 2];
        rows(dice() % rows.rows(), dice() % rows.cols()) += 1e-9;
        EXPECT_FALSE(make_edge_kind(other, false).is_bounded());
    }
}

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
            kept_.push_back({1.0, outward(x[0] - kOfMap, x[0] + kOfMap), outward(x[1] - kOfMap, x[1] + kOfMap), x[2]});
        }
        // L = L̃ (1 + η)⁻¹
        Rows lefts(4, Row(n));
        for (std::size_t k = 0; k < n; ++k) {
            for (std::size_t c = 0; c < 4; ++c) lefts[c][k] = kind.left[k][c];
        }
        Rows units = product(lefts, kept_);
        double eta = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            units[c][c] = units[c][c] - 1.0;
            for (const Interval& x : units[c]) eta = std::max(eta, x.most());
        }
        Row largest(n);
        for (std::size_t k = 0; k < n; ++k) {
            for (std::size_t c = 0; c < 4; ++c) largest[k].high += std::abs(kind.left[k][c]);
        }
        for (std::size_t c = 0; c < 4; ++c) {
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

    // |T χ − χ Λ|
    [[nodiscard]] double residual() const {
        double most = 0;
        for (std::size_t h = 0; h < 2; ++h) {
            for (std::size_t c = 0; c < 3; ++c) {
                Eigen::VectorXd x(static_cast<Eigen::Index>(kind_.weights.size()));
                for (Eigen::Index k = 0; k < x.size(); ++k) x(k) = kind_.characteristic[static_cast<std::size_t>(k)][c];
                const Eigen::VectorXd to = rules_.halves[h] * x - (c == 2 ? 0.5 : kind_.rate) * x;
                most = std::max(most, (to.array() - (c == 2 ? h == 0 ? -0.25 : 0.25 : 0)).abs().maxCoeff());
            }
        }
        return most;
    }

    struct Found {
        double ring_across = 0, ring_along = 0, drift_across = 0, drift_along = 0, falls = 0;
    };

    // For words of a length: the ring and the drift, and the norm of products that are one letter longer.
    [[nodiscard]] std::vector<Found> run(std::size_t words) const {
        std::vector<Found> found;
        Rows ring = ring_rows();
        std::vector<Rows> rows{product(ring, projection_)}, products;
        for (std::size_t j = 0; j < words; ++j) {
            Found at;
            const double across = std::pow(kind_.rate, static_cast<double>(j)), along = std::pow(0.5, static_cast<double>(j));
            for (const Rows& some : rows) include(some, 0, at.ring_across, at.ring_along, across, along);
            for (const Rows& drift : drifts_) {
                if (j == 0) include(drift, 1, at.drift_across, at.drift_along, across * kind_.rate, along / 2);
                for (const Rows& by : products) {
                    include(product(drift, by), 1, at.drift_across, at.drift_along, across * kind_.rate, along / 2);
                }
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

    void include(const Rows& rows, std::size_t first, double& across, double& along, double by_across, double by_along) const {
        for (std::size_t k = first; k < rows.size(); k += 3) {
            across = std::max(across, std::hypot(size(rows[k]), size(rows[k + 1])) / by_across);
            along = std::max(along, size(rows[k + 2]) / by_along);
        }
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
        constexpr double kSame = 1e-6;
        double across = 0, along = 0, largest = 0, drift_across = 0, drift_along = 0;
        for (std::size_t j = 0; j < found.size(); ++j) {
            const EdgeKind::Level& level = kind.levels[j];
            EXPECT_NEAR(found[j].ring_across, level.ring_across, kSame * level.ring_across) << name << " " << j;
            EXPECT_NEAR(found[j].ring_along, level.ring_along, kSame * level.ring_along) << name << " " << j;
            EXPECT_NEAR(found[j].drift_across, level.drift_across, kSame * level.drift_across) << name << " " << j;
            EXPECT_NEAR(found[j].drift_along, level.drift_along, kSame * level.drift_along) << name << " " << j;
            across = std::max(across, found[j].ring_across + drift_across);
            along = std::max(along, found[j].ring_along + drift_along);
            drift_across += found[j].drift_across;
            drift_along += found[j].drift_along;
            largest = std::max(largest, found[j].ring_across);
        }
        EXPECT_NEAR(found.back().falls, kind.falls_across, kSame) << name;
        ASSERT_LT(found.back().falls, 1) << name;
        across = std::max(across, found.back().falls * largest + drift_across / (1 - found.back().falls));
        EXPECT_LT(across, kind.across * (1 + kSame)) << name;
        EXPECT_LT(along, kind.along * (1 + kSame)) << name;
    }
}

// Derivatives of the ring of a window, along the lower half in sector 0.
class Ring {
public:
    explicit Ring(const EdgeRules& rules) : rules_(rules), star_{rules.cells, EdgeWindow::kReach} {}

    using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

    [[nodiscard]] Points half(const Points& points, std::size_t h) const { return rules_.halves[h] * points; }

    // The points with the sectors turned.
    [[nodiscard]] Points turned(const Points& points, std::size_t sectors) const {
        Points result(points.rows(), 3);
        for (std::size_t l = 0; l < EdgeWindow::kLayers; ++l) {
            for (std::size_t s = 0; s < star_.cells; ++s) {
                for (int i = 0; i <= 2; ++i) {
                    for (int j = 0; j <= 2; ++j) {
                        const auto at = [&](std::size_t sector) {
                            return static_cast<Eigen::Index>(l * star_.points() + star_.number(sector % star_.cells, i, j));
                        };
                        result.row(at(s)) = points.row(at(s + sectors));
                    }
                }
            }
        }
        return result;
    }

    // det ∂x at a place of one of the two cells of the ring.
    [[nodiscard]] double determinant(const Points& points, std::size_t cell, const std::array<double, 3>& t) const {
        const Points spline = rules_.ring[cell] * points;
        Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
        for (int p = 0; p < 64; ++p) {
            const std::array<int, 3> at{p / 16, p / 4 % 4, p % 4};
            for (int a = 0; a < 3; ++a) {
                double weight = 1;
                for (int b = 0; b < 3; ++b) {
                    const double x = t[static_cast<std::size_t>(b)], y = 1 - x;
                    const std::array<double, 4> value{y * y * y / 6, (3 * x * x * x - 6 * x * x + 4) / 6,
                                                      (3 * y * y * y - 6 * y * y + 4) / 6, x * x * x / 6};
                    const std::array<double, 4> slope{-y * y / 2, (3 * x * x - 4 * x) / 2, -(3 * y * y - 4 * y) / 2, x * x / 2};
                    weight *= (a == b ? slope : value)[static_cast<std::size_t>(at[static_cast<std::size_t>(b)])];
                }
                j.row(a) += weight * spline.row(p);
            }
        }
        return j.determinant();
    }

private:
    const EdgeRules& rules_;
    Star star_;
};

Ring::Points window_of(const StarMesh& mesh, std::size_t first) {
    const Star star{mesh.star.cells, EdgeWindow::kReach};
    Ring::Points points(static_cast<Eigen::Index>(EdgeWindow::kLayers * star.points()), 3);
    for (std::size_t l = 0; l < EdgeWindow::kLayers; ++l) {
        for (std::size_t s = 0; s < star.cells; ++s) {
            for (int i = 0; i <= 2; ++i) {
                for (int j = 0; j <= 2; ++j) {
                    const Vec3& x = mesh.mesh.points[mesh.point(s, i, j, first + l - 1)];
                    points.row(static_cast<Eigen::Index>(l * star.points() + star.number(s, i, j))) << x.x, x.y, x.z;
                }
            }
        }
    }
    return points;
}

// The least determinant at places of the tube of a segment, over random words, beside the mean of its ring.
double least_determinant(const Ring& ring, std::size_t cells, const Ring::Points& window, std::size_t places,
                         std::mt19937& dice) {
    constexpr std::size_t kDepth = 12;
    std::uniform_real_distribution<double> unit(0, 1);
    double least = 1;
    while (places > 0) {
        Ring::Points points = window;
        for (std::size_t depth = 0; depth <= kDepth && places > 0; ++depth) {
            const Ring::Points turned = ring.turned(points, dice() % cells);
            std::array<double, 6> det{};
            double mean = 0;
            for (std::size_t k = 0; k < det.size(); ++k) {
                const bool corner = dice() % 4 == 0;
                const auto coordinate = [&] { return corner ? static_cast<double>(dice() % 2) : unit(dice); };
                det[k] = ring.determinant(turned, k % 2, {coordinate(), coordinate(), coordinate()});
                mean += std::abs(det[k]) / static_cast<double>(det.size());
            }
            for (const double x : det) least = std::min(least, x / mean);
            places -= std::min(places, det.size());
            points = ring.half(points, dice() % 2);
        }
    }
    return least;
}

FoldVerdict worst_of(const FoldChecker& checker, const std::vector<Index>& cells) {
    FoldVerdict worst = FoldVerdict::Proved;
    for (const Index c : cells) {
        if (checker.verdict(c) != FoldVerdict::Proved) worst = checker.verdict(c);
    }
    return worst;
}

// How many stars to look at, and how many places of each: more by hand, with the environment.
std::size_t count_of(const char* variable, std::size_t usual) {
    const char* text = std::getenv(variable);
    return text == nullptr ? usual : static_cast<std::size_t>(std::strtoull(text, nullptr, 10));
}

TEST(EdgeKind, NothingIsProvedFalsely) {
    const std::size_t stars = count_of("SUBVOL_STARS", 5), places = count_of("SUBVOL_STAR_PLACES", 300);
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {3, 5, 6, 7, 8}) {
            const EdgeRules rules = edge_rules(scheme, m);
            const Ring ring(rules);
            const FoldOptions options{.scheme = {.kind = scheme}};
            for (const double amount : {0.0, 0.05, 0.1, 0.2, 0.3, 0.6}) {
                std::size_t proved = 0, folded = 0;
                double least = 1;
                for (std::size_t k = 0; k < (amount == 0 ? 1 : stars); ++k) {
                    StarMesh star = make_star(m, 3, 5);
                    move_at_random(star.mesh, amount, static_cast<unsigned>(1000 * m + k));
                    FoldChecker checker(star.mesh, options);
                    const std::vector<Index> cells = cells_at_segment(star, 2);
                    ASSERT_EQ(cells.size(), m);
                    checker.check(cells, FoldEffort::Verdict);
                    const FoldVerdict verdict = worst_of(checker, cells);
                    folded += verdict == FoldVerdict::Folded ? 1 : 0;
                    if (verdict != FoldVerdict::Proved) continue;
                    ++proved;
                    std::mt19937 dice(static_cast<unsigned>(k));
                    least = std::min(least, least_determinant(ring, m, window_of(star, 2), places, dice));
                }
                EXPECT_GT(least, 0) << name_of(scheme, m) << " " << amount;
                EXPECT_TRUE(amount > 0 || proved == 1 || !edge_kind(scheme, m).is_bounded()) << name_of(scheme, m);
                if (stars > 10) {
                    std::printf("%s noise %.2f: %zu proved, %zu folded, least determinant %.3f\n", name_of(scheme, m).c_str(),
                                amount, proved, folded, least);
                }
            }
        }
    }
}

// The derivative along the edge is below 0 between 0.2976 and 0.3024 of the segment alone, where no corner of a cell of level 7
// or coarser lies.
TEST(EdgeKind, FoldsOfFineLevelsAreNotProved) {
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {3, 5, 6}) {
            for (const double least : {-5e-6, 0.2}) {
                // f'(t) = a (1 − t)²/2 + b (1/2 + t − t²) + c t²/2 has its minimum at 0.3 if its derivative is 0 there.
                constexpr double kAt = 0.3, kHigh = 1;
                // b from c = 1: −a (1 − t) + b (1 − 2t) + c t = 0 and f' = least
                const double t = kAt, u = 1 - t, v = 1 - 2 * t, w = 0.5 + t - t * t;
                const double b = (least - kHigh * t * t / 2 - kHigh * t * u / 2) / (w + v * u / 2);
                const double a = (b * v + kHigh * t) / u;
                StarMesh star = make_star(m, 3, 5);
                const std::array<double, 6> heights{-a - 1, -a, 0, b, b + kHigh, b + 2 * kHigh};
                for (std::size_t p = 0; p < star.mesh.points.size(); ++p)
                    star.mesh.points[p].z = heights[p / star.star.points()];
                const std::vector<Index> cells = cells_at_segment(star, 2);
                const FoldOptions options{.scheme = {.kind = scheme}, .irregular_levels = 6};
                FoldChecker checker(star.mesh, options);
                checker.check(cells, FoldEffort::Verdict);
                const EdgeRules rules = edge_rules(scheme, m);
                const Ring ring(rules);
                const Ring::Points window = window_of(star, 2);
                EXPECT_TRUE(least < 0 || worst_of(checker, cells) == FoldVerdict::Proved) << name_of(scheme, m);
                // 0.3 is 0.01001100…: down to level 6.
                Ring::Points points = window;
                const std::array<std::size_t, 6> word{0, 1, 0, 0, 1, 1};
                for (const std::size_t h : word) points = ring.half(points, h);
                const double fine = (0.3 * 64 - 19) * 2;  // in small steps
                const double det = ring.determinant(points, 0, {0.5, 0.5, fine});
                EXPECT_FALSE(det < 0 && worst_of(checker, cells) == FoldVerdict::Proved) << name_of(scheme, m);
                // The rules of Catmull-Clark differ at the edge itself, so that the derivative is not quite f'.
                EXPECT_TRUE(scheme == Scheme::CatmullClark || (det < 0) == (least < 0)) << name_of(scheme, m);
            }
        }
    }
}

// A straight edge from boundary to boundary.
TEST(EdgeKind, StraightStarsAreProved) {
    for (const std::size_t m : {3, 5, 6}) {
        const StarMesh star = make_star(m, 3, 5);
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            EXPECT_EQ(check_folds(star.mesh, {.scheme = {.kind = scheme}}).report.proved, star.mesh.cells.size())
                << name_of(scheme, m);
        }
    }
}

// The limit of BSXW in the cells where an edge ends goes on straight beyond the boundary.
TEST(EdgeKind, RulesGoOnStraightAtTheBoundary) {
    for (const std::size_t m : {3, 5}) {
        StarMesh star = make_star(m, 3, 3);
        move_at_random(star.mesh, 0.2, 7);
        const HexMesh fine = refine(star.mesh, {.scheme = {.kind = Scheme::Bsxw}, .levels = 1});
        StarMesh longer = make_star(m, 3, 4);
        for (std::size_t p = 0; p < star.star.points(); ++p) {
            for (std::size_t l = 0; l < 4; ++l)
                longer.mesh.points[(l + 1) * star.star.points() + p] = star.mesh.points[l * star.star.points() + p];
            longer.mesh.points[p] = star.mesh.points[p] * 2.0 - star.mesh.points[star.star.points() + p];
        }
        const HexMesh fine_longer = refine(longer.mesh, {.scheme = {.kind = Scheme::Bsxw}, .levels = 1});
        const std::size_t per_layer = star.mesh.cells.size() / 3;
        double off = 0;
        for (std::size_t c = 0; c < per_layer; ++c) {
            for (std::size_t child = 0; child < 8; ++child) {
                for (std::size_t k = 0; k < 8; ++k) {
                    const Vec3& x = fine.points[fine.cells[8 * c + child][k]];
                    const Vec3& y = fine_longer.points[fine_longer.cells[8 * (c + per_layer) + child][k]];
                    off = std::max(off, glm::distance(x, y));
                }
            }
        }
        EXPECT_LT(off, 1e-14);
    }
}

}  // namespace edge_kind_test
}  // namespace subvol::detail
