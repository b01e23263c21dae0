// SPDX-License-Identifier: Apache-2.0
// What is proved of segments of irregular edges, held against determinants at many places of stars with noise, and of stars
// that fold at fine levels.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

#include "edge_kind.h"
#include "fold_checker.h"
#include "lib/subdivision/certificate/star_mesh.h"
#include "subvol/certificate.h"
#include "subvol/refine.h"

namespace subvol::detail {
namespace edge_kind_test {

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
        for (const std::size_t m : {3UL, 5UL, 6UL, 7UL, 8UL}) {
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

// The largest multiple of χ + ψ C + q' that is proved does not fold, and such data without q' are proved for a good part of the
// way to the first fold.
TEST(EdgeKind, SlowDataAreProvedUntilTheyNearlyFold) {
    std::mt19937 dice(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {5UL, 6UL, 8UL}) {
            const EdgeRules rules = edge_rules(scheme, m);
            const Ring ring(rules);
            const EdgeKind& kind = edge_kind(scheme, m);
            for (int n = 0; n < 6; ++n) {
                const double of_rest = n % 2 == 0 ? 0 : 0.02;
                std::array<Vec3, 2> c{Vec3(unit(dice), unit(dice), unit(dice)), Vec3(unit(dice), unit(dice), unit(dice))};
                if (n % 4 == 0) c[0].z = c[1].z = 0;
                std::vector<Vec3> change;
                for (std::size_t p = 0; p < kind.weights.size(); ++p) {
                    const Vec3 rest(unit(dice), unit(dice), unit(dice));
                    change.push_back(c[0] * kind.slow[p][0] + c[1] * kind.slow[p][1] + rest * (of_rest * kind.weights[p]));
                }
                const auto window = [&](double t) {
                    std::vector<Vec3> points;
                    for (std::size_t p = 0; p < change.size(); ++p) {
                        const auto& x = kind.characteristic[p];
                        points.push_back(Vec3(x[0], x[1], x[2]) + change[p] * t);
                    }
                    return points;
                };
                const auto first_failure = [](int steps, const auto& passes) {
                    double low = 0, high = 4;
                    for (int k = 0; k < steps; ++k) {
                        const double t = (low + high) / 2;
                        (passes(t) ? low : high) = t;
                    }
                    return low;
                };
                const auto least = [&](double t) {
                    std::mt19937 places(static_cast<unsigned>(n));
                    const std::vector<Vec3> points = window(t);
                    Ring::Points rows(static_cast<Eigen::Index>(points.size()), 3);
                    for (std::size_t p = 0; p < points.size(); ++p) {
                        rows.row(static_cast<Eigen::Index>(p)) << points[p].x, points[p].y, points[p].z;
                    }
                    return least_determinant(ring, m, rows, 300, places);
                };
                const double proved = first_failure(20, [&](double t) { return proves_segment(kind, window(t), {}, 0); });
                EXPECT_GT(proved, 0) << name_of(scheme, m);
                EXPECT_GT(least(proved), 0) << name_of(scheme, m) << " " << n;
                if (of_rest > 0) continue;
                const double folds = first_failure(7, [&](double t) { return least(t) > 0; });
                EXPECT_GT(proved, 0.25 * folds) << name_of(scheme, m) << " " << n;
            }
        }
    }
}

// The derivative along the edge is below 0 between 0.2976 and 0.3024 of the segment alone, where no corner of a cell of level 7
// or coarser lies.
TEST(EdgeKind, FoldsOfFineLevelsAreNotProved) {
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {3UL, 5UL, 6UL}) {
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
    for (const std::size_t m : {3UL, 5UL, 6UL}) {
        const StarMesh star = make_star(m, 3, 5);
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            EXPECT_EQ(check_folds(star.mesh, {.scheme = {.kind = scheme}}).report.proved, star.mesh.cells.size())
                << name_of(scheme, m);
        }
    }
}

// The limit of BSXW in the cells where an edge ends goes on straight beyond the boundary.
TEST(EdgeKind, RulesGoOnStraightAtTheBoundary) {
    for (const std::size_t m : {3UL, 5UL}) {
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
