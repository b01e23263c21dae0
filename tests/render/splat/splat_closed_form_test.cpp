// SPDX-License-Identifier: Apache-2.0
// Pictures of splats with a closed form.
#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <random>

#include "lib/random_vector.h"
#include "splat_scenes.h"
#include "subvol/gl_device.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_closed_form_test {

constexpr double kSigma = 0.43;  // of the kernels below, whose sample interval is 1

/// Isotropic Gaussians in a box that contains their supports.
RbfVolume gaussians(const std::vector<Vec3>& centers, const std::vector<float>& values, double half_box) {
    RbfVolume volume;
    volume.kernel = GaussianKernel{.sigma = kSigma, .amplitude = 1, .radius = 3};
    volume.centers = centers;
    volume.frames.assign(centers.size(), {9, 0, 0, 9, 0, 9});
    volume.channels = {{.name = "f",
                        .values = values,
                        .gradients = std::vector<std::array<float, 3>>(centers.size()),
                        .moments = std::vector<float>(centers.size())}};
    HexMesh box = test::box(1);
    for (Vec3& p : box.points) p = half_box * (2.0 * p - 1.0);
    volume.boundary = boundary_surface(box);
    return volume;
}

constexpr double kSmallAlpha = 1e-4;

/// Extinction equal to the value, up to a relative error of kSmallAlpha / 2 times the value.
Optics linear_extinction(double max) {
    return Optics({.color = {{0, {1, .5, .25}}, {max, {1, .5, .25}}}, .opacity = {{0, 0}, {max, kSmallAlpha * max}}},
                  kSmallAlpha);
}

double optical_depth(float alpha) {
    return -std::log1p(-static_cast<double>(alpha));
}

TEST(SplatClosedForm, OneGaussianHasItsOpticalDepth) {
    const RbfVolume volume = gaussians({{.1, .2, -.1}}, {.8f}, 3.5);
    const View view({.eye = {0, -10, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 7}, 70, 70);
    const auto image =
        render_splats(volume, view, linear_extinction(1), {.method = SplatMethod::Cpu, .sheets = 120, .normalized = false})
            .image;
    double total = 0;
    for (int y = 0; y < 70; ++y) {
        for (int x = 0; x < 70; ++x) {
            const Vec2 p = view.slopes(x + .5, y + .5) - Vec2(.1, -.1);
            const double expected =
                .8 * std::exp(-glm::dot(p, p) / (2 * kSigma * kSigma)) * kSigma * std::sqrt(2 * std::numbers::pi);
            const double depth = optical_depth(image.pixel(x, y)[3]);
            // Sums of a Gaussian over planes are exact; the errors are 5e-5 of the function, 5e-6 of the kernel's table (of the
            // peak, over a length of 1) and the rounding of the opacity.
            EXPECT_NEAR(depth, expected, 5e-5 * expected + 1e-5);
            total += depth;
        }
    }
    EXPECT_NEAR(total * .01, .8 * std::pow(2 * std::numbers::pi * kSigma * kSigma, 1.5), 1e-4);
}

TEST(SplatClosedForm, GaussiansAddUp) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-1, 1), value(.1, .5);
    std::vector<Vec3> centers;
    std::vector<float> values;
    for (int i = 0; i < 12; ++i) {
        centers.push_back(random_vector(place, random));
        values.push_back(static_cast<float>(value(random)));
    }
    const RbfVolume volume = gaussians(centers, values, 4.5);
    const View view({.eye = {3, -10, 2}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 25}, 50, 50);
    const auto image =
        render_splats(volume, view, linear_extinction(4), {.method = SplatMethod::Cpu, .sheets = 200, .normalized = false})
            .image;
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 50; ++x) {
            const Ray ray = view.ray(x + .5, y + .5);
            double expected = 0;
            for (std::size_t i = 0; i < centers.size(); ++i) {
                const double away = glm::length(glm::cross(centers[i] - ray.origin, glm::normalize(ray.direction)));
                expected += static_cast<double>(values[i]) * std::exp(-away * away / (2 * kSigma * kSigma));
            }
            expected *= kSigma * std::sqrt(2 * std::numbers::pi);
            // The error of the function is 5e-5 of the value, which is up to 3 here; that of the tables 5e-6 for each kernel.
            EXPECT_NEAR(optical_depth(image.pixel(x, y)[3]), expected, 1.5e-4 * expected + 5e-5);
        }
    }
}

/// The depths at which a ray enters and leaves a box; entry > exit if it misses.
Vec2 through_box(const Ray& ray, const Vec3& lower, const Vec3& upper) {
    const Vec3 a = (lower - ray.origin) / ray.direction, b = (upper - ray.origin) / ray.direction;
    const Vec3 near = glm::min(a, b), far = glm::max(a, b);
    return {std::max({near.x, near.y, near.z}), std::min({far.x, far.y, far.z})};
}

