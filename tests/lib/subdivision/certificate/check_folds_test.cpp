// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/certificate.h"
#include "subvol/detail/fold_samples.h"
#include "subvol/limit.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol {
namespace check_folds_test {

using test::error_of;
using test::make_box;
using testing::HasSubstr;

HexMesh rough_box(double amount, unsigned seed, Index side = 7) {
    HexMesh mesh = make_box(side, side, side);
    test::jitter(mesh, amount, seed);
    return mesh;
}

// The least determinant at places in the cells of a verdict, by refinement alone.
double least_determinant(const HexMesh& mesh, const FoldCheck& check, FoldVerdict verdict, std::size_t places,
                         Scheme scheme = Scheme::Mcq) {
    std::vector<Index> cells;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (check.verdicts[c] == verdict) cells.push_back(c);
    }
    if (cells.empty()) return 1;
    std::mt19937 dice(9);
    std::uniform_real_distribution<double> place(0, 1);
    std::vector<LimitQuery> queries;
    for (std::size_t k = 0; k < places; ++k) {
        queries.push_back({cells[k % cells.size()], {place(dice), place(dice), place(dice)}});
    }
    double least = 1;
    for (const Mat3& j : evaluate_limit(mesh, queries, {.scheme = {.kind = scheme}, .tolerance = 1e-7}).jacobians) {
        least = std::min(least, glm::determinant(j));
    }
    return least;
}

constexpr double kEvaluated = 5e-3;  // the error of a determinant that is evaluated by refinement

// Where the places of folds are folded, and nothing that is proved is: boxes of noise that folds few cells to many, with
// boundaries.
TEST(CheckFolds, NothingIsProvedFalsely) {
    constexpr double kSide = 7;  // of `rough_box`
    const double diagonal = kSide * std::sqrt(3.0);
    for (const double amount : {0.1, 0.2, 0.3, 0.4}) {
        const HexMesh mesh = rough_box(amount, 5);
        const FoldCheck check = check_folds(mesh, {.levels = 4, .tests = 600});
        const FoldReport& report = check.report;
        EXPECT_EQ(report.proved + report.folded + report.open, mesh.cells.size());
        EXPECT_EQ(report.irregular, 0u);
        EXPECT_TRUE(amount > 0.15 || report.proved == mesh.cells.size());
        EXPECT_TRUE(amount < 0.35 || report.folded > 0);
        EXPECT_GT(least_determinant(mesh, check, FoldVerdict::Proved, amount == 0.3 ? 100000 : 20000), -kEvaluated);
        for (const FoldPlace& at : check.places) {
            const LimitSamples there = evaluate_limit(mesh, std::vector<LimitQuery>{{at.cell, at.uvw}}, {.tolerance = 1e-9});
            EXPECT_LT(at.determinant, 0);
            EXPECT_NEAR(glm::determinant(there.jacobians[0]), at.determinant, 0.02 + 0.05 * std::abs(at.determinant));
            EXPECT_LT(glm::distance(there.positions[0], at.position), 1e-6 * diagonal);  // the tolerance of `evaluate_limit`
            EXPECT_EQ(check.verdicts[at.cell], FoldVerdict::Folded);
        }
    }
}

// A limit may fold though all corners of the control cells are sound: the reason for a certificate.
TEST(CheckFolds, FoldsByOvershootAreFound) {
    HexMesh mesh = make_box(7, 7, 7);
    for (Vec3& x : mesh.points) {
        if (std::abs(x.x - 3) < 0.1) x.x += 0.85;
        if (std::abs(x.x - 5) < 0.1) x.x -= 0.85;
    }
    ASSERT_EQ(inspect(mesh).inverted_cells, 0u);
    const FoldCheck check = check_folds(mesh);
    EXPECT_GT(check.report.folded, 0u);
    EXPECT_EQ(check_folds(mesh, {.scheme = {.kind = Scheme::Linear}}).report.proved, mesh.cells.size());
    EXPECT_EQ(check_folds(mesh, {.scheme = {.kind = Scheme::CatmullClark}}).report.proved, mesh.cells.size());
}

