// SPDX-License-Identifier: Apache-2.0
// Kinds of irregular points: their rules, and what they prove.
#include "link_kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <set>

#include "lib/subdivision/certificate/scheme_definition.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/certificate.h"
#include "subvol/limit.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol::detail {
namespace link_kind_test {

using Eigen::MatrixXd;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

struct Case {
    std::string name;
    PointLink link;
    std::array<double, 3> rates_bsxw;  // of a prototype
    double reach;                      // a little less than what is found
};

PointLink fan(int cells) {
    PointLink link;
    for (int s = 0; s < cells; ++s) link.push_back({0, 1 + s, 1 + (s + 1) % cells});
    return link;
}

PointLink bipyramid(int cells) {
    PointLink link;
    for (int s = 0; s < cells; ++s) {
        link.push_back({0, 2 + s, 2 + (s + 1) % cells});
        link.push_back({1, 2 + (s + 1) % cells, 2 + s});
    }
    return link;
}

const PointLink kTetrahedron{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};

// A triangle of the link with a new direction in it.
PointLink stacked(PointLink link, std::size_t t, int direction) {
    const auto [a, b, c] = link[t];
    link[t] = {a, b, direction};
    link.push_back({b, c, direction});
    link.push_back({c, a, direction});
    return link;
}

std::vector<Case> cases() {
    return {{"3333", kTetrahedron, {0.3632, 0.3632, 0.3632}, 0.021},
            {"33 444", bipyramid(3), {0.5, 0.4101, 0.4101}, 0.021},
            {"33 44 55", stacked(bipyramid(3), 0, 5), {0.5604, 0.4692, 0.4326}, 0.014},
            {"44444 55", bipyramid(5), {0.55, 0.55, 0.5}, 0.029},
            {"end of 3", fan(3), {0.5, 0.4101, 0.4101}, 0.021},
            {"end of 5", fan(5), {0.55, 0.55, 0.5}, 0.029}};
}

// The cells around the point up to a reach; cell (t, i, j, k) is cell ((t reach + i) reach + j) reach + k.
HexMesh solid(const PointStar& star) {
    HexMesh mesh;
    mesh.points.resize(star.points());
    for (std::size_t t = 0; t < star.link().size(); ++t) {
        for (int i = 0; i < star.reach(); ++i) {
            for (int j = 0; j < star.reach(); ++j) {
                for (int k = 0; k < star.reach(); ++k) {
                    std::array<Index, 8> cell{};
                    for (std::size_t n = 0; n < 8; ++n) {
                        const auto& [u, v, w] = kCornerParameters[n];
                        cell[n] = static_cast<Index>(star.number(t, {i + u, j + v, k + w}));
                    }
                    mesh.cells.push_back(cell);
                }
            }
        }
    }
    return mesh;
}

Points window_of(const PointStar& from, const HexMesh& mesh, const PointLink& link) {
    const PointStar window(link, PointWindow::kReach);
    Points points(static_cast<Eigen::Index>(window.points()), 3);
    window.each([&](std::size_t t, const std::array<int, 3>& steps) {
        const Vec3& x = mesh.points[from.number(t, steps)];
        points.row(static_cast<Eigen::Index>(window.number(t, steps))) << x.x, x.y, x.z;
    });
    return points;
}

TEST(LinkKind, RulesAreThoseOfTheDefinition) {
    for (const Case& at : cases()) {
        const PointStar star(at.link, 3), window(at.link, PointWindow::kReach);
        const test::Definition definition(solid(star).cells);
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const PointRules rules = point_rules(scheme, at.link);
            EXPECT_LT((rules.step.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
            double off = 0;
            window.each([&](std::size_t t, const std::array<int, 3>& steps) {
                bool inside = true;  // the definition is that of inner points
                for (std::size_t v = 0; v < 3; ++v) inside = inside && (steps[v] > 0 || window.beyond(t, v));
                if (!inside) return;
                for (const int direction : at.link[t])
                    inside = inside && !(window.on_rim(direction) && steps == std::array<int, 3>{});
                std::set<Index> corners;
                for (int n = 0; n < 8; ++n) {
                    std::array<int, 3> corner{};
                    for (std::size_t v = 0; v < 3; ++v)
                        corner[v] = (steps[v] + (steps[v] % 2 != 0 && (n >> v & 1) != 0 ? 1 : 0)) / 2;
                    corners.insert(static_cast<Index>(star.number(t, corner)));
                }
                // A step along the rim alone is on the boundary.
                int along_rim = 0;
                for (std::size_t v = 0; v < 3; ++v) along_rim += steps[v] > 0 && !window.on_rim(at.link[t][v]) ? 1 : 0;
                const bool has_rim = window.on_rim(at.link[0][0]) || window.on_rim(at.link[0][1]);
                if (has_rim && along_rim == 0) return;
                std::vector<double> row(window.points(), 0.0);
                const auto weights = definition.weights(scheme, corners);
                window.each([&](std::size_t s, const std::array<int, 3>& place) {
                    const auto found = weights.find(static_cast<Index>(star.number(s, place)));
                    if (found != weights.end()) row[window.number(s, place)] = found->second;
                });
                for (std::size_t c = 0; c < row.size(); ++c) {
                    off = std::max(off, std::abs(row[c] - rules.step(static_cast<Eigen::Index>(window.number(t, steps)),
                                                                     static_cast<Eigen::Index>(c))));
                }
            });
            EXPECT_LT(off, 1e-14) << at.name;
        }
    }
}

// ∂x at a place of a spline cell whose points are rows.
Eigen::Matrix3d slopes(const Points& spline, const std::array<double, 3>& t) {
    Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
    for (int p = 0; p < 64; ++p) {
        const std::array<int, 3> at{p / 16, p / 4 % 4, p % 4};
        for (int a = 0; a < 3; ++a) {
            double weight = 1;
            for (std::size_t b = 0; b < 3; ++b) {
                const double x = t[b], y = 1 - x;
                const std::array<double, 4> value{y * y * y / 6, (3 * x * x * x - 6 * x * x + 4) / 6,
                                                  (3 * y * y * y - 6 * y * y + 4) / 6, x * x * x / 6};
                const std::array<double, 4> slope{-y * y / 2, (3 * x * x - 4 * x) / 2, -(3 * y * y - 4 * y) / 2, x * x / 2};
                weight *= (a == static_cast<int>(b) ? slope : value)[static_cast<std::size_t>(at[b])];
            }
            j.row(a) += weight * spline.row(p);
        }
    }
    return j;
}

// Derivatives in the shell are those of the limit, at the boundary too; the windows of segments are those of the finer mesh.
TEST(LinkKind, ShellsAreThoseOfTheLimit) {
    std::mt19937 dice(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const Case& at : cases()) {
        const PointStar star(at.link, 4);
        HexMesh mesh = solid(star);
        for (Vec3& x : mesh.points) x = {unit(dice), unit(dice), unit(dice)};
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const PointRules rules = point_rules(scheme, at.link);
            const Points window = window_of(star, mesh, at.link);
            const auto is_irregular = [&](int d) { return !star.on_rim(d) && star.valence(d) != 4; };
            std::size_t shell = 0;
            for (std::size_t t = 0; t < at.link.size(); ++t) {
                for (int low = 1; low < 8; ++low) {
                    const std::array<int, 3> corner{low & 1, low >> 1 & 1, low >> 2};
                    bool is_regular = true;
                    for (std::size_t v = 0; v < 3; ++v) {
                        is_regular = is_regular && !(low == 1 << v && is_irregular(at.link[t][v]));
                    }
                    if (!is_regular) continue;
                    const Points spline = rules.shell.at(shell++) * window;
                    const std::array<double, 3> place{unit(dice), unit(dice), unit(dice)};
                    const LimitQuery query{
                        static_cast<Index>(t * 64),
                        {(corner[0] + place[0]) / 2, (corner[1] + place[1]) / 2, (corner[2] + place[2]) / 2}};
                    const Mat3 j = evaluate_limit(mesh, std::vector{query}, {.scheme = {.kind = scheme}}).jacobians[0];
                    const Eigen::Matrix3d expected = slopes(spline, place) * 2;
                    for (int a = 0; a < 3; ++a) {
                        for (int c = 0; c < 3; ++c) EXPECT_NEAR(j[a][c], expected(a, c), 1e-12) << at.name;
                    }
                }
            }
            EXPECT_EQ(shell, rules.shell.size());
            const HexMesh fine = refine(mesh, {.scheme = {.kind = scheme}, .levels = 1});
            const Topology topology = build_topology(fine);
            for (const auto& segment : rules.segments) {
                const Points points = segment.rows * window;
                bool found = false;
                for (Index c = 0; c < fine.cells.size() && !found; ++c) {
                    const auto other = edge_window(topology, c);
                    if (!other || other->cells != segment.cells || other->is_beyond(0) || other->is_beyond(3)) continue;
                    std::vector<std::array<double, 3>> left, right;
                    for (Eigen::Index k = 0; k < points.rows(); ++k) left.push_back({points(k, 0), points(k, 1), points(k, 2)});
                    for (const Index p : other->points) right.push_back({fine.points[p].x, fine.points[p].y, fine.points[p].z});
                    std::ranges::sort(left);
                    std::ranges::sort(right);
                    double off = 0;
                    for (std::size_t k = 0; k < left.size(); ++k) {
                        for (std::size_t a = 0; a < 3; ++a) off = std::max(off, std::abs(left[k][a] - right[k][a]));
                    }
                    found = off < 1e-12;
                }
                EXPECT_TRUE(found) << at.name;
            }
        }
    }
}

TEST(LinkKind, KindsAreProved) {
    for (const Case& at : cases()) {
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const LinkKind& kind = link_kind(scheme, at.link);
            ASSERT_EQ(kind.rates.size(), 3U) << at.name;
            if (scheme == Scheme::Bsxw) {
                for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(kind.rates[k], at.rates_bsxw[k], 6e-5) << at.name;
            }
            EXPECT_TRUE(kind.is_bounded()) << at.name;
            EXPECT_LT(kind.growth, 1.7) << at.name;
            EXPECT_GT(kind.reach, at.reach) << at.name;
        }
    }
}