TEST(SplatClosedForm, ALinearFieldInASlabIsExactAtEveryAngle) {
    HexMesh slab = jittered_box(3, .2, 9);
    for (Vec3& p : slab.points) p *= Vec3(4, 1, 4);
    const auto field = [](const Vec3& p) { return .1 + .1 * p.x + .3 * p.y + .05 * p.z; };
    add_field(slab, "f", field);
    const auto volume = sample_rbf_points(slab).volume;
    const Optics optics({.color = {{0, {1, .5, .25}}, {1, {1, .5, .25}}}, .opacity = {{0, 0}, {.5, .6}, {.625, .1}, {1, .5}}},
                        .5);
    const View view({.eye = {2.3, -2.5, 2.1}, .target = {2, 0, 2}, .up = {0, 0, 1}, .fovy_deg = 75}, 48, 48);
    const auto image = render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .sheets = 40}).image;
    int inside = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const Ray ray = view.ray(x + .5, y + .5);
            const Vec2 t = through_box(ray, Vec3(0.0), {4, 1, 4});
            if (t[1] - t[0] < .05) continue;  // near an edge: the boundary's corners are snapped to 1/4096 of a pixel
            ++inside;
            const Segment expected =
                optics.integrate(field(ray.origin + t[0] * ray.direction), field(ray.origin + t[1] * ray.direction),
                                 (t[1] - t[0]) * glm::length(ray.direction));
            // Values are floats to 1e-6 of the range, entries and exits are moved by 1/4096 of a pixel times the tangent of the
            // angle of view.
            EXPECT_NEAR(image.pixel(x, y)[3], 1 - expected.transmittance, 2e-4) << x << ' ' << y;
            EXPECT_NEAR(image.pixel(x, y)[1], expected.color.y, 2e-4) << x << ' ' << y;
        }
    }
    EXPECT_GT(inside, 1000);
}

TEST(SplatClosedForm, AConstantIsThatConstantForKernelsOfEveryShape) {
    HexMesh box = test::box(3);  // a lattice: if points were further apart, kernels would leave holes
    add_field(box, "f", [](const Vec3&) { return .7; });
    RbfVolume volume = sample_rbf_points(box).volume;
    const Optics optics({.color = {{0, {1, .5, .25}}, {1, {0, .5, 1}}}, .opacity = {{0, 0}, {1, .5}}}, .5);
    const Segment expected = optics.integrate(.7, .7, 1);
    const View view({.eye = {.5, -5, .5}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = 1.25}, 40, 40);
    for (const std::string& name : kernel_names()) {
        SCOPED_TRACE(name);
        const Kernel kernel = named_kernel(name);
        const double radius = support_radius(kernel) / support_radius(volume.kernel);
        for (auto& frame : volume.frames) {
            for (float& part : frame) part *= static_cast<float>(radius * radius);
        }
        volume.kernel = kernel;
        const auto image = render_splats(volume, view, optics, {.method = SplatMethod::Cpu}).image;
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 40; ++x) {
                const bool inside = std::min(x, y) >= 4 && std::max(x, y) < 36;
                // The rounding of products of 200 floats.
                EXPECT_NEAR(image.pixel(x, y)[3], inside ? 1 - expected.transmittance : 0, 5e-6) << x << ' ' << y;
                EXPECT_NEAR(image.pixel(x, y)[0], inside ? expected.color.x : 0, 5e-6) << x << ' ' << y;
            }
        }
    }
}

/// A box of 3³ cells without the middle one.
RbfVolume hollow_box() {
    HexMesh mesh = lattice({3, 3, 3}, [](Index i, Index j, Index k) { return i != 1 || j != 1 || k != 1; });
    for (Vec3& p : mesh.points) p *= 3.0;
    add_field(mesh, "f", [](const Vec3&) { return .5; });
    return sample_rbf_points(mesh, {.scheme = {.crease_angle_deg = 45}}).volume;  // smooth edges would round the cavity
}