TEST(CheckFolds, OneTestACellOnSoundMeshes) {
    const FoldCheck twisted = check_folds(make_model("twist", 8));
    EXPECT_EQ(twisted.report.proved, twisted.verdicts.size());
    EXPECT_LE(twisted.report.tests, 2 * twisted.verdicts.size());
    // Neither thin cells nor a place far away need more; of a mirror image nothing is proved.
    HexMesh thin = rough_box(0.05, 3);
    for (Vec3& x : thin.points) x = Vec3(1e7 + x.x, 1000 * x.y, -3e5 + 1e-3 * x.z);
    const FoldCheck far = check_folds(thin);
    EXPECT_EQ(far.report.proved, far.verdicts.size());
    EXPECT_LE(far.report.tests, 2 * far.verdicts.size());
    for (Vec3& x : thin.points) x.x = -x.x;
    EXPECT_EQ(check_folds(thin).report.folded, thin.cells.size());
}

// The axes and hands of cells do not matter, so that each of the ways in which a cell lies at a boundary is the same.
TEST(CheckFolds, TurnedMeshesHaveTheSameVerdicts) {
    const HexMesh mesh = rough_box(0.25, 8, 6);
    const FoldCheck expected = check_folds(mesh, {.levels = 3});
    HexMesh turned = mesh;
    for (auto& cell : turned.cells) cell = {cell[1], cell[2], cell[3], cell[0], cell[5], cell[6], cell[7], cell[4]};
    for (std::size_t c = 0; c < turned.cells.size(); c += 2) {
        const auto cell = turned.cells[c];
        turned.cells[c] = {cell[4], cell[0], cell[3], cell[7], cell[5], cell[1], cell[2], cell[6]};
    }
    const FoldCheck found = check_folds(turned, {.levels = 3});
    EXPECT_EQ(found.verdicts, expected.verdicts);
}

TEST(CheckFolds, SplinesAndTrilinearCellsAreDecided) {
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        for (const double amount : {0.3, 0.6}) {
            const HexMesh mesh = rough_box(amount, 6);
            const FoldCheck check = check_folds(mesh, {.scheme = {.kind = scheme}});
            EXPECT_EQ(check.report.open + check.report.irregular, 0u);
            EXPECT_GT(least_determinant(mesh, check, FoldVerdict::Proved, 20000, scheme), -1e-9);
            EXPECT_TRUE(scheme != Scheme::Linear || amount < 0.5 || check.report.folded > 0);
            for (const FoldPlace& at : check.places) {
                const LimitSamples there =
                    evaluate_limit(mesh, std::vector<LimitQuery>{{at.cell, at.uvw}}, {.scheme = {.kind = scheme}});
                EXPECT_NEAR(glm::determinant(there.jacobians[0]), at.determinant, 1e-6);
            }
        }
    }
}

// At irregular edges cells are refined; of MCQ a tube around the edge stays open, smaller with each level.
TEST(CheckFolds, TubesAtIrregularEdgesStayOpen) {
    const HexMesh mesh = make_model("ball", 4);
    double before = static_cast<double>(mesh.cells.size());
    std::size_t irregular = mesh.cells.size();
    for (int levels = 1; levels < 4; ++levels) {
        const FoldCheck check = check_folds(mesh, {.irregular_levels = levels});
        EXPECT_GT(check.report.irregular, 0u);
        EXPECT_LE(check.report.irregular, irregular);
        irregular = check.report.irregular;
        EXPECT_EQ(check.report.folded + check.report.open, 0u);
        EXPECT_LT(check.report.irregular_volume, 0.8 * before);
        before = check.report.irregular_volume;
        EXPECT_GT(least_determinant(mesh, check, FoldVerdict::Proved, 20000), 0);
    }
    // Boxes of few cells are parts of larger ones after two refinements.
    HexMesh thin = make_box(5, 4, 1);
    test::jitter(thin, 0.05, 2);
    EXPECT_EQ(check_folds(thin).report.proved, thin.cells.size());
    EXPECT_EQ(check_folds(make_box(1, 1, 1)).report.proved, 1u);
}

TEST(CheckFolds, ThreadsDoNotMatter) {
    const HexMesh box = rough_box(0.35, 2), ball = make_model("ball", 3);
    for (const HexMesh* mesh : {&box, &ball}) {
        std::vector<FoldCheck> checks;
        for (const std::size_t threads : {std::size_t{1}, std::size_t{5}}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            checks.push_back(check_folds(*mesh, {.levels = 3}));
        }
        EXPECT_EQ(checks[0].verdicts, checks[1].verdicts);
        EXPECT_EQ(checks[0].open, checks[1].open);
        ASSERT_EQ(checks[0].places.size(), checks[1].places.size());
        for (std::size_t k = 0; k < checks[0].places.size(); ++k) {
            EXPECT_EQ(checks[0].places[k].uvw, checks[1].places[k].uvw);
            EXPECT_EQ(checks[0].places[k].determinant, checks[1].places[k].determinant);
        }
    }
}