// Data as bad as the bound allows: each of them worst for one entry of the Jacobian at one place, there and in all shells
// below.
TEST(LinkKind, TheWorstDataWithinReachDoNotFold) {
    std::mt19937 dice(8);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    for (const Case& at : cases()) {
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const LinkKind& kind = link_kind(scheme, at.link);
            const PointRules rules = point_rules(scheme, at.link);
            double least = 1;
            const auto include = [&](const Points& near) {
                const auto look = [&](const Points& spline) {
                    double det[4], mean = 0;
                    for (double& d : det) {
                        const bool corner = dice() % 2 == 0;
                        const auto one = [&] { return corner ? static_cast<double>(dice() % 2) : unit(dice); };
                        d = slopes(spline, {one(), one(), one()}).determinant();
                        mean += std::abs(d) / 4;
                    }
                    for (const double d : det) least = std::min(least, d / mean);
                };
                look(rules.shell[dice() % rules.shell.size()] * near);
                for (const auto& segment : kind.segments) {
                    Points window = segment.rows * near;
                    for (int depth = 0; depth < 6; ++depth) {
                        const SplinePieces& ring = segment.rules->ring;
                        look(ring.of(dice() % ring.points.size(), Points(ring.rows * window)));
                        window = segment.rules->halves[dice() % 2] * window;
                    }
                }
            };
            for (int trial = 0; trial < 100; ++trial) {
                // The row of a derivative at a place, by the points of the window.
                const MatrixXd& shell = rules.shell[dice() % rules.shell.size()];
                const std::array<double, 3> place{unit(dice), unit(dice), unit(dice)};
                Eigen::RowVectorXd row(shell.cols());
                const Eigen::RowVector3d mixed(both(dice), both(dice), both(dice));
                for (Eigen::Index k = 0; k < row.size(); ++k) {
                    Points one = Points::Zero(64, 3);
                    one.col(0) = shell.col(k);
                    row(k) = mixed * slopes(one, place).col(0);
                }
                const Eigen::RowVector3d to = Eigen::RowVector3d(both(dice), both(dice), both(dice)).normalized();
                Points q(kind.weights.size(), 3);
                for (Eigen::Index k = 0; k < q.rows(); ++k)
                    q.row(k) = (row(k) > 0 ? -1 : 1) * kind.reach * kind.weights(k) * to;
                include(kind.characteristic + q);
                // Below: a smaller q, by the powers of the rules themselves.
                Points below = kind.characteristic + q / kind.growth;
                for (int level = 0; level < 10; ++level) {
                    include(below);
                    below = rules.step * below;
                }
            }
            EXPECT_GT(least, 0) << at.name;
        }
    }
}

