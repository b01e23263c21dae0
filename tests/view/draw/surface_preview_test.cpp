// SPDX-License-Identifier: Apache-2.0
#include "surface_preview.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lib/test_meshes.h"
#include "subvol/topology.h"

namespace subvol {
namespace surface_preview_test {

TEST(SurfacePreview, ShowsNothingBehindTheEye) {
    BoundaryValues boundary;
    boundary.surface = boundary_surface(test::make_box(1, 1, 1));
    boundary.values.assign(1, std::vector<double>(boundary.surface.points.size(), 0.5));
    const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 1}}}, 1e-6);
    for (const double ortho_height : {0.0, 2.0}) {
        const auto nearest = [&](double eye_z) {
            const View view({.eye = {0.5, 0.5, eye_z}, .target = {0.5, 0.5, -9}, .up = {0, 1, 0}, .ortho_height = ortho_height},
                            20, 20);
            return std::ranges::min(detail::surface_preview(boundary, view, optics, {}).depth);
        };
        EXPECT_NEAR(nearest(3), 2, 1e-6) << ortho_height;
        EXPECT_NEAR(nearest(0.75), 0.75, 1e-6) << ortho_height << ": the far side, from inside";
        EXPECT_EQ(nearest(-0.5), std::numeric_limits<float>::infinity()) << ortho_height;
    }
}

// Of triangles that reach behind the eye the part before it is seen: here the walls, nearest at the edge of the picture.
TEST(SurfacePreview, ShowsWhatReachesBehindTheEye) {
    BoundaryValues boundary;
    boundary.surface = boundary_surface(test::make_box(1, 1, 1));
    boundary.values.assign(1, std::vector<double>(boundary.surface.points.size(), 0.5));
    const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 1}}}, 1e-6);
    const View view({.eye = {0.5, 0.5, 0.75}, .target = {0.5, 0.5, -9}, .up = {0, 1, 0}, .fovy_deg = 90}, 20, 20);
    const detail::Preview preview = detail::surface_preview(boundary, view, optics, {});
    EXPECT_NEAR(std::ranges::min(preview.depth), 0.5 / 0.95, 1e-6);  // the centre of the last pixel, whose slope is 0.95
    EXPECT_LT(std::ranges::max(preview.depth), 0.75 + 1e-6);         // no gap
}

}  // namespace surface_preview_test
}  // namespace subvol
