// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "lib/test_meshes.h"
#include "subvol/dense_cells.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/topology.h"

namespace subvol {
namespace limit_pieces_test {

/// A mesh with edges of three and five cells, a boundary with edges and corners, and a kink in its field.
HexMesh irregular() {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .03, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::abs(p.x - 0.3) * p.y + p.z; });
    return mesh;
}

LimitCells pieces_of(const HexMesh& mesh, Scheme scheme = Scheme::Mcq) {
    const Vec3 size = bounds(mesh).size();
    return find_limit_cells(mesh, {.scheme = {scheme}},
                            {.position_world = 5e-4 * std::max({size.x, size.y, size.z}), .max_levels = 4});
}

// Values beside a large constant, and ones that floats do not hold.
TEST(LimitPieces, KeepValuesRelativeToAnOrigin) {
    HexMesh mesh = irregular();
    mesh.attributes.clear();
    test::add_field(mesh, "plain", [](const Vec3& p) { return p.x + p.y * p.z; });
    test::add_field(mesh, "shifted", [](const Vec3& p) { return 1e8 + p.x + p.y * p.z; });
    test::add_field(mesh, "huge", [](const Vec3& p) { return 1e200 * (p.x + p.y * p.z); });
    test::add_field(mesh, "tiny", [](const Vec3& p) { return 1e-200 * (p.x + p.y * p.z); });
    const LimitCells limit = pieces_of(mesh);
    ASSERT_TRUE(limit.pieces);
    const LimitPieces& pieces = *limit.pieces;
    EXPECT_EQ(pieces.value_origins[0], 0);
    EXPECT_EQ(pieces.value_units[0], 1);
    for (std::size_t p = 0; p < pieces.cells.size(); ++p) {
        for (std::size_t n = 0; n < LimitPieces::kNodes; ++n) {
            const double plain = pieces.value(p, n, 0);
            EXPECT_EQ(plain, static_cast<double>(pieces.node(p, n)[3])) << "bits of floats as they were";
            EXPECT_NEAR(pieces.value(p, n, 1) - 1e8, plain, 1e-6);
            EXPECT_NEAR(pieces.value(p, n, 2) / 1e200, plain, 1e-6);
            EXPECT_NEAR(pieces.value(p, n, 3) / 1e-200, plain, 1e-6);
        }
    }
}

TEST(LimitPieces, FillEachCellOnce) {
    const HexMesh mesh = irregular();
    const LimitCells limit = pieces_of(mesh);
    ASSERT_TRUE(limit.pieces);
    const LimitPieces& pieces = *limit.pieces;
    EXPECT_TRUE(std::ranges::is_sorted(pieces.cells));
    EXPECT_EQ(pieces.cells.size(), limit.piece_count);
    EXPECT_GT(std::ranges::max(pieces.levels), 1);
    EXPECT_LT(std::ranges::min(pieces.levels), std::ranges::max(pieces.levels));
    constexpr int kFine = 3;  // eighths of a cell
    std::vector<double> volume(mesh.cells.size());
    std::map<std::array<Index, 4>, int> taken;  // cell and the places of fine cells
    for (std::size_t i = 0; i < pieces.cells.size(); ++i) {
        ASSERT_LE(pieces.levels[i], kFine);
        volume[pieces.cells[i]] += std::ldexp(1.0, -3 * pieces.levels[i]);
        EXPECT_LT(pieces.levels[i], limit.cell_levels[pieces.cells[i]]);
        std::array<Index, 4> lowest{pieces.cells[i]};
        for (std::size_t d = 0; d < 3; ++d) {
            ASSERT_LT(pieces.lowest[i][d], 1 << pieces.levels[i]);
            lowest[d + 1] = static_cast<Index>(pieces.lowest[i][d] << (kFine - pieces.levels[i]));
        }
        EXPECT_EQ(++taken[lowest], 1);
    }
    for (std::size_t c = 0; c < volume.size(); ++c) EXPECT_EQ(volume[c], 1) << c;
}

TEST(LimitPieces, HaveVerticesOnTheLimitAsNodes) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const HexMesh mesh = irregular();
        const LimitCells limit = pieces_of(mesh, scheme);
        ASSERT_TRUE(limit.pieces);
        const LimitPieces& pieces = *limit.pieces;
        const int finest = std::ranges::max(limit.cell_levels);
        std::vector<std::vector<Vec3>> points(mesh.cells.size());
        std::vector<std::vector<double>> values(mesh.cells.size());
        for_each_dense_cell(mesh, {.scheme = {scheme}, .levels = finest}, {.on_limit = true}, [&](const DenseCell& cell) {
            points[cell.cell].assign(cell.points.begin(), cell.points.end());
            values[cell.cell].assign(cell.values[0].begin(), cell.values[0].end());
        });
        const std::size_t side = (std::size_t{1} << finest) + 1;
        double most = 0, most_of_value = 0;
        for (std::size_t i = 0; i < pieces.cells.size(); ++i) {
            const std::size_t step = std::size_t{1} << (finest - pieces.levels[i] - 1);
            for (std::size_t n = 0; n < 27; ++n) {
                const std::array<std::size_t, 3> at{n % 3, n / 3 % 3, n / 9};
                std::size_t node = 0;
                for (std::size_t d = 3; d-- > 0;) node = node * side + step * (2 * pieces.lowest[i][d] + at[d]);
                most = std::max(most, glm::length(pieces.position(i, n) - points[pieces.cells[i]][node]));
                most_of_value = std::max(most_of_value, std::abs(pieces.node(i, n)[3] - values[pieces.cells[i]][node]));
            }
        }
        EXPECT_LT(most, 1e-7);  // nodes are 32-bit floats relative to the first one
        EXPECT_LT(most_of_value, 1e-6);
    }
}

