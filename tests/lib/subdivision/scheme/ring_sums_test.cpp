// SPDX-License-Identifier: Apache-2.0
// Rings of many members, whose rows are made of sums over the ring.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "lib/test_meshes.h"
#include "subvol/refine.h"

namespace subvol {
namespace ring_sums_test {

constexpr double kPi = std::numbers::pi;

/// Two layers of two rings of hexahedra around an axis, whose spokes are `valence` directions. `start` shifts the numbers of
/// the points around the axis, not their places.
HexMesh wheel(Index valence, Index start = 0) {
    HexMesh mesh;
    const Index ring = 4 * valence, layer = 1 + ring;
    for (int z = 0; z < 3; ++z) {
        mesh.points.emplace_back(0, 0, z);
        for (Index i = 0; i < ring; ++i) {
            const Index j = (i / 4 + start) % valence;
            const double half = kPi / valence, r = i % 4 == 0 ? 1 : i % 4 == 1 ? 1.2 : i % 4 == 2 ? 2 : 2.2;
            const double angle = half * (2.0 * j + (i % 2));
            mesh.points.emplace_back(r * std::cos(angle) + .1 * z, r * std::sin(angle), z + .1 * std::cos(2 * angle));
        }
    }
    const auto id = [&](Index j, Index k, Index z) { return z * layer + 1 + 4 * ((j + valence - start) % valence) + k; };
    for (Index z = 0; z < 2; ++z) {
        for (Index j = 0; j < valence; ++j) {
            const Index next = (j + 1) % valence, axis = z * layer;
            const auto add = [&](Index a, Index b, Index c, Index d) {
                mesh.cells.push_back({a, b, c, d, a + layer, b + layer, c + layer, d + layer});
            };
            add(axis, id(j, 0, z), id(j, 1, z), id(next, 0, z));
            add(id(j, 0, z), id(j, 2, z), id(j, 3, z), id(j, 1, z));
            add(id(j, 1, z), id(j, 3, z), id(next, 2, z), id(next, 0, z));
        }
    }
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x + p.y) + p.z; });
    return mesh;
}

std::vector<double> coordinates(const HexMesh& mesh) {
    std::vector<double> data;
    for (const Vec3& p : mesh.points) data.insert(data.end(), {p.x, p.y, p.z});
    return data;
}

// The addition theorem, against rows of all members; what is left is rounding.
TEST(RingSums, GiveThePointsOfRowsOfAllMembers) {
    for (const Index valence : {32u, 61u}) {
        const HexMesh mesh = wheel(valence);
        const RefineOptions options{.levels = 2};
        const RefinementTables tables = refinement_tables(build_topology(mesh), options);
        const HexMesh fine = refine(mesh, options);
        const auto all = tables.apply(std::span<const double>(coordinates(mesh)), 3), sums = coordinates(fine);
        ASSERT_EQ(all.size(), sums.size());
        for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(all[i], sums[i], 1e-13);
        const auto values = tables.apply(std::span<const double>(mesh.attributes[0].values), 1);
        for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], fine.attributes[0].values[i], 1e-13);
    }
}

// A patch has the whole ring, though its cells come in another order; each point has one value.
TEST(RingSums, HaveTheSameBitsInPatches) {
    const HexMesh mesh = wheel(40);
    const RefineOptions options{.levels = 2};
    const HexMesh whole = refine(mesh, options);
    for (const Index cell : {0u, 1u, 57u, 119u, 200u}) {
        const HexMesh part = refine_cells(mesh, std::array{cell}, options);
        ASSERT_EQ(part.cells.size(), 64u);
        for (std::size_t c = 0; c < 64; ++c) {
            for (std::size_t k = 0; k < 8; ++k) {
                EXPECT_EQ(part.points[part.cells[c][k]], whole.points[whole.cells[64 * cell + c][k]]);
            }
        }
    }
}

// Where the counting starts is a matter of the numbers, not of the shape.
TEST(RingSums, DoNotDependOnWhereTheRingIsCountedFrom) {
    const HexMesh first = refine(wheel(48), {.levels = 1}), second = refine(wheel(48, 17), {.levels = 1});
    ASSERT_EQ(first.cells.size(), second.cells.size());
    for (std::size_t c = 0; c < first.cells.size(); ++c) {
        for (std::size_t k = 0; k < 8; ++k) {
            const Vec3 apart = first.points[first.cells[c][k]] - second.points[second.cells[c][k]];
            EXPECT_LT(glm::length(apart), 1e-13);  // rounding
        }
    }
}

// Sums are of differences: what is constant stays constant, and no digits are lost far from the origin.
TEST(RingSums, KeepConstantsAndDigitsFarAway) {
    HexMesh mesh = wheel(64);
    for (double& value : mesh.attributes[0].values) value = 101325;
    const HexMesh near = refine(mesh, {.levels = 1});
    for (const double value : near.attributes[0].values) EXPECT_NEAR(value, 101325, 1e-10);  // its roundings
    const Vec3 far(5e6, 4e6, 0);
    for (Vec3& p : mesh.points) p += far;
    const HexMesh moved = refine(mesh, {.levels = 1});
    for (std::size_t p = 0; p < near.points.size(); ++p) {
        EXPECT_LT(glm::length(moved.points[p] - far - near.points[p]), 2e-8);  // a place there has 1e-9
    }
}

TEST(RingSums, AreTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = wheel(100);
    const HexMesh many = refine(mesh, {.levels = 2});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(coordinates(many), coordinates(refine(mesh, {.levels = 2})));
}

}  // namespace ring_sums_test
}  // namespace subvol
