// SPDX-License-Identifier: Apache-2.0
// Shadows and ambient occlusion against closed forms and marched shadow rays.
#include <gtest/gtest.h>

#include "lib/expect_error.h"
#include "splat_scenes.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_shadow_test {

/// A light from above in pictures whose `up` is +z, and no other.
const Shading kFromAbove{.ambient = 0, .diffuse = 0, .specular = 0, .key = {0, 1, 0}};

std::vector<SplatMethod> methods() {
    std::vector<SplatMethod> all{SplatMethod::Cpu};
    if (!gl_devices().empty()) all.push_back(SplatMethod::Gl);
    return all;
}

HexMesh block(const std::function<double(const Vec3&)>& field) {
    HexMesh mesh = jittered_box_about_origin();
    add_field(mesh, "f", field);
    return mesh;
}

View from_the_side(int size) {
    return {{.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2}, size, size};
}

/// White; extinction ln 2 where |value| > .5, nothing in between.
Optics two_slabs() {
    return Optics({.color = {{0, {1, 1, 1}}}, .opacity = {{-.501, .5}, {-.499, 0}, {.499, 0}, {.501, .5}}}, 1);
}

/// A view in which the key light of `Shading{}` comes along +z of the world.
View lit_from_above(int size) {
    const Vec3 key = glm::normalize(Shading{}.key), z(0, 0, 1);
    const Vec3 forward(std::sqrt(1 - key.z * key.z), 0, key.z), along = glm::normalize(z - key.z * forward);
    const double flat = std::hypot(key.x, key.y);
    const Vec3 up = (key.y * along - key.x * glm::cross(forward, along)) / flat;
    return {{.eye = -6.0 * forward, .target = {0, 0, 0}, .up = up, .ortho_height = 2.5}, size, size};
}

TEST(SplatShadows, ASlabAboveASlabTakesItsShareOfTheLight) {
    const RbfVolume volume = sample_rbf_points(block([](const Vec3& p) { return p.z; })).volume;
    const View view = lit_from_above(24);
    ASSERT_NEAR(glm::dot(view.axes()[0], Vec3(0, 0, 1)), glm::normalize(Shading{}.key).x, 1e-12);
    const Optics optics = two_slabs();
    constexpr double kStep = .005;
    for (const SplatMethod method : methods()) {
        const Image image = render_splats(volume, view, optics, {.method = method, .shadows = true}).image;
        double sum = 0;
        for (int y = 0; y < 24; ++y) {
            for (int x = 0; x < 24; ++x) {
                const Ray ray = view.ray(x + .5, y + .5);
                Segment seen;
                for (double t = 4 + kStep / 2; t < 8; t += kStep) {
                    const Vec3 p = ray.origin + t * ray.direction;
                    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 1) continue;
                    const double above = p.z > .5 ? 1 - p.z : p.z > -.5 ? .5 : .5 + (-.5 - p.z);  // of the two slabs
                    Segment part = optics.integrate(p.z, p.z, kStep);
                    part.color *= .3 + .7 * std::pow(.5, above);
                    composite(seen, part);
                }
                sum += std::pow(static_cast<double>(image.pixel(x, y)[1]) - seen.color[1], 2);
            }
        }
        // Linear between nodes (.028 apart), and so not within a node of the sides, where single pixels differ by up to .06.
        EXPECT_LT(std::sqrt(sum / (24 * 24)), .006);
    }
}

TEST(SplatShadows, LightFromTheEyeIsAbsorbedTwice) {
    const RbfVolume volume = sample_rbf_points(block([](const Vec3&) { return 1; })).volume;
    const Optics white({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .5}}}, 1);
    Shading shading = kFromAbove;
    shading.key = {0, 0, -1};
    const Image image =
        render_splats(volume, from_the_side(20), white, {.method = SplatMethod::Cpu, .shading = shading, .shadows = true})
            .image;
    EXPECT_NEAR(image.pixel(10, 10)[0], .5 * (1 - std::pow(.5, 4)), .01);  // ∫ τ exp(-2 τ s) ds
    EXPECT_NEAR(image.pixel(10, 10)[3], 1 - std::pow(.5, 2), 1e-3) << "opacities stay";
}