TEST(CheckFolds, WhatIsNotProvedIsRefused) {
    const HexMesh mesh = make_box(2, 2, 2);
    EXPECT_THAT(error_of([&] { (void)check_folds(mesh, {.scheme = {.tension = 0.05}}); }), HasSubstr("tension"));
    EXPECT_EQ(check_folds(mesh, {.scheme = {.tension = 0}}).report.proved, 8u);
    EXPECT_THAT(error_of([&] { (void)check_folds(mesh, {.levels = 99}); }), HasSubstr("levels"));
}

// A second evaluator: the corners of the descendants that subdivision makes. All cells of the small ball touch irregular edges.
TEST(CheckFolds, SamplesFindFoldsNearIrregularEdges) {
    HexMesh mesh = make_model("ball", 2);
    mesh.attributes.clear();
    std::mt19937 dice(11);
    std::uniform_real_distribution<double> off(-0.22, 0.22);
    for (Vec3& x : mesh.points) {
        if (!(glm::length(x) < 0.9)) continue;
        for (const int axis : {2, 1, 0}) x[axis] += off(dice);  // in one order, whatever the compiler
    }
    const FoldCheck check = check_folds(mesh);
    const FoldReport::Sampled& sampled = check.report.sampled;
    EXPECT_GT(sampled.folded, 0U);
    EXPECT_LT(sampled.least, 0);
    EXPECT_GE(sampled.cells, check.report.irregular + sampled.folded);
    EXPECT_GE(sampled.places, 100 * sampled.cells);

    constexpr std::size_t kLevels = 4, kDescendants = 4096;
    const HexMesh fine = refine(mesh, {.levels = kLevels});
    // det ∂x/∂u at the corners of a descendant, the edges of which are 1/16 of the cell's
    const auto determinant = [&](std::size_t cell, std::size_t corner) {
        const auto& points = fine.cells[cell];
        const auto& [a, b, c] = kCornerNeighbors[corner];
        const Vec3& x = fine.points[points[corner]];
        return kDescendants *
               glm::dot(fine.points[points[a]] - x, glm::cross(fine.points[points[b]] - x, fine.points[points[c]] - x));
    };
    double mean = 0;
    std::vector<double> least(mesh.cells.size(), std::numeric_limits<double>::infinity());
    for (std::size_t n = 0; n < fine.cells.size(); ++n) {
        for (std::size_t k = 0; k < 8; ++k) {
            const double det = determinant(n, k);
            mean += det / (8.0 * static_cast<double>(fine.cells.size()));
            least[n / kDescendants] = std::min(least[n / kDescendants], det);
        }
    }
    constexpr double kClear =
        0.1;  // of the mean: far more than derivatives change within 1/16 of a cell where they are continuous
    std::size_t confirmed = 0;
    for (const FoldPlace& at : check.places) {
        if (!at.sampled) continue;
        EXPECT_LT(at.determinant, 0);
        if (at.determinant > -kClear * mean) continue;
        ++confirmed;
        EXPECT_LT(least[at.cell], 0) << at.cell;
    }
    EXPECT_GT(confirmed, 0U);
    for (std::size_t c = 0; c < least.size(); ++c) {
        if (least[c] < -kClear * mean) EXPECT_EQ(check.verdicts[c], FoldVerdict::Folded) << c;
    }
}

// A cell that is thin at its last corners and folds elsewhere, as 25³ of its places show in numpy: the least of these
// determinants is −.00382, while the smallest of the first places is positive and lies at the thin end.
TEST(SampleFolds, FindsAFoldFarFromWhereACellIsThin) {
    HexMesh mesh;
    mesh.points = {{.24, .17, -.39},  {.58, .3, .07}, {.66, 1.1, .58}, {.41, 1.02, -.19},
                   {.44, -.46, 1.21}, {.51, .92, .8}, {.5, 1.05, .78}, {.38, 1.04, .83}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
    const std::vector<Index> cells{0};
    const detail::CellSamples found = detail::sample_folds(mesh, cells, {.kind = Scheme::Linear}, nullptr).at(0);
    EXPECT_LT(found.least.determinant, -0.0037);
    EXPECT_GT(found.least.determinant, -0.00383);
}

}  // namespace check_folds_test
}  // namespace subvol
