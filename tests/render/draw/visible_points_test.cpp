// SPDX-License-Identifier: Apache-2.0
// Points that drop_invisible drops do not change any picture.
#include "subvol/visible_points.h"

#include <gtest/gtest.h>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace visible_points_test {

Image picture(const RbfVolume& volume, const TransferFunction& function, const char* view) {
    return render_splats(volume, View(parse_camera(view, volume.bounds), 160, 160),
                         Optics(function, volume.bounds.diagonal() / 100), {.method = SplatMethod::Cpu, .sheets = 300})
        .image;
}

class EmptySpace : public testing::TestWithParam<Correction> {};

TEST_P(EmptySpace, NoPixelChangesWhereInvisiblePointsAreDropped) {
    const HexMesh mesh = make_model("alien", 24);
    const auto volume = sample_rbf_points(mesh, {.per_edge = 2, .correction = GetParam()}).volume;
    const TransferFunction surface = transfer_function_preset("surface", -1, 1);
    const VisibleVolume visible = drop_invisible(volume, 0, surface);
    EXPECT_EQ(visible.dropped + visible.volume.size(), volume.size());
    EXPECT_GT(visible.dropped, volume.size() / 3);  // the alien fills an eighth of its block
    for (const char* view : {"iso", "-y", "+x"}) {
        EXPECT_EQ(picture(volume, surface, view).rgba, picture(visible.volume, surface, view).rgba);
    }
}

TEST_P(EmptySpace, ABandInTheMiddleOfTheRangeKeepsWhatPassesThroughIt) {
    // No point has a value within the band, but the field between points has: dropping points by their own values would lose
    // the surface.
    const HexMesh mesh = make_model("ball", 6);
    const auto volume = sample_rbf_points(mesh, {.correction = GetParam()}).volume;
    auto values = volume.channels[0].values;
    std::sort(values.begin(), values.end());
    std::size_t widest = 0;
    for (std::size_t i = values.size() / 4; i + 1 < 3 * values.size() / 4; ++i) {
        if (values[i + 1] - values[i] > values[widest + 1] - values[widest] || widest == 0) widest = i;
    }
    const double low = values[widest], high = values[widest + 1], middle = .5 * (low + high);
    const TransferFunction band{.color = {{0, Vec3(1.0)}}, .opacity = {{low, 0}, {middle, 1}, {high, 0}}};
    const VisibleVolume visible = drop_invisible(volume, 0, band);
    EXPECT_GT(visible.dropped, 0u);
    const Image all = picture(volume, band, "iso");
    EXPECT_GT(*std::max_element(all.rgba.begin(), all.rgba.end()), .05f);
    EXPECT_EQ(all.rgba, picture(visible.volume, band, "iso").rgba);
}

INSTANTIATE_TEST_SUITE_P(Corrections, EmptySpace, testing::Values(Correction::None, Correction::Second, Correction::Full));

TEST(EmptySpaceLimits, EverythingOrNothing) {
    const auto volume = sample_rbf_points(make_model("ball", 4)).volume;
    EXPECT_EQ(drop_invisible(volume, 0, opaque_above(10)).volume.size(), 0u);
    EXPECT_EQ(drop_invisible(volume, 0, opaque_above(-10)).dropped, 0u);
}

TEST(EmptySpaceLimits, ChannelsThatAreNotDrawnNeedNoGradients) {
    auto volume = sample_rbf_points(make_model("ball", 8)).volume;
    volume.channels.push_back({.name = "values alone", .values = volume.channels[0].values});
    const float most = *std::max_element(volume.channels[0].values.begin(), volume.channels[0].values.end());
    const VisibleVolume visible = drop_invisible(volume, 0, opaque_above(0.9 * most));
    ASSERT_GT(visible.dropped, 0u);
    ASSERT_GT(visible.volume.size(), 0u);
    EXPECT_EQ(visible.volume.channels[1].values, visible.volume.channels[0].values);
    EXPECT_TRUE(visible.volume.channels[1].gradients.empty());
}

TEST(EmptySpaceLimits, RefusesChannelsAndKernelsThatItCannotBound) {
    auto volume = sample_rbf_points(make_model("ball", 4)).volume;
    EXPECT_THROW((void)drop_invisible(volume, 1, opaque_above(0)), Error);
    volume.kernel = named_kernel("two_gaussians");
    EXPECT_THROW((void)drop_invisible(volume, 0, opaque_above(0)), Error);
}

}  // namespace visible_points_test
}  // namespace subvol