// (x, y, z) → (x + c y², y, z) keeps volumes. Its second derivatives bring the points far from χ: many shells and halves of
// segments are needed.
TEST(LinkKind, BentDataAreProved) {
    constexpr double kBend = 0.12;
    for (const Case& at : cases()) {
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const LinkKind& kind = link_kind(scheme, at.link);
            Points bent = kind.characteristic;
            bent.col(0).array() += kBend * bent.col(1).array().square();
            std::vector<Vec3> points;
            for (Eigen::Index k = 0; k < bent.rows(); ++k) points.emplace_back(bent(k, 0), bent(k, 1), bent(k, 2));
            EXPECT_TRUE(proves_point(kind, points, {}, 0)) << at.name;
            // A mirrored window folds.
            for (Vec3& x : points) x.z = -x.z;
            EXPECT_FALSE(proves_point(kind, points, {}, 0)) << at.name;
        }
    }
}

/// A box of 4 × 4 × 3 cells, and one of the same cells `size` times as large that has the middle of its top in common.
HexMesh touching_boxes(double size) {
    HexMesh mesh = test::make_box(4, 4, 3);
    const Vec3 touch(2, 2, 3);
    const auto at = static_cast<Index>(std::ranges::find(mesh.points, touch) - mesh.points.begin());
    const HexMesh other = test::make_box(4, 4, 3);
    std::vector<Index> number;
    for (const Vec3& x : other.points) {
        const bool shared = x == Vec3(2, 2, 0);
        number.push_back(shared ? at : static_cast<Index>(mesh.points.size()));
        if (!shared) mesh.points.push_back(touch + size * (x - Vec3(2, 2, 0)));
    }
    for (auto cell : other.cells) {
        for (Index& p : cell) p = number[p];
        mesh.cells.push_back(cell);
    }
    return mesh;
}

