// SPDX-License-Identifier: Apache-2.0
#include "subvol/view_options.h"

#include <gtest/gtest.h>

#include "lib/expect_error.h"
#include "subvol/picture_look.h"

namespace subvol {
namespace {

using test::expect_error;

constexpr ErrorCode kInvalid = ErrorCode::InvalidInput;
const Box kBox{{-1, -1, -1}, {1, 1, 1}};

TEST(ViewOptions, ReadsSizes) {
    const PictureSize wide = parse_size("640x480", "--size"), square = parse_size("300", "--size");
    EXPECT_EQ(wide.width, 640);
    EXPECT_EQ(wide.height, 480);
    EXPECT_EQ(square.height, 300);
    for (const char* text : {"", "x", "12x", "-3", "1e3", "3x4x5", "0", "99999999999999999999"}) {
        expect_error(kInvalid, "--size", [&] { (void)parse_size(text, "--size"); });
    }
}

TEST(ViewOptions, CameraTextIsExact) {
    const Camera camera{
        .eye = {1.0 / 3, -4.2, 2}, .target = {.1, .2, .3}, .up = {0, 0, 1}, .fovy_deg = 33.3, .ortho_height = 2.0 / 7};
    const Camera again = parse_camera(camera_text(camera), kBox);
    EXPECT_EQ(again.eye, camera.eye);
    EXPECT_EQ(again.target, camera.target);
    EXPECT_EQ(again.fovy_deg, camera.fovy_deg);
    EXPECT_EQ(again.ortho_height, camera.ortho_height);
}

TEST(ViewOptions, NamedViewsFrameThePointsAndGivenCamerasStay) {
    const std::vector<Vec3> points{{.1, 0, 0}, {.3, .2, .1}};
    const Camera box = find_camera({.view = "-y"}, kBox, {}, 1), near = find_camera({.view = "-y"}, kBox, points, 1);
    EXPECT_LT(glm::distance(near.eye, near.target),
              .5 * glm::distance(box.eye, box.target));  // the points take a tenth of the box
    const Camera given = find_camera({.camera = "5,0,0,0,0,0,0,0,1,30"}, kBox, points, 1);
    EXPECT_EQ(given.eye, Vec3(5, 0, 0));
    EXPECT_GT(find_camera({.camera = "3,0,0,0,0,0,0,0,1,30", .fit = true}, kBox, {}, 1).eye.x, 4);  // the box needs more room
    EXPECT_GT(find_camera({.orthographic = true}, kBox, {}, 1).ortho_height, 2);
    expect_error(kInvalid, "view", [] { (void)find_camera({.view = "sideways"}, kBox, {}, 1); });
    expect_error(kInvalid, "--camera", [] { (void)find_camera({.camera = "1,2"}, kBox, {}, 1, OptionNames::Flags); });
}

TEST(LookChoices, ABodyIsSolidUnlessColoursAreChosen) {
    EXPECT_EQ(chosen_look({}, true), Look::Solid);
    EXPECT_EQ(chosen_look({}, false), Look::Volume);
    EXPECT_EQ(chosen_look({.colors = "turbo", .range = "0,1"}, true), Look::Solid);
    EXPECT_EQ(chosen_look({.opacity = "0:0,1:1"}, true), Look::Volume);
    EXPECT_EQ(chosen_look({.opacity_unit_world = 1.0}, true), Look::Volume);
    EXPECT_EQ(chosen_look({.look = "xray", .colors = "grey"}, true), Look::Xray);
    expect_error(kInvalid, "look", [] { (void)chosen_look({.look = "glass"}, true); });
    EXPECT_EQ(chosen_look({.iso = "50%"}, true), Look::Isosurface);
    expect_error(kInvalid, "iso", [] { (void)chosen_look({.look = "solid", .iso = "50%"}, true); });
}

TEST(LookChoices, RangesAndOpacitiesArePartsOfTheFieldsRange) {
    const ValueRange field{.min = 100, .max = 300};
    const ValueRange part = shown_range({.range = "10%,250"}, field);
    EXPECT_EQ(part.min, 120);
    EXPECT_EQ(part.max, 250);
    EXPECT_EQ(shown_range({.range = "field"}, field).max, 300);
    const LookOptions options = look_options({.range = "200,300", .opacity = "50%:.5"}, Look::Volume, field);
    EXPECT_EQ(options.opacity.front().value, 250);  // in the middle of the range that is shown
    EXPECT_TRUE(options.stretch);
    expect_error(kInvalid, "range", [&] { (void)shown_range({.range = "300,100"}, field); });
    expect_error(kInvalid, "--opacity", [&] { (void)look_options({.opacity = "1"}, Look::Volume, field, OptionNames::Flags); });
}

}  // namespace
}  // namespace subvol