TEST(SplatClosedForm, ACavityIsEmptySeenFromOutsideAndFromWithin) {
    const Optics optics({.color = {{0, {1, 1, 1}}, {1, {1, 1, 1}}}, .opacity = {{0, .5}, {1, .5}}}, 1);
    const RbfVolume volume = hollow_box();
    const auto outside = render_splats(
        volume, View({.eye = {1.5, -3, 1.5}, .target = {1.5, 0, 1.5}, .up = {0, 0, 1}, .ortho_height = 3}, 31, 31), optics,
        {.method = SplatMethod::Cpu, .sheets = 200});
    // Two walls of length 1 in the middle, three cells beside it.
    EXPECT_NEAR(outside.image.pixel(15, 15)[3], .75, 5e-6);
    EXPECT_NEAR(outside.image.pixel(5, 15)[3], .875, 5e-6);
    // The light of the front wall is 1/2, that of the back wall 1/4. The mean depth of a wall is that of its front plus
    // ∫₀¹ s e^{−τs} τ ds / (1 − e^{−τ}).
    const double tau = std::numbers::ln2, mean = 1 / tau - 1;
    EXPECT_NEAR(outside.depth[15 * 31 + 15], (.5 * (3 + mean) + .25 * (5 + mean)) / .75, 2e-5);
    const auto within =
        render_splats(volume, View({.eye = {1.5, 1.5, 1.5}, .target = {1.5, 3, 1.5}, .up = {0, 0, 1}, .fovy_deg = 30}, 31, 31),
                      optics, {.method = SplatMethod::Cpu, .sheets = 200});
    EXPECT_NEAR(within.image.pixel(15, 15)[3], .5, 5e-6);
    EXPECT_NEAR(within.depth[15 * 31 + 15], .5 + mean, 2e-5);
}

TEST(SplatClosedForm, CellCenteredPointsWithoutABoundaryFillTheirBox) {
    constexpr int kCells = 6, kSize_px = 96;  // 12 pixels a cell, a margin of one cell
    RbfVolume volume;
    volume.kernel = CompactKernel{};
    for (int k = 0; k < kCells; ++k) {
        for (int j = 0; j < kCells; ++j) {
            for (int i = 0; i < kCells; ++i) volume.centers.emplace_back(i + .5, j + .5, k + .5);
        }
    }
    constexpr float kSquare = 1.43f * 1.43f;
    volume.frames.assign(volume.size(), {kSquare, 0, 0, kSquare, 0, kSquare});
    volume.channels = {{.name = "f",
                        .values = std::vector<float>(volume.size(), .5f),
                        .gradients = std::vector<std::array<float, 3>>(volume.size()),
                        .moments = std::vector<float>(volume.size())}};
    const Optics optics({.color = {{0, {1, 1, 1}}, {1, {1, 1, 1}}}, .opacity = {{0, .2}, {1, .2}}}, 1);
    const View view({.eye = {3, -10, 3}, .target = {3, 0, 3}, .up = {0, 0, 1}, .ortho_height = 8}, kSize_px, kSize_px);
    const auto image = render_splats(volume, view, optics, {.method = SplatMethod::Cpu}).image;
    for (int i = 0; i < kSize_px; ++i) {
        const double x = (i + .5) / 12 - 1;  // in cells from the box's side
        for (const float alpha : {image.pixel(i, kSize_px / 2)[3], image.pixel(kSize_px / 2, i)[3]}) {
            const bool outside = x < -.25 || x > kCells + .25, within = x > .25 && x < kCells - .25;
            EXPECT_TRUE(alpha == 0 || !outside) << x;
            EXPECT_TRUE(alpha > 0 || !within) << x;
            // Inside, the error of the depth is a quarter of a cell at either end, too.
            if (x > 1 && x < kCells - 1) {
                EXPECT_GT(alpha, 1 - std::pow(.8, kCells - .5)) << x;
                EXPECT_LT(alpha, 1 - std::pow(.8, kCells + .5)) << x;
            }
        }
    }
}

TEST(SplatClosedForm, ThinVolumesKeepTheirLightHoweverManySheets) {
    // A sheet takes less of the light than a float next to 1 can tell.
    HexMesh mesh = test::box(4);
    add_field(mesh, "f", [](const Vec3& p) { return .5 + .1 * p.x; });
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const View view({.eye = {.5, -3, .5}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = .8}, 4, 4);
    std::vector<SplatOptions> ways{{.method = SplatMethod::Cpu}, {.method = SplatMethod::Cpu, .shading = Shading{}}};
    if (find_gl_device()) ways.insert(ways.end(), {{.method = SplatMethod::Gl}, {.method = SplatMethod::Sheets}});
    for (const double unit : {1e4, 1e9, 1e20}) {
        const Optics optics({.color = {{0, {1, .5, .25}}}, .opacity = {{0, .5}}}, unit);
        const double expected = -std::expm1(-std::log(2.0) / unit);  // the rays are 1 long
        for (SplatOptions& options : ways) {
            options.sheets = 1024;
            const SplatResult drawn = render_splats(volume, view, optics, options);
            for (std::size_t i = 0; i < drawn.image.rgba.size(); i += 4) {
                // Floats are rounded in each of the sums, to both sides.
                EXPECT_NEAR(double{drawn.image.rgba[i + 3]}, expected, 1e-4 * expected);
                if (!options.shading) {
                    EXPECT_NEAR(double{drawn.image.rgba[i + 1]}, .5 * expected, 1e-4 * expected);
                }
                EXPECT_NEAR(drawn.depth[i / 4], 3.5f, 1e-2f) << "the middle of the box";
            }
        }
    }
}

}  // namespace splat_closed_form_test
}  // namespace subvol::test
