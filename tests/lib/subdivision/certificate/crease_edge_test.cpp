// SPDX-License-Identifier: Apache-2.0
// Edges of the boundary, refined again and again about one place: what docs/folds.md says of creases.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "subvol/certificate.h"
#include "subvol/option.h"
#include "subvol/refine.h"

namespace subvol::detail {
namespace crease_edge_test {

constexpr double kPi = 3.14159265358979323846;

// Sectors of cells about an edge of the boundary, in layers along it; the first and the last sector have a side on the
// boundary.
class Wedge {
public:
    static constexpr int kReach = 8, kLayers = 8, kMiddle = kLayers / 2;

    Wedge(std::size_t sectors, bool is_crease, Scheme scheme) : sectors_(sectors) {
        for (std::size_t s = 0; s < sectors; ++s) {
            for (int i = 0; i <= kReach; ++i) {
                for (int j = 0; j <= kReach; ++j) {
                    for (int l = 0; l <= kLayers; ++l) numbers_.try_emplace(key(s, i, j, l), numbers_.size());
                }
            }
        }
        mesh_.points = points(kPi);
        for (std::size_t s = 0; s < sectors; ++s) {
            for (int i = 0; i < kReach; ++i) {
                for (int j = 0; j < kReach; ++j) {
                    for (int l = 0; l < kLayers; ++l) {
                        std::array<Index, 8> cell{};
                        for (std::size_t k = 0; k < 8; ++k) {
                            const int u = k % 4 == 1 || k % 4 == 2 ? 1 : 0, v = k % 4 >= 2 ? 1 : 0, w = k >= 4 ? 1 : 0;
                            cell[k] = number(s, i + u, j + v, l + w);
                        }
                        mesh_.cells.push_back(cell);
                    }
                }
            }
        }
        for (int l = 0; is_crease && l < kLayers; ++l) mesh_.creases.push_back({number(0, 0, 0, l), number(0, 0, 0, l + 1)});
        // Points of the next level lie at the same places in all schemes' numbering.
        const HexMesh halved = refine(mesh_, {.scheme = {.kind = Scheme::Linear}, .levels = 1});
        std::map<std::array<long, 3>, std::size_t> at;
        const auto rounded = [](const Vec3& x) {
            return std::array{std::lround(x.x * 1e6), std::lround(x.y * 1e6), std::lround(x.z * 1e6)};
        };
        for (std::size_t p = 0; p < halved.points.size(); ++p) at[rounded(halved.points[p])] = p;
        picked_.resize(numbers_.size());
        const Vec3 middle(0, 0, kMiddle);
        for (std::size_t p = 0; p < picked_.size(); ++p) picked_[p] = at.at(rounded(middle + 0.5 * (mesh_.points[p] - middle)));
        tables_ = refinement_tables(build_topology(mesh_), {.scheme = {.kind = scheme}, .levels = 1});
    }

    [[nodiscard]] Index number(std::size_t s, int i, int j, int l) const {
        return static_cast<Index>(numbers_.at(key(s, i, j, l)));
    }

    // Straight sides that meet at an inner angle, all sectors alike.
    [[nodiscard]] std::vector<Vec3> points(double angle) const {
        std::vector<Vec3> result(numbers_.size());
        for (std::size_t s = 0; s < sectors_; ++s) {
            const double a = angle * static_cast<double>(s) / static_cast<double>(sectors_),
                         b = angle * static_cast<double>(s + 1) / static_cast<double>(sectors_);
            for (int i = 0; i <= kReach; ++i) {
                for (int j = 0; j <= kReach; ++j) {
                    for (int l = 0; l <= kLayers; ++l) {
                        result[number(s, i, j, l)] = {i * std::cos(a) + j * std::cos(b), i * std::sin(a) + j * std::sin(b),
                                                      static_cast<double>(l)};
                    }
                }
            }
        }
        return result;
    }

    // The points of the next level about the middle of the edge, as the same wedge.
    [[nodiscard]] std::vector<Vec3> next(const std::vector<Vec3>& points) const {
        std::vector<double> values;
        for (const Vec3& x : points) values.insert(values.end(), {x.x, x.y, x.z});
        const std::vector<double> finer = tables_.apply(std::span<const double>(values), 3);
        std::vector<Vec3> result;
        for (const std::size_t p : picked_) result.emplace_back(finer[3 * p], finer[3 * p + 1], finer[3 * p + 2]);
        return result;
    }

    // Of the middle layer, beside the edge's point: i steps along spoke s, j along the next one.
    [[nodiscard]] Vec3 beside(const std::vector<Vec3>& points, std::size_t s, int i, int j) const {
        return points[number(s, i, j, kMiddle)] - points[number(0, 0, 0, kMiddle)];
    }

    [[nodiscard]] HexMesh mesh(double angle) const {
        HexMesh result = mesh_;
        result.points = points(angle);
        return result;
    }

private:
    static std::array<int, 4> key(std::size_t s, int i, int j, int l) {
        const auto sector = static_cast<int>(s);
        if (i == 0 && j == 0) return {0, 0, 0, l};
        if (i == 0) return {sector + 1, j, 0, l};
        return {sector, i, j, l};
    }

