// SPDX-License-Identifier: Apache-2.0
// Bodies thinner than the distance of sheets, and bodies that are opaque from their boundary on.
#include <gtest/gtest.h>

#include <cmath>

#include "splat_oracle.h"
#include "splat_scenes.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace thin_bodies_test {

constexpr int kSize_px = 60;

/// A plate of 1 × 1 in x and y, whose value is 1 + x.
RbfVolume plate(double thickness) {
    HexMesh mesh = test::box(8);
    for (Vec3& p : mesh.points) p.z *= thickness;
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(1 + p.x);
    return sample_rbf_points(mesh).volume;
}

View askew() {
    return {{.eye = {3, -4, 3}, .target = {.5, .5, 0}, .up = {0, 0, 1}, .ortho_height = 1.4}, kSize_px, kSize_px};
}

/// White, with the same extinction everywhere.
Optics even(double extinction) {
    return {{.color = {{0, {1, 1, 1}}, {3, {1, 1, 1}}}, .opacity = {{0, .5}}}, std::log(2.0) / extinction};
}

/// Blue to red over the values of the plate, opaque.
Optics opaque() {
    return {{.color = {{1, {0, 0, 1}}, {2, {1, 0, 0}}}, .opacity = {{1, 1}}}, 1e-6};
}

TEST(ThinBodies, APlateBetweenTwoSheetsHasItsOpticalDepth) {
    constexpr double kThickness = 1e-3, kExtinction = 500;
    const RbfVolume volume = plate(kThickness);
    const View view = askew();
    const double slant = std::abs(view.axes()[2].z);
    for (const int sheets : {7, 50, 0}) {
        const Image image =
            render_splats(volume, view, even(kExtinction), {.method = SplatMethod::Cpu, .sheets = sheets}).image;
        int seen = 0;
        for (int y = 0; y < kSize_px; ++y) {
            for (int x = 0; x < kSize_px; ++x) {
                const Ray ray = view.ray(x + .5, y + .5);
                const auto at = [&](double z) { return ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction; };
                const Vec3 top = at(kThickness), bottom = at(0);
                const auto within = [](const Vec3& p) { return p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1; };
                if (!within(top) || !within(bottom)) continue;
                ++seen;
                // The thickness is a difference of two depths in floats, which are some units large.
                ASSERT_NEAR(image.pixel(x, y)[3], 1 - std::exp(-kExtinction * kThickness / slant), 2e-3)
                    << sheets << " sheets, pixel " << x << ", " << y;
            }
        }
        EXPECT_GT(seen, 500);
    }
}

TEST(ThinBodies, EveryPlateOfAStackHasItsOwnValue) {
    constexpr int kPlates = 7;
    const auto height = [](int plate) { return .12 * plate; };
    const auto thickness = [](int plate) { return plate % 2 == 0 ? 1e-3 : .02; };
    HexMesh mesh;
    mesh.attributes = {{"f", 1, {}}};
    TransferFunction function{.color = {{0, {1, 1, 1}}, {kPlates, {1, 1, 1}}}, .opacity = {}};
    for (int plate = 0; plate < kPlates; ++plate) {
        HexMesh part = test::box(4);
        const auto first = static_cast<Index>(mesh.points.size());
        for (const Vec3& p : part.points) mesh.points.push_back({p.x, p.y, height(plate) + thickness(plate) * p.z});
        for (auto& cell : part.cells) {
            for (Index& corner : cell) corner += first;
            mesh.cells.push_back(cell);
        }
        mesh.attributes[0].values.resize(mesh.points.size(), plate);
        function.opacity.push_back({double(plate), .1 + .1 * plate});
    }
    constexpr double kUnit = .01;
    const Optics optics(function, kUnit);
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const View view({.eye = {1.5, -1, 4}, .target = {.5, .5, .4}, .up = {0, 1, 0}, .ortho_height = 1.4}, kSize_px, kSize_px);
    const double slant = std::abs(view.axes()[2].z);
    for (const int sheets : {9, 300}) {
        const Image image = render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .sheets = sheets}).image;
        int whole = 0;
        for (int y = 0; y < kSize_px; ++y) {
            for (int x = 0; x < kSize_px; ++x) {
                const Ray ray = view.ray(x + .5, y + .5);
                const auto is_within = [&](double z) {
                    const Vec3 p = ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction;
                    return p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1;
                };
                double depth = 0;
                int met = 0;
                bool at_rim = false;
                for (int plate = 0; plate < kPlates; ++plate) {
                    const bool top = is_within(height(plate) + thickness(plate)), bottom = is_within(height(plate));
                    at_rim |= top != bottom;
                    if (top && bottom) ++met, depth -= std::log(1 - (.1 + .1 * plate)) * thickness(plate) / (kUnit * slant);
                }
                if (at_rim) continue;
                whole += met == kPlates ? 1 : 0;
                ASSERT_NEAR(image.pixel(x, y)[3], 1 - std::exp(-depth), 1e-3) << sheets << " sheets, pixel " << x << ", " << y;
            }
        }
        EXPECT_GT(whole, 100) << "rays through all plates, with more ends than are summed at once";
    }
}

