// SPDX-License-Identifier: Apache-2.0
#include "subvol/stencil_table.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/detail/transposed_table.h"
#include "subvol/error.h"
#include "subvol/refine.h"

namespace subvol {
namespace stencil_table_test {

HexMesh irregular() {
    HexMesh mesh = test::make_nested_cubes(3);
    test::jitter(mesh, .03, 5);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x + p.y) * p.z; });
    return mesh;
}

std::vector<double> coordinates(const HexMesh& mesh) {
    std::vector<double> data;
    for (const Vec3& p : mesh.points) data.insert(data.end(), {p.x, p.y, p.z});
    return data;
}

class EveryTable : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, EveryTable, testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(EveryTable, GivesBitwiseWhatRefineGives) {
    const HexMesh mesh = irregular();
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    const RefinementTables tables = refinement_tables(build_topology(mesh), options);
    const HexMesh fine = refine(mesh, options);
    EXPECT_EQ(tables.apply(std::span<const double>(coordinates(mesh)), 3), coordinates(fine));
    EXPECT_EQ(tables.apply(std::span<const double>(mesh.attributes[0].values), 1), fine.attributes[0].values);
    EXPECT_EQ(tables.cells, fine.cells);
}

TEST_P(EveryTable, HasATranspose) {
    const HexMesh mesh = irregular();
    const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {GetParam()}, .levels = 1});
    const StencilTable& table = tables.levels.front();
    std::vector<double> fine(table.rows() * 2);
    for (std::size_t k = 0; k < fine.size(); ++k) fine[k] = std::sin(static_cast<double>(k));
    std::vector<double> expected(table.columns() * 2, 0);
    const CsrMatrix matrix = table.csr();
    for (std::size_t row = 0; row < table.rows(); ++row) {
        for (std::size_t i = matrix.offsets[row]; i < matrix.offsets[row + 1]; ++i) {
            for (std::size_t c = 0; c < 2; ++c) expected[2 * matrix.columns[i] + c] += matrix.weights[i] * fine[2 * row + c];
        }
    }
    const std::vector<double> sums = detail::apply_transpose(table, fine, 2);
    ASSERT_EQ(sums.size(), expected.size());
    for (std::size_t k = 0; k < sums.size(); ++k) EXPECT_NEAR(sums[k], expected[k], 1e-12);
    EXPECT_THROW((void)detail::apply_transpose(table, fine, 3), Error);
}

TEST_P(EveryTable, ServesAMeshThatMoves) {
    HexMesh mesh = irregular();
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    const RefinementTables tables = refinement_tables(build_topology(mesh), options);
    for (int frame = 0; frame < 3; ++frame) {
        for (auto& p : mesh.points) p += .1 * Vec3(std::sin(3 * p.y + frame), p.x * p.z, std::cos(p.x));
        EXPECT_EQ(tables.apply(std::span<const double>(coordinates(mesh)), 3), coordinates(refine(mesh, options)));
    }
}

TEST_P(EveryTable, TakesAnyNumberOfChannelsInDoubleAndFloat) {
    const HexMesh mesh = irregular();
    const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {GetParam()}, .levels = 2});
    const auto& single = mesh.attributes[0].values;
    const auto one = tables.apply(std::span<const double>(single), 1);
    for (const std::size_t channels : {2u, 3u, 4u, 5u, 7u, 8u}) {
        std::vector<double> many;
        for (const double v : single) {
            for (std::size_t c = 0; c < channels; ++c) many.push_back(v * (1 << c));  // powers of two: exact
        }
        const std::vector<float> many_float(many.begin(), many.end());
        const auto fine = tables.apply(std::span<const double>(many), channels);
        const auto fine_float = tables.apply(std::span<const float>(many_float), channels);
        double worst = 0, worst_float = 0;
        for (std::size_t i = 0; i < fine.size(); ++i) {
            const double expected = one[i / channels] * (1 << i % channels);
            worst = std::max(worst, std::abs(fine[i] - expected));
            worst_float = std::max(worst_float, std::abs(fine_float[i] - expected) / (1 << i % channels));
        }
        EXPECT_EQ(worst, 0) << channels << " channels";
        EXPECT_LT(worst_float, 3e-7);  // values to 1.7: rounded to float at the start and once a level
    }
}