// Where two bodies touch in a point it stays in its place: it has not the rules of the smooth boundary of one of them.
TEST(LinkKind, PointsWhereBodiesTouchAreNotProved) {
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const Vec3& moved : {Vec3(0, 0, -.5), Vec3(.5, .5, 0)}) {
            HexMesh mesh = touching_boxes(50);
            *std::ranges::find(mesh.points, Vec3(2, 2, 3)) += moved;
            // The limit folds there: refined cells have corners of negative determinant.
            ASSERT_GT(inspect(refine(mesh, {.scheme = {.kind = scheme}, .levels = 3})).inverted_cells, 0U);
            const FoldCheck check = check_folds(mesh, {.scheme = {.kind = scheme}});
            EXPECT_LT(check.report.proved, mesh.cells.size());
        }
    }
}

// Of the second box a cell is inverted; what was found at the point from the first says nothing of it.
TEST(LinkKind, VerdictsDependOnNeitherOrderNorThreads) {
    HexMesh mesh = touching_boxes(1);
    *std::ranges::find(mesh.points, Vec3(2, 2, 4)) = Vec3(2, 2, 1.5);
    std::optional<FoldReport> first;
    for (const bool turned : {false, true}) {
        if (turned) std::rotate(mesh.cells.begin(), mesh.cells.begin() + 48, mesh.cells.end());
        for (int run = 0; run < 5; ++run) {
            const FoldCheck check = check_folds(mesh, {.scheme = {.kind = Scheme::Bsxw}});
            EXPECT_GT(check.report.folded, 0U);
            if (first) {
                EXPECT_EQ(check.report.proved, first->proved);
                EXPECT_EQ(check.report.folded, first->folded);
            }
            first = check.report;
        }
    }
}

// Balls whose inner points are moved: what is proved does not fold, at places nearer and nearer to irregular points.
TEST(LinkKind, NothingIsProvedFalsely) {
    std::mt19937 dice(5);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const double amount : {0.0, 0.1, 0.2, 0.3}) {
        HexMesh mesh = make_model("ball", 3);
        mesh.attributes.clear();
        std::uniform_real_distribution<double> off(-amount, amount);
        for (Vec3& x : mesh.points) {
            if (glm::length(x) < 0.9) x += Vec3(off(dice), off(dice), off(dice));
        }
        for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
            const FoldCheck check = check_folds(mesh, {.scheme = {.kind = scheme}, .irregular_levels = 5});
            std::vector<LimitQuery> queries;
            for (Index c = 0; c < mesh.cells.size(); ++c) {
                if (check.verdicts[c] != FoldVerdict::Proved) continue;
                for (int k = 0; k < 40; ++k) {
                    const double size = std::ldexp(1, -static_cast<int>(dice() % 8));
                    Vec3 place(0.0);
                    for (int a = 0; a < 3; ++a) {
                        const double x = size * unit(dice);
                        place[a] = dice() % 2 == 0 ? x : 1 - x;
                    }
                    queries.push_back({c, place});
                }
            }
            EXPECT_TRUE(amount > 0.15 || check.report.proved == mesh.cells.size());
            for (const Mat3& j : evaluate_limit(mesh, queries, {.scheme = {.kind = scheme}, .tolerance = 1e-9}).jacobians) {
                EXPECT_GT(glm::determinant(j), 0);
            }
        }
    }
}

}  // namespace link_kind_test
}  // namespace subvol::detail
