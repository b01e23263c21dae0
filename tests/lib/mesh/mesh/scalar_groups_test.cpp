// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/scalar_groups.h"

#include <gtest/gtest.h>

namespace subvol {
namespace scalar_groups_test {

/// "name: members" of each group.
std::vector<std::string> groups_of(const std::vector<std::string>& names) {
    std::vector<std::string> texts;
    for (const detail::ScalarGroup& group : detail::scalar_groups(names)) {
        std::string text = group.name + ":";
        for (const std::size_t member : group.members) text += " " + names[member];
        texts.push_back(text);
    }
    return texts;
}

TEST(ScalarGroups, AreNamedByTheirComponents) {
    using Texts = std::vector<std::string>;
    EXPECT_EQ(groups_of({"VELX", "VELY", "VELZ", "P"}), Texts{"VEL: VELX VELY VELZ"});
    EXPECT_EQ(groups_of({"disp_z", "T", "disp_x", "disp_y"}), Texts{"disp: disp_x disp_y disp_z"});
    // As MOOSE writes them, and as Sierra does.
    EXPECT_EQ(groups_of({"s_xx", "s_xy", "s_xz", "s_yy", "s_yz", "s_zz"}), Texts{"s: s_xx s_yy s_zz s_xy s_yz s_xz"});
    EXPECT_EQ(groups_of({"s_xx", "s_yy", "s_zz", "s_xy", "s_yz", "s_zx", "u_x", "u_y", "u_z"}),
              (Texts{"s: s_xx s_yy s_zz s_xy s_yz s_zx", "u: u_x u_y u_z"}));
    EXPECT_EQ(groups_of({"F_xx", "F_xy", "F_xz", "F_yx", "F_yy", "F_yz", "F_zx", "F_zy", "F_zz"}),
              Texts{"F: F_xx F_xy F_xz F_yx F_yy F_yz F_zx F_zy F_zz"});
    EXPECT_EQ(groups_of({"a.x", "b.y", "a.z"}), Texts{});
    EXPECT_EQ(groups_of({"x", "y", "z"}), Texts{}) << "coordinates are no field without a name";
    EXPECT_EQ(groups_of({"s_xx", "s_yy", "s_zz", "s_xy"}), Texts{}) << "a plane tensor has no six components";
}

}  // namespace scalar_groups_test
}  // namespace subvol
