// SPDX-License-Identifier: Apache-2.0
#include "subvol/usd_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"

namespace subvol::test {

namespace usd_file_test {

using testing::HasSubstr;
using testing::Not;

class UsdFile : public TempFolder {};

UsdVolume volume_of(std::vector<UsdStep> steps) {
    return {.grids = {{"a b"}, {"a_b"}, {"vel", true}},
            .steps = std::move(steps),
            .colors = transfer_function_preset("viridis", 0, 1),
            .opacity_unit_world = 0.5};
}

TEST_F(UsdFile, NamesFilesByTheirWayFromTheStage) {
    const Box box{Vec3(0), Vec3(1)};
    write_usd(path("a.usda"), volume_of({{0, path("grids/x.vdb"), box}}));
    const std::string text = read_bytes(path("a.usda"));
    EXPECT_THAT(text, HasSubstr("asset filePath = @./grids/x.vdb@\n"));
    EXPECT_THAT(text, HasSubstr("def OpenVDBAsset \"a_b\""));
    EXPECT_THAT(text, HasSubstr("def OpenVDBAsset \"a_b_2\""));  // no two prims of one name
    EXPECT_THAT(text, HasSubstr("token fieldName = \"a b\""));
    EXPECT_THAT(text, HasSubstr("token fieldDataType = \"float3\""));
    EXPECT_THAT(text, Not(HasSubstr("TimeCode")));
}

TEST_F(UsdFile, EachCodeHasItsFile) {
    const Box box{Vec3(0), Vec3(1)};
    write_usd(path("a.usda"), volume_of({{2, path("x.vdb"), box}, {2.5, path("y.vdb"), box}}));
    const std::string text = read_bytes(path("a.usda"));
    EXPECT_THAT(text, HasSubstr("2: @./x.vdb@,"));
    EXPECT_THAT(text, HasSubstr("2.5: @./y.vdb@,"));
    EXPECT_THAT(text, HasSubstr("endTimeCode = 2.5"));
}

TEST_F(UsdFile, RefusesWhatIsNoStage) {
    const Box box{Vec3(0), Vec3(1)};
    const UsdStep step{0, path("x.vdb"), box};
    UsdVolume empty = volume_of({step});
    empty.grids.clear();
    expect_error(ErrorCode::InvalidInput, "extension", [&] { write_usd(path("a.usd"), volume_of({step})); });
    expect_error(ErrorCode::InvalidInput, "no grids", [&] { write_usd(path("a.usda"), empty); });
    expect_error(ErrorCode::InvalidInput, "time codes", [&] { write_usd(path("a.usda"), volume_of({})); });
    expect_error(ErrorCode::InvalidInput, "ascending", [&] { write_usd(path("a.usda"), volume_of({step, step})); });
    EXPECT_FALSE(std::filesystem::exists(path("a.usda")));
}

}  // namespace usd_file_test

}  // namespace subvol::test
