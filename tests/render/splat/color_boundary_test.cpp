// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/shading.h"
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

TEST(DrawBoundary, OpacityAndDepthAreThoseOfTheRaysThatMeetTheBody) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes = {{"a", 1, {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(p.x);
    const BoundaryValues boundary = boundary_values(mesh, {.levels = 0});
    const Optics optics(transfer_function_preset("grey", 0, 1), 1);
    const View view({.eye = {0.4, -5, 0.3}, .target = {0.4, 0, 0.3}, .up = {0, 0, 1}, .fovy_deg = 30}, 40, 36);
    const Shading flat{.ambient = 1, .diffuse = 0, .specular = 0};
    constexpr int kSamples = 3;
    const BoundaryPicture drawn = draw_boundary(boundary.surface, boundary.values[0], view, optics, flat, kSamples);
    ASSERT_EQ(drawn.depth.size(), 40U * 36U);
    int partly = 0;
    for (int y = 0; y < 36; ++y) {
        for (int x = 0; x < 40; ++x) {
            int met = 0;
            Vec3 color(0.0);
            for (int k = 0; k < kSamples * kSamples; ++k) {  // the face y = 0 hides the rest of the box
                const Ray ray = view.ray(x + (k % kSamples + 0.5) / kSamples, y + (k / kSamples + 0.5) / kSamples);
                const Vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
                if (at.x < 0 || at.x > 1 || at.z < 0 || at.z > 1) continue;
                color += optics.color(at.x);
                ++met;
            }
            const auto pixel = drawn.image.pixel(x, y);
            const float depth = drawn.depth[static_cast<std::size_t>(y) * 40 + static_cast<std::size_t>(x)];
            EXPECT_NEAR(pixel[3], met / 9.0, 1e-6) << x << ' ' << y;
            EXPECT_NEAR(pixel[1], color.y / 9, 2e-3) << x << ' ' << y;
            if (met == 0) {
                EXPECT_TRUE(std::isinf(depth));
            } else {
                EXPECT_NEAR(depth, 5, 1e-5);
            }
            partly += met > 0 && met < 9;
        }
    }
    EXPECT_GT(partly, 20) << "pixels at the outline";

    const BoundaryPicture rows =
        draw_boundary(boundary.surface, boundary.values[0], view, optics, flat, kSamples, {.first = 9, .end = 23});
    for (int y = 0; y < 36; ++y) {
        for (int x = 0; x < 40; ++x) {
            for (std::size_t c = 0; c < 4; ++c)
                EXPECT_EQ(rows.image.pixel(x, y)[c], y >= 9 && y < 23 ? drawn.image.pixel(x, y)[c] : 0.0f);
        }
    }
}

TEST(DrawBoundary, ACutShowsTheValuesAtItsPlacesInTheLightOfItsPlane) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes = {{"a", 1, std::vector<double>(mesh.points.size(), 0)}};
    const BoundaryValues boundary = boundary_values(mesh, {.levels = 0});
    const Optics optics(transfer_function_preset("grey", 0, 1), 1);
    const Shading shading{.ambient = .3, .diffuse = .7, .specular = 0};
    const Vec3 normal = glm::normalize(Vec3(.4, 0, 1));
    BoundaryCut cut{.clip = {.planes = {{.point = {.5, .5, .5}, .normal = normal}}}, .value_at = {}};
    cut.value_at = [](const Vec3& at) { return std::optional(.2 + .5 * at.x * at.y); };
    for (const bool parallel : {false, true}) {
        Camera camera{.eye = {.5, .5, 4}, .target = {.5, .5, 0}, .up = {0, 1, 0}, .fovy_deg = 20};
        if (parallel) camera.ortho_height = 1.3;
        const View view(camera, 40, 36);
        const BoundaryPicture drawn =
            draw_boundary(boundary.surface, boundary.values[0], view, optics, shading, 2, {}, nullptr, cut);
        EXPECT_EQ(drawn.rays_inside, 0U);
        const auto& axes = view.axes();
        std::size_t on_cut = 0;
        for (int y = 0; y < 36; ++y) {
            for (int x = 0; x < 40; ++x) {
                Vec3 color(0.0);
                double depth = 0;
                int met = 0;
                for (int k = 0; k < 4; ++k) {
                    const Ray ray = view.ray(x + (k % 2 + .5) / 2, y + (k / 2 + .5) / 2);
                    const double to = glm::dot(Vec3(.5, .5, .5) - ray.origin, normal) / glm::dot(ray.direction, normal);
                    const Vec3 at = ray.origin + to * ray.direction;
                    if (at.x < 0 || at.x > 1 || at.y < 0 || at.y > 1 || at.z < 0 || at.z > 1) continue;
                    const Vec3 to_eye = -glm::normalize(ray.direction);
                    const auto in_eye = [&](const Vec3& v) {
                        return Vec3(glm::dot(v, axes[0]), glm::dot(v, axes[1]), glm::dot(v, axes[2]));
                    };
                    const detail::SurfaceLight light = detail::surface_light(shading, in_eye(normal), in_eye(to_eye));
                    color += static_cast<double>(light.diffuse) * optics.color(.2 + .5 * at.x * at.y);
                    depth += glm::dot(at - view.eye(), axes[2]);
                    ++met;
                }
                if (met < 4) continue;
                ++on_cut;
                EXPECT_NEAR(drawn.image.pixel(x, y)[1], color.y / 4, 1e-5) << x << ' ' << y;
                EXPECT_EQ(drawn.image.pixel(x, y)[3], 1.0f);
                EXPECT_NEAR(drawn.depth[static_cast<std::size_t>(y) * 40 + static_cast<std::size_t>(x)], depth / 4, 1e-5);
            }
        }
        EXPECT_GT(on_cut, 200U);
        cut.value_at = [](const Vec3& at) { return at.x < .5 ? std::optional(.2 + .5 * at.x * at.y) : std::nullopt; };
        EXPECT_GT(draw_boundary(boundary.surface, boundary.values[0], view, optics, shading, 2, {}, nullptr, cut).rays_inside,
                  on_cut);
        cut.value_at = [](const Vec3& at) { return std::optional(.2 + .5 * at.x * at.y); };
    }
}

}  // namespace color_boundary_test
}  // namespace subvol
