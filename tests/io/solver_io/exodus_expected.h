// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>

#include "exodus_texts.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

/// Expects what the last step of `two_blocks(box)` means.
inline void expect_two_blocks(const ReadResult& result, const HexMesh& box) {
    using testing::HasSubstr;
    const std::size_t points = box.points.size();
    EXPECT_EQ(result.mesh.points, box.points);
    EXPECT_EQ(result.mesh.cells, box.cells);
    EXPECT_THAT(result.warnings,
                testing::ElementsAre("the file has 2 steps; the last one is read",
                                     HasSubstr("field \"only one\" has no value at "), HasSubstr("cell array \"c\"")));
    ASSERT_EQ(result.fields.size(), 6u);
    ASSERT_EQ(result.incomplete.size(), 1u);
    EXPECT_EQ(result.incomplete[0].cells.front(), 5);
    EXPECT_TRUE(std::isnan(result.incomplete[0].cells.back()));
    EXPECT_EQ(result.incomplete[0].values.front(), 5) << "at points the mean of the cells that have a value";
    EXPECT_EQ(result.mesh.find_attribute("T")->values, count_from(3 + static_cast<double>(points), points));
    EXPECT_EQ(result.mesh.find_attribute("D_y")->values,
              count_from(5 + static_cast<double>(points), points));  // there is no D_z
    const Attribute& velocity = *result.mesh.find_attribute("VEL");
    EXPECT_EQ(velocity.channels, 3);
    EXPECT_EQ(velocity.values[3 * 7 + 1], static_cast<double>(7 + 1 + points));
    EXPECT_EQ(result.fields[4].min, 5);
    EXPECT_EQ(result.fields[4].max, 6);
    EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 5);
    EXPECT_EQ(result.mesh.find_attribute("c")->values[points - 1], 6);
}

}  // namespace subvol::test
