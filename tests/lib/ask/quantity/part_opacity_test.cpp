// SPDX-License-Identifier: Apache-2.0
#include "subvol/part_opacity.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace part_opacity_test {

TranslucentParts parts_of(const HexMesh& mesh, const std::vector<std::string>& texts, const MeshSets& sets = {}) {
    std::vector<PartOpacity> parts;
    for (const std::string& text : texts) parts.push_back(parse_part_opacity(text));
    return translucent_parts(mesh, parts, sets);
}

TEST(PartOpacity, TakesAPartOutAndLeavesWhatItSharesWithTheRestToThat) {
    const HexMesh mesh = test::make_box(4, 2, 2);
    const TranslucentParts parts = parts_of(mesh, {"half:2,0,0,1,0,0=.25"});
    EXPECT_EQ(parts.rest.cells.size(), 8U);
    EXPECT_EQ(std::ranges::count(parts.cells, 1), 8);
    EXPECT_EQ(parts.shells.quads.size(), 4U + 4U * 4U) << "the end and four sides, not the middle";
    EXPECT_EQ(parts.opacities, std::vector<float>(20, .25F));
    for (const Vec3& p : parts.shells.points) EXPECT_GE(p.x, 2);
}

TEST(PartOpacity, TwoPartsShareTheirSidesOnce) {
    const HexMesh mesh = test::make_box(4, 2, 2);
    const TranslucentParts parts = parts_of(mesh, {"half:2,0,0,1,0,0=.25", "half:2,0,0,-1,0,0=.5"});
    EXPECT_TRUE(parts.rest.cells.empty());
    EXPECT_EQ(std::ranges::count(parts.opacities, .25F), 24) << "with the middle";
    EXPECT_EQ(std::ranges::count(parts.opacities, .5F), 20);
}

TEST(PartOpacity, PartsMayBeLeftOutAndTheLastOneCounts) {
    const HexMesh mesh = test::make_box(4, 2, 2);
    const MeshSets sets{{}, {{"end", {0, 1, 2, 3}}}};
    const std::size_t all = mesh.cells.size();
    const TranslucentParts hidden = parts_of(mesh, {"end=0"}, sets);
    EXPECT_EQ(hidden.rest.cells.size(), all - 4);
    EXPECT_TRUE(hidden.shells.empty());
    EXPECT_EQ(parts_of(mesh, {"block:end=0"}, sets).rest.cells.size(), all - 4);
    EXPECT_EQ(parts_of(mesh, {"end=0", "half:-1,0,0,1,0,0=1"}, sets).rest.cells.size(), all);
}

TEST(PartOpacity, RefusesWhatIsNoPartOrNoOpacity) {
    const HexMesh mesh = test::make_box(2, 1, 1);
    const auto refuses = [&](const char* text, const char* words) {
        test::expect_error(ErrorCode::InvalidInput, words, [&] { (void)parts_of(mesh, {text}); });
    };
    refuses("half:1,0,0,1,0,0", "gives no part an opacity");
    refuses("=.5", "gives no part an opacity");
    refuses("half:1,0,0,1,0,0=1.5", "1.5");
    refuses("half:1,0,0,1,0,0=much", "much");
    refuses("casing=.5", "there is no set \"casing\" (the mesh has no sets of cells and no blocks; a region such as half:");
    test::expect_error(ErrorCode::InvalidInput, "the mesh has: end", [&] {
        (void)parts_of(mesh, {"casing=.5"}, {{}, {{"end", {0}}}});
    });
    refuses("half:-1,0,0,1,0,0=0", "no part is left");
}

}  // namespace part_opacity_test
}  // namespace subvol