TEST(SplatShadows, PicturesAreThoseOfMarchedShadowRays) {
    const auto field = [](const Vec3& p) { return .5 + .3 * p.x - .15 * p.y + .05 * p.z; };
    const RbfVolume volume = sample_rbf_points(block(field)).volume;
    const Optics optics({.color = {{0, {.2, .4, 1}}, {1, {1, .6, .2}}}, .opacity = {{0, 0}, {1, .6}}}, .5);
    const View view(perspective_camera(), 20, 20);
    const auto inside = [](const Vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1; };
    const Vec3 key = glm::normalize(Shading{}.key);
    const auto& [right, up, forward] = view.axes();
    const Vec3 to_light = key.x * right + key.y * up + key.z * forward;
    constexpr double kStep = .02;
    const auto light_at = [&](const Vec3& p) {
        double depth = 0;
        for (double s = kStep / 2; inside(p + s * to_light); s += kStep)
            depth += kStep * optics.extinction(field(p + s * to_light));
        return .3 + .7 * std::exp(-depth);
    };
    for (const SplatMethod method : methods()) {
        const Image drawn = render_splats(volume, view, optics, {.method = method, .shadows = true}).image;
        double sum = 0;
        for (int y = 0; y < 20; ++y) {
            for (int x = 0; x < 20; ++x) {
                const Ray ray = view.ray(x + .5, y + .5);
                const double length = kStep * glm::length(ray.direction);
                Segment seen;
                for (double t = 2; t < 9; t += kStep) {
                    const Vec3 p = ray.origin + (t + kStep / 2) * ray.direction;
                    if (!inside(p)) continue;
                    Segment part = optics.integrate(field(p), field(p), length);
                    part.color *= light_at(p);
                    composite(seen, part);
                }
                for (int c = 0; c < 3; ++c)
                    sum += std::pow(static_cast<double>(drawn.pixel(x, y)[static_cast<std::size_t>(c)]) - seen.color[c], 2);
            }
        }
        const double rms = std::sqrt(sum / (3 * 400));
        RecordProperty("rms", std::to_string(rms));
        EXPECT_LT(rms, .006);  // steps of .02 at the entry alone make .003
    }
}

TEST(AmbientOcclusion, AGrooveIsDarkerThanTheFlatsBesideIt) {
    HexMesh mesh = lattice({5, 5, 3}, [](Index i, Index, Index k) { return i != 2 || k == 0; });
    for (Vec3& p : mesh.points) p.z *= .8;
    add_field(mesh, "f", [](const Vec3&) { return 1; });
    const RbfVolume volume = sample_rbf_points(mesh, {.scheme = {.kind = Scheme::Linear}, .per_edge = 2}).volume;
    const Optics solid({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 1}}}, 1e-6);
    const View view({.eye = {.5, .5, 5}, .target = {.5, .5, 0}, .up = {0, 1, 0}, .ortho_height = 1}, 50, 50);
    for (const SplatMethod method : methods()) {
        const auto draw = [&](double occlusion) {
            return render_splats(volume, view, solid, {.method = method, .shading = Shading{}, .ambient_occlusion = occlusion})
                .image;
        };
        const Image plain = draw(0), dark = draw(.2);
        const auto share = [&](int x, int y) { return static_cast<double>(dark.pixel(x, y)[0] / plain.pixel(x, y)[0]); };
        EXPECT_GT(share(8, 25), .85) << "flat";
        EXPECT_LT(share(25, 25), .75) << "groove";
        EXPECT_EQ(dark.pixel(8, 25)[3], plain.pixel(8, 25)[3]);
    }
}

TEST(AmbientOcclusion, AThinHazeStaysAsItIs) {
    const RbfVolume volume = sample_rbf_points(block([](const Vec3& p) { return .5 + .2 * p.x; })).volume;
    const Optics haze({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {1, .05}}}, 1);
    const View view(perspective_camera(), 24, 24);
    const Image plain = render_splats(volume, view, haze, {.method = SplatMethod::Cpu}).image;
    const Image open = render_splats(volume, view, haze, {.method = SplatMethod::Cpu, .ambient_occlusion = .1}).image;
    EXPECT_LT(largest_difference(plain, open), 1e-6);
}

TEST(SplatShadows, WhatCannotBeDrawnIsRefused) {
    const RbfVolume volume = sample_rbf_points(block([](const Vec3&) { return 1; })).volume;
    expect_error(ErrorCode::InvalidInput, "ambient_occlusion: 1.5 is out of range",
                 [&] { Splatter(volume, {.ambient_occlusion = 1.5}); });
    expect_error(ErrorCode::InvalidInput, "sheet buffers",
                 [&] { Splatter(volume, {.method = SplatMethod::Sheets, .shadows = true}); });
}

}  // namespace splat_shadow_test
}  // namespace subvol::test
