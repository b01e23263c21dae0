// SPDX-License-Identifier: Apache-2.0
#include "subvol/part_of_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/limit.h"
#include "subvol/measure.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/region.h"

namespace subvol {
namespace part_of_limit_test {

using Flags = std::vector<std::uint8_t>;

template <class In>
Flags cells_with(const HexMesh& mesh, const In& in) {
    Flags flags;
    for (const auto& cell : mesh.cells) {
        Vec3 middle(0.0);
        for (const Index p : cell) middle += mesh.points[p] / 8.0;
        flags.push_back(in(middle));
    }
    return flags;
}

Flags others(Flags flags) {
    for (auto& flag : flags) flag = flag == 0;
    return flags;
}

void add_field(HexMesh& mesh) {
    Attribute field{"f", 1, {}};
    for (const Vec3& p : mesh.points) field.values.push_back(std::sin(2 * p.x) + p.y * p.z);
    mesh.attributes = {field};
}

/// A box of 8×3×3 cells with what is computed from it, bent by a quarter of a circle: its cells keep their numbers.
HexMesh bent_bar() {
    HexMesh mesh = test::make_box(8, 3, 3);
    for (Vec3& p : mesh.points) {
        const double angle = p.x / 8 * std::numbers::pi / 2, radius = 2 - p.y / 3;
        p = Vec3(radius * std::cos(angle), radius * std::sin(angle), p.z / 3);
    }
    add_field(mesh);
    return mesh;
}

/// The largest distance, as a part of the diagonal, between the limits of a part and of the whole at random places in all cells
/// of the part: both by the evaluator of the limit, which refines neither.
double farthest(const HexMesh& whole, const Flags& cells, const PartOfLimit& part) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in_cell(0, 1);
    std::vector<LimitQuery> of_whole, of_part;
    Index number = 0;
    for (Index c = 0; c < cells.size(); ++c) {
        if (cells[c] == 0) continue;
        for (int k = 0; k < 6; ++k) {
            Vec3 at(in_cell(random), in_cell(random), in_cell(random));
            if (k < 3) at[k] = std::round(at[k]);  // on a side
            of_whole.push_back({c, at});
            Index descendant = number;
            for (int level = 0; level < part.levels; ++level) {
                std::array<int, 3> half{};
                for (int axis = 0; axis < 3; ++axis) {
                    half[static_cast<std::size_t>(axis)] = at[axis] >= .5 ? 1 : 0;
                    at[axis] = 2 * at[axis] - (at[axis] >= .5 ? 1 : 0);
                }
                const auto corner = std::ranges::find(kCornerParameters, half) - kCornerParameters.begin();
                descendant = 8 * descendant + static_cast<Index>(corner);
            }
            of_part.push_back({descendant, at});
        }
        ++number;
    }
    const LimitSamples there = evaluate_limit(whole, of_whole), here = evaluate_limit(part.mesh, of_part);
    double most = 0;
    for (std::size_t q = 0; q < of_whole.size(); ++q)
        most = std::max(most, glm::distance(there.positions[q], here.positions[q]));
    return most / bounds(part.mesh).diagonal();
}

TEST(PartOfLimit, EdgesAreSharpWhereTheCutBendsInTheWhole) {
    const HexMesh box = test::make_box(4, 4, 2);
    const auto edges = [&](const auto& in) { return only_cells(box, cells_with(box, in)).creases.size(); };
    EXPECT_EQ(edges([](const Vec3& p) { return p.x < 2; }), 0u);             // a plane: the edges around it are of single cells
    EXPECT_EQ(edges([](const Vec3& p) { return p.x < 2 && p.y < 2; }), 0u);  // a corner
    EXPECT_EQ(edges([](const Vec3& p) { return p.x < 2 || p.y < 2; }), 2u);  // a re-entrant edge of two cells' height
    EXPECT_EQ(edges([](const Vec3& p) { return p.y + p.x < 4; }), 2u * 2);   // stairs: two re-entrant edges
    EXPECT_EQ(edges([](const Vec3&) { return true; }), 0u);
    // A cut that bends by 90 degrees at the points, but runs on smoothly in the limit: there are two cells on both sides.
    HexMesh bent = box;
    for (Vec3& p : bent.points) p.y += std::abs(p.x - 2);
    EXPECT_TRUE(only_cells(bent, cells_with(box, [](const Vec3& p) { return p.y < 2; })).creases.empty());
}

TEST(PartOfLimit, LiesWhereItIsInTheWhole) {
    HexMesh ball = make_model("ball", 4);
    add_field(ball);
    const HexMesh bar = bent_bar(), box = test::make_box(8, 3, 3);
    const std::vector<std::pair<const HexMesh*, Flags>> parts{
        {&ball, cells_with(ball, [](const Vec3& p) { return p.x > 0; })},
        {&ball, cells_with(ball, [](const Vec3& p) { return .6 * p.x + .5 * p.y + .62 * p.z > .1; })},
        {&ball, cells_with(ball, [](const Vec3& p) { return glm::length(p) < .6; })},
        {&bar, cells_with(box, [](const Vec3& p) { return p.x < 4; })},
        {&bar, cells_with(box, [](const Vec3& p) { return p.x + 2 * p.y < 7; })}};
    for (std::size_t k = 0; k < parts.size(); ++k) {
        for (const Flags& cells : {parts[k].second, others(parts[k].second)}) {
            const HexMesh& whole = *parts[k].first;
            const PartOfLimit part = part_of_limit(whole, cells);
            EXPECT_EQ(part.mesh.cells.size(), static_cast<std::size_t>(std::ranges::count(cells, 1)) << (3 * part.levels)) << k;
            const double found = farthest(whole, cells, part);
            // It was compared half way between the points; elsewhere it may be a little farther.
            EXPECT_LE(found, 1.5 * std::max(part.distance_world / bounds(part.mesh).diagonal(), 1e-9)) << k;
            const double said = part.distance_world / bounds(part.mesh).diagonal();
            EXPECT_TRUE(said <= 1e-3 || part.levels == 2) << k << ": it was not refined until it is near";
            EXPECT_LE(said, 2.5e-3) << k << ": with two levels";
            EXPECT_LE(part.field_change, .01) << k;
            // By integrals over the limit of the whole mesh.
            const double volume = measure_limit(whole, {.cells = cells}).whole.volume;
            const double change = measure_limit(part.mesh).whole.volume / volume - 1;
            EXPECT_LE(std::abs(change), 1.5e-3) << k;
            EXPECT_NEAR(part.volume_change, change, 1e-3) << k;  // by straight cells of the next level at the cut
        }
    }
}

TEST(PartOfLimit, SaysHowFarItIsWithoutRefinement) {
    HexMesh ball = make_model("ball", 2);
    const Flags cells = cells_with(ball, [](const Vec3& p) { return .6 * p.x + .5 * p.y + .62 * p.z > .1; });
    const PartOfLimit part = part_of_limit(ball, cells, {.max_levels = 0});
    EXPECT_EQ(part.levels, 0);
    const double off = part.distance_world / bounds(part.mesh).diagonal();
    EXPECT_GT(off, .005);
    EXPECT_NEAR(farthest(ball, cells, part), off, .5 * off);  // as above
    const double volume = measure_limit(ball, {.cells = cells}).whole.volume;
    const double change = measure_limit(part.mesh).whole.volume / volume - 1;
    EXPECT_NEAR(part.volume_change, change, .5 * std::abs(change));  // by cells of the next level
    EXPECT_NE(detail::part_warning(part, OptionNames::Flags), "");
}

TEST(PartOfLimit, RefinedPartsAreThoseOfTheRefinedMesh) {
    const HexMesh bar = bent_bar();
    const Flags cells = cells_with(test::make_box(8, 3, 3), [](const Vec3& p) { return p.x + 2 * p.y < 7; });
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const RefineOptions options{.scheme = {scheme}, .levels = 2};
        const HexMesh fine = refine(bar, options);
        Flags children;
        for (const std::uint8_t flag : cells) children.insert(children.end(), 64, flag);
        const HexMesh part = refined_part(bar, cells, options), cut = only_cells(fine, children);
        ASSERT_EQ(part.cells, cut.cells);
        EXPECT_EQ(part.points, cut.points);
        EXPECT_EQ(part.creases, cut.creases);  // found in the fine mesh, or those of the coarse cut, refined
        EXPECT_FALSE(part.creases.empty());
        EXPECT_EQ(part.attributes.front().values, cut.attributes.front().values);
    }
}

TEST(PartOfLimit, TheWholeIsItself) {
    const HexMesh bar = bent_bar();
    const PartOfLimit part = part_of_limit(bar, Flags(bar.cells.size(), 1));
    EXPECT_EQ(part.mesh.points, bar.points);
    EXPECT_EQ(part.levels, 0);
    EXPECT_EQ(part.distance_world, 0);
}

TEST(PartOfLimit, ErrorsNameWhatWouldBeRight) {
    const HexMesh bar = bent_bar();
    test::expect_error(ErrorCode::InvalidInput, "flags", [&] { std::ignore = part_of_limit(bar, Flags(3, 1)); });
    test::expect_error(ErrorCode::InvalidInput, "levels",
                       [&] { std::ignore = part_of_limit(bar, Flags(bar.cells.size(), 1), {.max_levels = 9}); });
}

}  // namespace part_of_limit_test
}  // namespace subvol