    std::size_t sectors_;
    std::map<std::array<int, 4>, std::size_t> numbers_;
    HexMesh mesh_;
    RefinementTables tables_;
    std::vector<std::size_t> picked_;
};

double degrees(double angle) {
    return angle * kPi / 180;
}

// With tangents a and b of the two sides, the point between them is moved by (a + b) / 6 or −(a + b) / 32 of a cell at each
// level, without end: ½ is an eigenvalue with a Jordan block.
TEST(CreaseEdge, InnerTangentsOfTwoCellsGrowAtEachLevel) {
    constexpr std::array<std::pair<Scheme, double>, 3> kRates{
        {{Scheme::CatmullClark, 1 / 6.}, {Scheme::Bsxw, 1 / 6.}, {Scheme::Mcq, -1 / 32.}}};
    for (const auto& [scheme, rate] : kRates) {
        const Wedge wedge(2, true, scheme);
        for (const double angle : {120., 180., 240.}) {
            std::vector<Vec3> points = wedge.points(degrees(angle));
            double scale = 1;
            for (int level = 0; level < 30; ++level) points = wedge.next(points), scale *= 2;
            const Vec3 before = scale * wedge.beside(points, 1, 1, 0);
            const Vec3 a = scale * wedge.beside(points, 0, 1, 0), b = scale * wedge.beside(points, 1, 0, 1);
            const Vec3 after = 2 * scale * wedge.beside(wedge.next(points), 1, 1, 0);
            EXPECT_LT(glm::length(after - before - rate * (a + b)), 1e-6) << name_of(scheme) << ' ' << angle;
            EXPECT_NEAR(glm::length(a + b), 2 * std::abs(std::cos(degrees(angle / 2))), 1e-6);
        }
    }
}

// Grids that meet at a right angle stay as they are, but what a middle sector differs from one grows by 2 λ at each level, λ =
// .58 as of six cells inside.
TEST(CreaseEdge, ThreeCellsAreOnTheBorderAtTheirRightAngles) {
    const double cosine = std::cos(kPi / 3), rate = (5 + cosine + std::sqrt((1 + cosine) * (9 + cosine))) / 16;
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw}) {
        const Wedge wedge(3, true, scheme);
        for (const double angle : {240., 270., 300.}) {
            std::vector<Vec3> points = wedge.points(degrees(angle));
            double scale = 1;
            for (int level = 0; level < 40; ++level) points = wedge.next(points), scale *= 2;
            const Vec3 middle(std::cos(degrees(angle / 2)), std::sin(degrees(angle / 2)), 0);
            const double before = scale * glm::dot(middle, wedge.beside(points, 1, 1, 1));
            const double after = 2 * scale * glm::dot(middle, wedge.beside(wedge.next(points), 1, 1, 1));
            if (angle == 270) {
                EXPECT_NEAR(before, std::sqrt(2.0), 1e-9);
                EXPECT_NEAR(after, std::sqrt(2.0), 1e-9);
            } else {
                EXPECT_NEAR(after / before, 2 * rate, 0.01) << angle;
                EXPECT_EQ(after > 0, angle < 270) << angle;
            }
        }
    }
}

// A smooth boundary with three cells at an edge has simple eigenvalues: its middle follows λ = .58, the sides ½.
TEST(CreaseEdge, SmoothEdgesOfThreeCellsHaveNoBlock) {
    const double cosine = std::cos(kPi / 3), rate = (5 + cosine + std::sqrt((1 + cosine) * (9 + cosine))) / 16;
    const Wedge wedge(3, false, Scheme::CatmullClark);
    std::vector<Vec3> points = wedge.points(kPi);
    for (int level = 0; level < 40; ++level) points = wedge.next(points);
    const std::vector<Vec3> after = wedge.next(points);
    EXPECT_NEAR(wedge.beside(after, 1, 1, 1).y / wedge.beside(points, 1, 1, 1).y, rate, 1e-9);
    EXPECT_NEAR(wedge.beside(after, 0, 1, 0).x / wedge.beside(points, 0, 1, 0).x, 0.5, 1e-9);
}

TEST(CreaseEdge, WhatIsTurnedOverIsFoundOrLeftUndecided) {
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw}) {
        const Wedge two(2, true, scheme), three(3, true, scheme);
        const auto check = [&](const Wedge& wedge, double angle) {
            return check_folds(wedge.mesh(degrees(angle)), {.scheme = {.kind = scheme}}).report;
        };
        EXPECT_GT(check(two, 240).folded, 0U);
        EXPECT_GT(check(three, 300).folded, 0U);
        const FoldReport hardly = check(two, 190);
        EXPECT_EQ(hardly.undecided_kinds[static_cast<std::size_t>(UndecidedKind::BoundaryEdge)],
                  2U * Wedge::kLayers);  // those at the edge
        EXPECT_EQ(hardly.proved + hardly.irregular, static_cast<std::size_t>(2 * 8 * 8 * 8));
    }
}

}  // namespace crease_edge_test
}  // namespace subvol::detail
