// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace color_boundary_test {

TEST(ColorBoundary, PixelsGetTheColorOfTheirPlaceOnTheSurface) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes = {{"a", 1, {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(p.x);
    const BoundaryValues boundary = boundary_values(mesh, {.levels = 1});
    const Optics optics(transfer_function_preset("grey", 0, 1), 1);
    const View view({.eye = {0.5, -5, 0.5}, .target = {0.5, 0, 0.5}, .up = {0, 0, 1}, .fovy_deg = 30}, 40, 40);
    Image image(40, 40);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        image.rgba[i] = 0.25f;  // what kernels made of it
        image.rgba[i + 3] = 0.5f;
    }
    const Shading flat{.ambient = 1, .diffuse = 0, .specular = 0};
    color_boundary(image, boundary.surface, boundary.values[0], view, optics, flat, 2);
    for (const int x : {14, 20, 26}) {
        const Ray ray = view.ray(x + 0.5, 20.5);
        const double at = ray.origin.x + ray.direction.x * (-ray.origin.y / ray.direction.y);  // on the face y = 0
        EXPECT_NEAR(image.pixel(x, 20)[1], 0.5 * optics.color(at).y, 5e-3) << "the mean of four rays";
        EXPECT_EQ(image.pixel(x, 20)[3], 0.5f) << "opacities stay";
    }
    EXPECT_EQ(image.pixel(2, 2)[0], 0.25f) << "beside the body nothing changes";
    test::expect_error(ErrorCode::InvalidInput, "3 values",
                       [&] { color_boundary(image, boundary.surface, std::vector<double>(3), view, optics, flat); });
}

}  // namespace color_boundary_test
}  // namespace subvol