TEST_P(EveryTable, ComposesOverTheControlPoints) {
    const HexMesh mesh = irregular();
    const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {GetParam()}, .levels = 2});
    const StencilTable whole = tables.over_control_points();
    EXPECT_EQ(whole.columns(), mesh.points.size());
    const auto& values = mesh.attributes[0].values;
    const auto stepwise = tables.apply(std::span<const double>(values), 1);
    std::vector<double> at_once(whole.rows());
    whole.apply(std::span<const double>(values), 1, std::span<double>(at_once));
    for (std::size_t i = 0; i < stepwise.size(); ++i) ASSERT_NEAR(at_once[i], stepwise[i], 1e-14);
    const CsrMatrix matrix = whole.csr();
    ASSERT_EQ(matrix.offsets.size(), whole.rows() + 1);
    for (std::size_t r = 0; r < whole.rows(); ++r) {
        double sum = 0, value = 0;
        for (std::size_t i = matrix.offsets[r]; i < matrix.offsets[r + 1]; ++i) {
            ASSERT_TRUE(i == matrix.offsets[r] || matrix.columns[i - 1] < matrix.columns[i]);
            sum += matrix.weights[i];
            value += matrix.weights[i] * values[matrix.columns[i]];
        }
        ASSERT_NEAR(sum, 1, 1e-13);
        ASSERT_NEAR(value, stepwise[r], 1e-13);
    }
}

TEST_P(EveryTable, IsTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = irregular();
    const Topology topology = build_topology(mesh);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return refinement_tables(topology, {.scheme = {GetParam()}, .levels = 2});
    };
    const RefinementTables one = run(1), four = run(4);
    ASSERT_EQ(one.levels.size(), four.levels.size());
    for (std::size_t l = 0; l < one.levels.size(); ++l) {
        ASSERT_EQ(one.levels[l].blocks().size(), four.levels[l].blocks().size());
        for (std::size_t b = 0; b < one.levels[l].blocks().size(); ++b) {
            const auto &x = one.levels[l].blocks()[b], &y = four.levels[l].blocks()[b];
            EXPECT_TRUE(x.points == y.points && x.row_patterns == y.row_patterns && x.runs == y.runs);
        }
    }
}

TEST(StencilTable, SharesPatternsBetweenRegularRows) {
    const RefinementTables tables = refinement_tables(build_topology(test::make_box(20, 20, 20)), {.levels = 1});
    const StencilTable& level = tables.levels[0];
    EXPECT_EQ(level.kept(), 21u * 21u * 21u);
    EXPECT_LT(static_cast<double>(level.bytes()) / static_cast<double>(level.rows()), 32.5 * sizeof(Index))
        << "25 to 36 point ids and hardly more";
    std::size_t patterns = 0;
    for (const auto& block : level.blocks()) patterns = std::max(patterns, block.pattern_offsets.size() - 1);
    EXPECT_LT(patterns, 64u);
}

TEST(StencilTable, LeavesUnusedPointsAlone) {
    HexMesh mesh = test::make_box(2, 1, 1);
    mesh.points.push_back({7, 7, 7});
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
        const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {scheme}, .levels = 2});
        const auto fine = tables.apply(std::span<const double>(coordinates(mesh)), 3);
        EXPECT_EQ(fine[3 * 12], 7);
    }
}

TEST(StencilTable, RefusesDataOfAnotherSize) {
    const RefinementTables tables = refinement_tables(build_topology(test::make_box(1, 1, 1)), {.levels = 1});
    const std::vector<double> seven(7);
    test::expect_error(ErrorCode::InvalidInput, "7 values", [&] { (void)tables.apply(std::span<const double>(seven), 1); });
}

}  // namespace stencil_table_test
}  // namespace subvol
