// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "render/constant_optics.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/kernel_file.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace lod_test {

View view_from(const Box& box, double distance, int size) {
    const Vec3 eye = box.center() + distance * box.diagonal() * glm::normalize(Vec3(1, -2, .7));
    return View({.eye = eye, .target = box.center(), .up = {0, 0, 1}, .fovy_deg = 30}, size, size);
}

Optics optics_of(const RbfVolume& volume) {
    const auto [low, high] = std::ranges::minmax(volume.channels[0].values);
    const double a = low, b = high, mid = .5 * (a + b);
    return Optics(
        {.color = {{a, {.1, .2, .9}}, {mid, {.9, .9, .9}}, {b, {.9, .2, .1}}}, .opacity = {{a, 0}, {mid, .3}, {b, .02}}},
        volume.bounds.diagonal() / 20);
}

double rmse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

TEST(LevelOfDetail, AtZeroPixelsAndCloseUpThePictureHasTheSameBits) {
    const RbfVolume volume = sample_rbf_points(make_model("ball", 4), {.per_edge = 2}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    for (const auto& [distance, pixels] : {std::pair{2.0, 0.0}, std::pair{.3, .5}}) {
        const View view = view_from(volume.bounds, distance, 64);
        const auto all = render_splats(volume, view, optics_of(volume), {.method = SplatMethod::Cpu}).image;
        const auto level = choose_level(hierarchy, volume, view, {.pixels = pixels});
        EXPECT_EQ(render_splats(level, view, optics_of(volume), {.method = SplatMethod::Cpu}).image.rgba, all.rgba);
        EXPECT_GT(*std::ranges::max_element(all.rgba), 0);
    }
}

TEST(LevelOfDetail, TheErrorFallsWithThePixels) {
    const RbfVolume volume = sample_rbf_points(make_model("ball", 6), {.per_edge = 4}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    const View view = view_from(volume.bounds, 2, 96);
    const SplatOptions options{.method = SplatMethod::Cpu, .sheets = 200};
    const auto all = render_splats(volume, view, optics_of(volume), options).image;
    double last = 1;
    std::size_t kernels = 0;
    for (const double pixels : {64.0, 32.0, 16.0, 8.0, 0.0}) {
        const RbfVolume level = choose_level(hierarchy, volume, view, {.pixels = pixels});
        const double error = rmse(render_splats(level, view, optics_of(volume), options).image, all);
        EXPECT_LT(error, last) << pixels;
        EXPECT_GT(level.size(), kernels) << pixels;
        last = error;
        kernels = level.size();
    }
    EXPECT_EQ(last, 0);
}

TEST(LevelOfDetail, AConstantFieldStaysThatConstant) {
    // Whatever kernels there are, normalized sums of a constant are that constant: the optical depth of a ray is its length in
    // the box, also where kernels of all sizes meet.
    HexMesh box = test::make_box(8, 8, 8);
    for (Vec3& p : box.points) p *= .25;
    test::add_field(box, "f", [](const Vec3&) { return .7; });
    const RbfVolume volume = sample_rbf_points(box, {.per_edge = 2}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    const Vec3 center = volume.bounds.center();
    const View view({.eye = center + Vec3(0, -3, 0), .target = center, .up = {0, 0, 1}, .fovy_deg = 40}, 64, 64);
    const auto draw = [&](const RbfVolume& kernels) {
        return render_splats(kernels, view, test::constant_optics(), {.method = SplatMethod::Cpu}).image;
    };
    const auto all = draw(volume);
    for (const double pixels : {20.0, 30.0, 60.0}) {  // the near half as it is, the far half merged; then all merged
        const RbfVolume level = choose_level(hierarchy, volume, view, {.pixels = pixels});
        EXPECT_LT(level.size(), volume.size());
        const auto drawn = draw(level);
        for (std::size_t i = 0; i < all.rgba.size(); ++i) {
            EXPECT_NEAR(double(drawn.rgba[i]), double(all.rgba[i]), 4e-6) << pixels;  // float rounding of 200 products
        }
    }
}

TEST(LevelOfDetail, ASplatterTakesOtherKernels) {
    const RbfVolume volume = sample_rbf_points(make_model("ball", 4), {.per_edge = 2}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    const View view = view_from(volume.bounds, 3, 48);
    const RbfVolume few = choose_level(hierarchy, volume, view, {.pixels = 8});
    ASSERT_LT(few.size(), volume.size());
    const Clip clip{.planes = {{.point = volume.bounds.center(), .normal = {1, 0, 0}}}};
    for (const SplatMethod method : {SplatMethod::Cpu, SplatMethod::Gl}) {
        if (method == SplatMethod::Gl && !find_gl_device({})) {
            std::puts("no OpenGL 4.5 through EGL: its part is skipped");
            continue;
        }
        for (const bool shadows : {false, true}) {
            if (shadows && method == SplatMethod::Gl) continue;  // software takes long for them
            const SplatOptions options{.method = method, .shading = Shading{}, .clip = clip, .shadows = shadows};
            Splatter splatter(volume, options);
            const auto all = splatter.draw(view, optics_of(volume)).image;
            splatter.set_kernels(few);
            EXPECT_EQ(splatter.draw(view, optics_of(volume)).image.rgba,
                      render_splats(few, view, optics_of(volume), options).image.rgba);
            splatter.set_kernels(volume);
            EXPECT_EQ(splatter.draw(view, optics_of(volume)).image.rgba, all.rgba);
        }
    }
    RbfVolume other = few;
    other.channels[0].name = "other";
    Splatter splatter(volume, {.method = SplatMethod::Cpu});
    EXPECT_THROW(splatter.set_kernels(other), Error);
    other = few;
    other.boundary = {};
    EXPECT_THROW(splatter.set_kernels(other), Error);
}

class LevelsInFiles : public test::TempFolder {};

// A dolly whose kernels come from a file, with little and with much that is kept from frame to frame.
TEST_F(LevelsInFiles, GiveThePicturesOfThoseInMemory) {
    const RbfVolume volume = sample_rbf_points(make_model("ball", 4), {.per_edge = 4}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    write_kernel_file(path("a.svk"), volume);
    const SplatOptions options{.method = SplatMethod::Cpu};
    std::vector<std::uint64_t> read;
    for (const std::uint64_t kept : {std::uint64_t{0}, std::uint64_t{1} << 18, std::uint64_t{1} << 30}) {
        KernelFile file(path("a.svk"), kept);
        std::optional<Splatter> splatter;
        RbfVolume shown;
        for (const double distance : {.6, 1.0, 2.0, 4.0, 9.0, 30.0, 5.0, 1.0}) {
            const View view = view_from(volume.bounds, distance, 48);
            shown = file.choose_level(view, {.pixels = 2}).volume;
            if (splatter) splatter->set_kernels(shown);
            if (!splatter) splatter.emplace(shown, options);
            const RbfVolume expected = choose_level(hierarchy, volume, view, {.pixels = 2});
            EXPECT_EQ(splatter->draw(view, optics_of(volume)).image.rgba,
                      render_splats(expected, view, optics_of(volume), options).image.rgba);
        }
        read.push_back(file.bytes_read());
    }
    EXPECT_GE(read[0], read[1]);
    EXPECT_GT(read[1], read[2]);
}

TEST(LevelOfDetail, PlainSumsKeepTheMean) {
    // Kernels that add up as they are have the mean of the field, because merged kernels have the mass of those they stand for.
    HexMesh box = test::make_box(12, 12, 12);
    test::add_field(box, "f", [](const Vec3&) { return .5; });
    const RbfVolume volume = sample_rbf_points(box, {.per_edge = 2}).volume;
    const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
    const auto mass_of = [](const RbfVolume& kernels) {
        double sum = 0;
        for (std::size_t i = 0; i < kernels.size(); ++i) {
            sum += std::sqrt(glm::determinant(matrix(kernels.frames[i]))) * double(kernels.channels[0].values[i]);
        }
        return sum;
    };
    const View view = view_from(volume.bounds, 3, 64);
    for (const double pixels : {6.0, 12.0, 60.0}) {
        const RbfVolume level = choose_level(hierarchy, volume, view, {.pixels = pixels});
        EXPECT_LT(level.size(), volume.size());
        EXPECT_NEAR(mass_of(level), mass_of(volume), 1e-5 * mass_of(volume));  // frames are floats
    }
}

}  // namespace lod_test
}  // namespace subvol
