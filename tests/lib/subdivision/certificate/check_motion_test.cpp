// SPDX-License-Identifier: Apache-2.0
// Folds between two meshes. Affine motions have determinants in closed form: det((1 − t) 1 + t A) at time t.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/certificate.h"
#include "subvol/limit.h"
#include "subvol/mesh_motion.h"
#include "subvol/model.h"

namespace subvol {
namespace check_motion_test {

using test::error_of;
using test::make_box;
using testing::HasSubstr;

constexpr std::array kSchemes{Scheme::Linear, Scheme::Mcq, Scheme::Bsxw, Scheme::CatmullClark};

Mat3 turned(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {{std::cos(a), std::sin(a), 0}, {-std::sin(a), std::cos(a), 0}, {0, 0, 1}};
}

Mat3 stretched(double x, double y, double z) {
    return {{x, 0, 0}, {0, y, 0}, {0, 0, z}};
}

HexMesh ball() {
    HexMesh mesh = make_model("ball", 4);
    mesh.attributes.clear();
    return mesh;
}

HexMesh moved(HexMesh mesh, const Mat3& a) {
    for (Vec3& x : mesh.points) x = a * x + Vec3(3, -1, 2);
    return mesh;
}

FoldCheck between(const HexMesh& before, const HexMesh& after, Scheme scheme, int time_levels = 5) {
    FoldMotionOptions options;
    options.folds.scheme.kind = scheme;
    options.time_levels = time_levels;
    return check_folds_between(before, after, options);
}

// The least determinant at places in proved cells at times, by the evaluator.
double least_of_proved(const HexMesh& before, const HexMesh& after, const FoldCheck& check, Scheme scheme, std::size_t places) {
    std::vector<Index> proved;
    for (Index c = 0; c < check.verdicts.size(); ++c) {
        if (check.verdicts[c] == FoldVerdict::Proved) proved.push_back(c);
    }
    std::mt19937 dice(4);
    std::uniform_real_distribution<double> from_0_to_1(0, 1);
    double least = 1;
    constexpr int kTimes = 12;
    for (int k = 0; k <= kTimes && !proved.empty(); ++k) {
        const HexMesh mesh = mesh_between(before, after, k == 0 || k == kTimes ? k / kTimes : from_0_to_1(dice));
        std::vector<LimitQuery> queries;
        for (std::size_t p = 0; p < places; ++p)
            queries.push_back({proved[p % proved.size()], {from_0_to_1(dice), from_0_to_1(dice), from_0_to_1(dice)}});
        for (const Mat3& j : evaluate_limit(mesh, queries, {.scheme = {.kind = scheme}, .tolerance = 1e-7}).jacobians)
            least = std::min(least, glm::determinant(j));
    }
    return least;
}

TEST(CheckMotion, AffineMotionsThatDoNotFoldAreProved) {
    for (const Mat3& a : {turned(30), turned(120), turned(170), stretched(2, 3, .5), turned(60) * stretched(.1, 1, 4)}) {
        for (const Scheme scheme : kSchemes) {
            const HexMesh box = make_box(4, 4, 4);
            EXPECT_EQ(between(box, moved(box, a), scheme).report.proved, box.cells.size());
        }
    }
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        EXPECT_EQ(between(ball(), moved(ball(), turned(60) * stretched(.4, 1, 2)), scheme).report.proved, ball().cells.size());
    }
}

// Along irregular edges: their rings and all levels below move with the points.
TEST(CheckMotion, BendsAreProvedAtIrregularEdges) {
    HexMesh bent = ball();
    constexpr double kBend = .3;  // per unit of z
    for (Vec3& x : bent.points) x = {(2 + x.x) * std::cos(kBend * x.z) - 2, x.y, (2 + x.x) * std::sin(kBend * x.z)};
    const FoldCheck check = between(ball(), bent, Scheme::Bsxw);
    EXPECT_EQ(check.report.folded, 0U);
    EXPECT_EQ(check.report.undecided_kinds[static_cast<std::size_t>(UndecidedKind::IrregularEdge)], 0U);
    EXPECT_LE(check.report.open + check.report.irregular, 32U);  // at the eight points where edges meet
    EXPECT_GT(least_of_proved(ball(), bent, check, Scheme::Bsxw, 500), 0);
}

// With −2 and −3 along two axes both ends are sound, and the determinant (1 − 3t)(1 − 4t) is below 0 from 1/4 to 1/3.
TEST(CheckMotion, AFoldBetweenSoundMeshesHasItsTimeAndPlace) {
    const Mat3 a = stretched(-2, -3, 1);
    for (const HexMesh& mesh : {make_box(4, 4, 4), ball()}) {
        const HexMesh after = moved(mesh, a);
        for (const Scheme scheme : kSchemes) {
            if (scheme == Scheme::Mcq && mesh.cells.size() != 64) continue;  // most of its cells are irregular
            const FoldCheck check = between(mesh, after, scheme);
            EXPECT_EQ(check.report.folded, mesh.cells.size());
            EXPECT_EQ(check.report.open_volume + check.report.irregular_volume, 0);
            ASSERT_EQ(check.places.size(), mesh.cells.size());
            EXPECT_TRUE(std::ranges::is_sorted(check.places, {}, &FoldPlace::cell));
            for (const FoldPlace& at : check.places) {
                EXPECT_LT((1 - 3 * at.time) * (1 - 4 * at.time), 0);
                EXPECT_LT(at.determinant, 0);
            }
            const FoldPlace& at = check.places.front();
            const HexMesh then = mesh_between(mesh, after, at.time);
            const LimitSamples there = evaluate_limit(then, std::vector<LimitQuery>{{at.cell, at.uvw}},
                                                      {.scheme = {.kind = scheme}, .tolerance = 1e-7});
            EXPECT_LT(glm::distance(there.positions[0], at.position), 1e-6);
        }
    }
}

// Half a turn passes a determinant of (1 − 2t)², which is 0 at one time and never below it.
TEST(CheckMotion, ADeterminantOfZeroIsNeitherProvedNorFolded) {
    const HexMesh box = make_box(2, 2, 2);
    const FoldCheck check = between(box, moved(box, stretched(-1, -1, 1)), Scheme::Linear);
    EXPECT_EQ(check.report.open, box.cells.size());
    EXPECT_EQ(check.report.undecided_kinds[static_cast<std::size_t>(UndecidedKind::Regular)], box.cells.size());
    // The two stretches of time beside it.
    EXPECT_NEAR(check.report.open_volume, 2.0 / 32 * static_cast<double>(box.cells.size()), 1e-12);
    EXPECT_NEAR(between(box, moved(box, stretched(-1, -1, 1)), Scheme::Linear, 7).report.open_volume, 2.0 / 128 * 8, 1e-12);
}

TEST(CheckMotion, NothingIsProvedFalsely) {
    std::size_t proved = 0, folded = 0;
    for (const unsigned seed : {1U, 2U}) {
        for (const Scheme scheme : kSchemes) {
            for (const HexMesh& mesh : {make_box(4, 4, 4), ball()}) {
                const bool is_ball = mesh.cells.size() != 64;
                if (scheme == Scheme::Mcq && (is_ball || seed > 1)) continue;
                HexMesh before = mesh, after = mesh;
                const double size = is_ball ? .1 : .3;
                test::jitter(before, size, seed);
                test::jitter(after, size, seed + 10);
                for (Vec3& x : after.points) x = turned(40.0 * seed) * Vec3(x.x + .1 * x.y * x.z, x.y, x.z);
                const FoldCheck check = between(before, after, scheme, 3);
                EXPECT_EQ(check.report.proved + check.report.folded + check.report.open + check.report.irregular,
                          mesh.cells.size());
                proved += check.report.proved;
                folded += check.report.folded;
                constexpr double kEvaluated = 5e-3;
                EXPECT_GT(least_of_proved(before, after, check, scheme, 500), -kEvaluated);
                for (const FoldPlace& at : check.places) {
                    const HexMesh then = mesh_between(before, after, at.time);
                    const LimitSamples there = evaluate_limit(then, std::vector<LimitQuery>{{at.cell, at.uvw}},
                                                              {.scheme = {.kind = scheme}, .tolerance = 1e-7});
                    EXPECT_NEAR(glm::determinant(there.jacobians[0]), at.determinant, .02 + .05 * std::abs(at.determinant));
                }
            }
        }
    }
    EXPECT_GT(proved, 300U);
    EXPECT_GT(folded, 10U);
}

// Points at rest are checked as a mesh is, but for samples.
TEST(CheckMotion, WhatDoesNotMoveHasTheVerdictsOfTheMesh) {
    for (const Scheme scheme : kSchemes) {
        const HexMesh mesh = ball();
        const FoldCheck still = check_folds(mesh, {.scheme = {.kind = scheme}}), check = between(mesh, mesh, scheme);
        EXPECT_EQ(check.verdicts, still.verdicts);
        EXPECT_EQ(check.report.undecided_kinds, still.report.undecided_kinds);
    }
}

TEST(CheckMotion, OtherCellsAreRefused) {
    HexMesh other = make_box(2, 2, 2);
    std::swap(other.cells[0], other.cells[1]);
    EXPECT_THAT(error_of([&] { (void)check_folds_between(make_box(2, 2, 2), other); }), HasSubstr("differ"));
    EXPECT_THAT(error_of([&] { (void)check_folds_between(make_box(2, 2, 2), make_box(2, 2, 2), {.time_levels = 11}); }),
                HasSubstr("time_levels"));
}

}  // namespace check_motion_test
}  // namespace subvol