TEST(LimitPieces, DoNotDependOnThreads) {
    const HexMesh mesh = make_model("ball", 5);
    LimitCells by_one;
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        by_one = pieces_of(mesh);
    }
    const LimitCells by_all = pieces_of(mesh);
    EXPECT_EQ(by_one.cell_levels, by_all.cell_levels);
    EXPECT_EQ(by_one.position_world, by_all.position_world);
    EXPECT_EQ(by_one.pieces->levels, by_all.pieces->levels);
    EXPECT_EQ(by_one.pieces->lowest, by_all.pieces->lowest);
    EXPECT_TRUE(by_one.pieces->nodes == by_all.pieces->nodes);
    EXPECT_EQ(by_one.pieces->mesh_hash, by_all.pieces->mesh_hash);
}

// More cells than are looked at together: their pieces come in several parts, which are those that are kept.
TEST(LimitPieces, AreTheSameOnTheWay) {
    const HexMesh mesh = make_model("twist", 42);
    const LimitCellsOptions options{.position_world = 1e-3};
    const LimitCells kept = find_limit_cells(mesh, {}, options);
    ASSERT_TRUE(kept.pieces);
    std::size_t first = 0, parts = 0;
    bool same = true;
    const LimitCells passed = visit_limit_pieces(mesh, {}, options, [&](const LimitPieces& pieces) {
        ++parts;
        const std::size_t numbers = LimitPieces::kNodes * pieces.node_size;
        for (std::size_t i = 0; i < pieces.cells.size(); ++i) {
            const std::size_t k = first + i;
            same = same && k < kept.piece_count && pieces.cells[i] == kept.pieces->cells[k] &&
                   pieces.levels[i] == kept.pieces->levels[k] && pieces.lowest[i] == kept.pieces->lowest[k] &&
                   pieces.hull_sides[i] == kept.pieces->hull_sides[k] &&
                   std::equal(pieces.node(i, 0), pieces.node(i, 0) + numbers, kept.pieces->node(k, 0));
        }
        first += pieces.cells.size();
    });
    EXPECT_TRUE(same);
    EXPECT_GT(parts, 1u);
    EXPECT_EQ(first, kept.piece_count);
    EXPECT_EQ(passed.piece_count, kept.piece_count);
    EXPECT_EQ(passed.cell_levels, kept.cell_levels);
    EXPECT_EQ(passed.level, kept.level);
    EXPECT_EQ(passed.position_world, kept.position_world);
    EXPECT_EQ(passed.value_of_range, kept.value_of_range);
    EXPECT_TRUE(passed.converged);
    EXPECT_FALSE(passed.pieces);
}

// The sides of pieces on the hull are quarters of faces, or quarters of those: together they are the faces of the hull.
TEST(LimitPieces, CoverTheHull) {
    const HexMesh mesh = irregular();
    const LimitCells limit = pieces_of(mesh);
    ASSERT_TRUE(limit.pieces);
    EXPECT_GT(std::ranges::max(limit.pieces->levels), 0);
    double faces = 0;
    for (std::size_t p = 0; p < limit.piece_count; ++p) {
        faces += std::ldexp(std::popcount(limit.pieces->hull_sides[p]), -2 * limit.pieces->levels[p]);
    }
    const Topology topology = build_topology(mesh);
    const auto on_hull = std::ranges::count_if(topology.face_cells, [](const auto& cells) { return cells[1] == kNone; });
    EXPECT_EQ(faces, static_cast<double>(on_hull));
}

TEST(LimitPieces, DoNotDependOnTheOrderOfCells) {
    const HexMesh mesh = irregular();
    HexMesh reversed = mesh;
    std::ranges::reverse(reversed.cells);
    const LimitCells a = pieces_of(mesh), b = pieces_of(reversed);
    EXPECT_EQ(a.piece_count, b.piece_count);
    EXPECT_NEAR(a.position_world, b.position_world, 1e-12);
    EXPECT_NEAR(a.value_of_range, b.value_of_range, 1e-12);
    EXPECT_TRUE(std::ranges::equal(a.cell_levels, std::vector(b.cell_levels.rbegin(), b.cell_levels.rend())));
}

TEST(LimitPieces, BelongToOneMesh) {
    const HexMesh mesh = irregular();
    const LimitCells limit = pieces_of(mesh);
    EXPECT_TRUE(are_pieces_of(*limit.pieces, mesh));
    EXPECT_EQ(place_in(*limit.pieces, mesh.attributes[0]), 3u);
    HexMesh other = mesh;
    other.attributes[0].values[5] += 1;
    EXPECT_TRUE(are_pieces_of(*limit.pieces, other));
    EXPECT_FALSE(place_in(*limit.pieces, other.attributes[0]));
    other.points[3].z += 1e-9;
    EXPECT_FALSE(are_pieces_of(*limit.pieces, other));
}

TEST(LimitPieces, OfMeshesThatAreNone) {
    EXPECT_TRUE(find_limit_cells({}, {}, {}).converged);
    HexMesh mesh = make_model("twist", 2);
    EXPECT_FALSE(find_limit_cells(mesh, {}, {.max_levels = 0}).converged);
    mesh.cells[3][5] = static_cast<Index>(mesh.points.size()) + 1000;
    EXPECT_THROW((void)find_limit_cells(mesh, {}, {}), Error);
}

}  // namespace limit_pieces_test
}  // namespace subvol