TEST(ThinBodies, AnOpaqueBodyShowsTheValuesOfItsBoundary) {
    const View view = askew();
    for (const double thickness : {1e-3, .3}) {
        const Image image = render_splats(plate(thickness), view, opaque(), {.method = SplatMethod::Cpu, .sheets = 9}).image;
        int seen = 0;
        for (int y = 0; y < kSize_px; ++y) {
            for (int x = 0; x < kSize_px; ++x) {
                const Ray ray = view.ray(x + .5, y + .5);
                const Vec3 top = ray.origin + (thickness - ray.origin.z) / ray.direction.z * ray.direction;
                if (!(top.x > 0 && top.x < 1 && top.y > 0 && top.y < 1)) continue;
                ++seen;
                const auto pixel = image.pixel(x, y);
                ASSERT_NEAR(pixel[3], 1, 1.01e-4) << x << ", " << y;
                // Kernels of second order hold a linear field to 1e-3 of its range here, at the boundary too.
                ASSERT_NEAR(pixel[0], top.x, 5e-3) << x << ", " << y;
                ASSERT_NEAR(pixel[2], 1 - top.x, 5e-3) << x << ", " << y;
            }
        }
        EXPECT_GT(seen, 500);
    }
}

TEST(ThinBodies, OpaqueAndLitBodiesAgreeWithTheOracle) {
    const RbfVolume volume = plate(.3);
    const View view(askew().camera(), 33, 30);
    for (const double extinction : {20.0, 300.0, 1e7}) {
        const Optics optics({.color = {{1, {0, 0, 1}}, {2, {1, 0, 0}}}, .opacity = {{1, .2}, {2, .5}}}, .7 / extinction);
        const SplatOptions options{.method = SplatMethod::Cpu, .sheets = 20, .shading = Shading{}};
        const auto drawn = render_splats(volume, view, optics, options);
        const auto expected = draw_oracle(volume, view, optics, options, Emission::Preintegrated);
        // Depths are floats of some units: 4e-7, times the extinction, changes the first steps of a ray; what remains opaque
        // is limited by the cutoff of 1e-4.
        EXPECT_LT(largest_difference(drawn.image, expected.image), 3e-4) << extinction;
    }
}

TEST(ThinBodies, ASharpCreaseIsLitAsOneAndARoundBodyAsRound) {
    // A cube seen along a diagonal: three faces, each of one brightness.
    HexMesh cube = test::box(4);
    cube.attributes = {{"f", 1, std::vector<double>(cube.points.size(), 1)}};
    const RbfVolume volume = sample_rbf_points(cube).volume;
    const View view({.eye = {4, -4, 4}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = 1.8}, 40, 40);
    const Image image =
        render_splats(volume, view, even(1e7), {.method = SplatMethod::Cpu, .shading = Shading{.specular = 0}}).image;
    std::vector<float> tones;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
            const auto pixel = image.pixel(x, y);
            if (pixel[3] == 0) continue;
            const bool known = std::ranges::any_of(tones, [&](float t) { return std::abs(t - pixel[0]) < 1e-3F; });
            if (!known) tones.push_back(pixel[0]);
        }
    }
    EXPECT_EQ(tones.size(), 3U) << "one for each face that is seen";
}

TEST(ThinBodies, AutomaticSheetsFollowTheKernels) {
    const View view = askew();
    const auto sheets_of = [&](int cells) {
        HexMesh mesh = test::box(cells);
        mesh.attributes = {{"f", 1, std::vector<double>(mesh.points.size(), 1)}};
        return render_splats(sample_rbf_points(mesh).volume, view, even(1), {.method = SplatMethod::Cpu}).report.sheets;
    };
    EXPECT_NEAR(sheets_of(32), 2 * sheets_of(16), 6) << "cells of half the size need twice as many";
}

}  // namespace thin_bodies_test
}  // namespace subvol::test
