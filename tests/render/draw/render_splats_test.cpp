// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "lib/test_meshes.h"
#include "render/image_differences.h"
#include "subvol/error.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace render_splats_test {

using test::largest_difference;

Optics constant_optics(double alpha, double unit, const Vec3& color = {1, .5, .25}) {
    return Optics({.color = {{0, color}, {1, color}}, .opacity = {{0, alpha}, {1, alpha}}}, unit);
}

/// Nested cubes mapped onto the unit ball: irregular inside, curved outside.
HexMesh make_ball(Index n) {
    HexMesh mesh = test::make_nested_cubes(n);
    for (auto& p : mesh.points) {
        const double cube = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (cube > 0) p *= (1 - cube) + cube * cube / glm::length(p);
    }
    return mesh;
}

RbfVolume sample(const HexMesh& mesh, int per_edge = 1) {
    return sample_rbf_points(mesh, {.per_edge = per_edge}).volume;
}

Camera orthographic(double height, const Vec3& eye = {2, -10, 2}) {
    return {.eye = eye, .target = eye + Vec3(0, 1, 0), .up = {0, 0, 1}, .ortho_height = height};
}

std::vector<SplatMethod> methods() {
    std::vector<SplatMethod> result{SplatMethod::Cpu};
    HexMesh box = test::make_box(2, 2, 2);
    test::add_field(box, "f", [](const Vec3&) { return 1.0; });
    try {
        (void)render_splats(sample(box), View(orthographic(1), 8, 8), constant_optics(.5, 1), {.method = SplatMethod::Gl});
        result.push_back(SplatMethod::Gl);
    } catch (const Error& error) {
        std::printf("no GL here, its part is skipped: %s\n", error.what());
    }
    return result;
}

TEST(RenderSplats, AConstantFieldIsExactlyThatConstant) {
    // A slab seen straight on: alpha = 1 − exp(−τL) everywhere in the box, however kernels overlap; colours are premultiplied.
    HexMesh box = test::make_box(4, 3, 4);
    test::add_field(box, "f", [](const Vec3&) { return .7; });
    const double alpha = 1 - std::pow(1 - .3, 3 / 1.5);
    for (const SplatMethod method : methods()) {
        const auto image =
            render_splats(sample(box), View(orthographic(6), 64, 64), constant_optics(.3, 1.5), {.method = method}).image;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const bool inside = x >= 11 && x < 53 && y >= 11 && y < 53;  // the box covers pixels 10.67 to 53.33
                EXPECT_NEAR(image.pixel(x, y)[3], inside ? alpha : 0, 2e-6) << x << ' ' << y;  // float rounding of 200 products
                EXPECT_NEAR(image.pixel(x, y)[1], inside ? .5 * alpha : 0, 2e-6) << x << ' ' << y;
            }
        }
    }
}

TEST(RenderSplats, ABallHasItsClosedFormOpticalDepth) {
    HexMesh ball = make_ball(8);
    test::add_field(ball, "f", [](const Vec3&) { return .5; });
    const View view({.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2.4}, 96, 96);
    const auto image = render_splats(sample(ball), view, constant_optics(.5, 1), {.method = SplatMethod::Cpu}).image;
    for (int y = 0; y < 96; ++y) {
        for (int x = 0; x < 96; ++x) {
            const Vec2 p = view.slopes(x + .5, y + .5);
            const double b2 = p.x * p.x + p.y * p.y;
            if (b2 > .97) continue;  // near the silhouette, which is made of facets
            const double chord = 2 * std::sqrt(1 - b2);
            // The refined boundary's facets have sides h ≤ .16 and lie up to h²/4 = .0064 inside the sphere: twice that in
            // chord length, over the cosine of the angle to the surface.
            EXPECT_NEAR(image.pixel(x, y)[3], 1 - std::pow(.5, chord), 2 * .0064 * std::numbers::ln2 / std::sqrt(1 - b2));
        }
    }
}

TEST(RenderSplats, BackendsDrawTheSameImage) {
    HexMesh ball = make_ball(4);
    test::add_field(ball, "f", [](const Vec3& p) { return .5 + .4 * std::sin(3 * p.x) * std::cos(2 * p.y) + .1 * p.z; });
    const Optics optics({.color = {{0, {0, 0, 1}}, {1, {1, 0, 0}}}, .opacity = {{0, 0}, {.4, .1}, {.5, .9}, {.6, .1}, {1, .3}}},
                        .3);
    const View view({.eye = {2, -3, 1.5}, .target = {0, 0, 0}, .up = {0, 0, 1}}, 100, 90);
    if (methods().size() == 1) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    for (const Correction correction : {Correction::None, Correction::Second, Correction::Full}) {
        const RbfVolume volume = sample_rbf_points(ball, {.correction = correction}).volume;
        const auto cpu = render_splats(volume, view, optics, {.method = SplatMethod::Cpu}).image;
        const auto gl = render_splats(volume, view, optics, {.method = SplatMethod::Gl}).image;
        // The same operations with other rounding: float sums on 200 sheets.
        EXPECT_LT(largest_difference(cpu, gl), 1e-4);
        double sum = 0;
        for (const float v : cpu.rgba) sum += v;
        EXPECT_GT(sum, 1000) << "the ball is in the picture";
    }
}

TEST(RenderSplats, TheImageDoesNotDependOnTheNumberOfThreads) {
    HexMesh ball = make_ball(4);
    test::add_field(ball, "f", [](const Vec3& p) { return .5 + .5 * std::sin(4 * p.x + p.y * p.z); });
    const View view({.eye = {2, -3, 1.5}, .target = {0, 0, 0}, .up = {0, 0, 1}}, 80, 80);
    const auto draw = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return render_splats(sample(ball), view, constant_optics(.4, .2), {.method = SplatMethod::Cpu}).image;
    };
    EXPECT_EQ(draw(1).rgba, draw(4).rgba);
}

TEST(RenderSplats, AHoleLetsTheBackgroundThrough) {
    // A ring of cells around a square hole: a ray through the hole sees nothing, one beside it sees the ring, one across it
    // sees two walls.
    HexMesh ring = test::make_box(3, 3, 1);
    ring.cells.erase(ring.cells.begin() + 4);
    test::add_field(ring, "f", [](const Vec3&) { return .5; });
    const auto optics = constant_optics(.5, 1);
    const auto volume =
        sample_rbf_points(ring, {.scheme = {.crease_angle_deg = 45}}).volume;  // smooth edges would round the hole
    const View through({.eye = {1.5, 1.5, 10}, .target = {1.5, 1.5, 0}, .up = {0, 1, 0}, .ortho_height = 4}, 40, 40);
    const auto above = render_splats(volume, through, optics, {.method = SplatMethod::Cpu}).image;
    EXPECT_EQ(above.pixel(20, 20)[3], 0);
    EXPECT_NEAR(above.pixel(8, 20)[3], .5, 5e-6);  // depths are floats near 10: 1e-6 each
    const View across({.eye = {1.5, -10, .5}, .target = {1.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = 2}, 40, 40);
    const auto side = render_splats(volume, across, optics, {.method = SplatMethod::Cpu}).image;
    EXPECT_NEAR(side.pixel(20, 20)[3], .75, 2e-6);
}

TEST(RenderSplats, ThePictureFromInsideStartsAtTheEye) {
    HexMesh box = test::make_box(4, 4, 4);
    test::add_field(box, "f", [](const Vec3&) { return .5; });
    const View view({.eye = {2, 1, 2}, .target = {2, 4, 2}, .up = {0, 0, 1}}, 33, 33);
    const auto image = render_splats(sample(box), view, constant_optics(.5, 1), {.method = SplatMethod::Cpu}).image;
    EXPECT_NEAR(image.pixel(16, 16)[3], 1 - std::pow(.5, 3), 1e-3);  // the near plane is 1e-4 of the diagonal away
}

TEST(RenderSplats, HalvingTheSheetDistanceQuartersTheError) {
    HexMesh box = test::make_box(6, 6, 6);
    test::add_field(box, "f", [](const Vec3& p) { return .5 + .4 * std::sin(1.1 * p.x) * std::cos(.9 * p.y + .4 * p.z); });
    const RbfVolume volume = sample(box);
    const Optics optics({.color = {{0, {0, 0, 1}}, {1, {1, 0, 0}}}, .opacity = {{0, 0}, {1, .5}}}, 1);
    const View view({.eye = {15, -12, 9}, .target = {3, 3, 3}, .up = {0, 0, 1}, .fovy_deg = 30}, 64, 64);
    const auto draw = [&](int sheets) {
        return render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .sheets = sheets}).image;
    };
    const auto exact = draw(1025);
    const auto rmse = [&](const Image& image) {
        double sum = 0;
        for (std::size_t i = 0; i < image.rgba.size(); ++i) sum += std::pow(double(image.rgba[i]) - double(exact.rgba[i]), 2);
        return std::sqrt(sum / double(image.rgba.size()));
    };
    const double coarse = rmse(draw(33)), fine = rmse(draw(65));
    EXPECT_GT(coarse / fine, 3.0);  // second order would be 4; entries and exits between sheets reduce it a little
    EXPECT_LT(fine, 1e-3);
}

TEST(RenderSplats, ValuesBeyondTheKnotsKeepTheEndsOpacity) {
    // The knots are far above the values of a steep field: nothing is visible. Then far below: the last opacity everywhere.
    HexMesh box = test::make_box(3, 3, 3);
    test::add_field(box, "f", [](const Vec3& p) { return p.x + p.y; });
    const RbfVolume volume = sample(box);
    const std::vector<TransferFunction::ColorKnot> white{{10, {1, 1, 1}}};
    for (const SplatMethod method : methods()) {
        const auto draw = [&](double low, double a0, double a1) {
            const Optics optics({.color = white, .opacity = {{low, a0}, {low + 1, a1}}}, 1);
            return render_splats(volume, View(orthographic(4), 20, 20), optics, {.method = method}).image;
        };
        EXPECT_EQ(draw(10, 0, .9).pixel(10, 10)[3], 0);
        EXPECT_NEAR(draw(-20, .9, .5).pixel(10, 10)[3], 1 - std::pow(.5, 3), 1e-5);  // float quotients of differences
    }
}

TEST(RenderSplats, ASmallRangeBesideALargeValueIsDrawn) {
    // The same field, once from 0 to 1 and once from 4096 to 4097: sums over kernels must not lose digits that the values have.
    HexMesh box = test::make_box(3, 3, 3);
    const View view(orthographic(4), 24, 24);
    for (const SplatMethod method : methods()) {
        const auto draw = [&](double offset) {
            box.attributes.clear();
            test::add_field(box, "f", [&](const Vec3& p) { return offset + (p.x + p.y) / 6; });
            const Optics optics(
                {.color = {{offset, {0, 0, 1}}, {offset + 1, {1, 0, 0}}}, .opacity = {{offset, 0}, {offset + 1, .5}}}, 1);
            return render_splats(sample(box), view, optics, {.method = method}).image;
        };
        // Floats near 4096 are 1/2048 apart: values are rounded to 2.4e-4 of the range, in which opacity and colour have slopes
        // of at most 2 over the depth of the box.
        EXPECT_LT(largest_difference(draw(0), draw(4096)), 5e-4);
    }
}

TEST(RenderSplats, TheUnitOfLengthDoesNotMatterWithinFloats) {
    const auto draw = [](double unit) {
        HexMesh box = test::make_box(3, 3, 3);
        test::add_field(box, "f", [](const Vec3& p) { return p.x / 3; });
        for (auto& p : box.points) p *= unit;
        Camera camera = orthographic(4 * unit);
        camera.eye *= unit;
        camera.target *= unit;
        return render_splats(sample(box), View(camera, 16, 16), constant_optics(.5, unit), {.method = SplatMethod::Cpu}).image;
    };
    const Image one = draw(1);
    for (const double unit : {1e-9, 1e9, 1e15}) EXPECT_LT(largest_difference(one, draw(unit)), 1e-4) << unit;  // float depths
    for (const double unit : {1e-20, 1e20}) EXPECT_THROW((void)draw(unit), Error) << unit;
}

TEST(RenderSplats, RefusesNumbersBeyondFloats) {
    HexMesh box = test::make_box(2, 2, 2);
    const View view(orthographic(4), 8, 8);
    const auto draw = [&](double low, double high, double unit) {
        box.attributes.clear();
        test::add_field(box, "f", [&](const Vec3& p) { return low + (high - low) * p.x / 2; });
        const Optics optics({.color = {{low, {1, 1, 1}}, {high, {1, 1, 1}}}, .opacity = {{low, 0}, {high, .5}}}, unit);
        return render_splats(sample(box), view, optics, {.method = SplatMethod::Cpu}).image;
    };
    EXPECT_GT(draw(0, 1e30, 1).pixel(2, 5)[3], .1);
    EXPECT_THROW((void)draw(0, 1e39, 1), Error);
    EXPECT_THROW((void)draw(0, 1e-39, 1), Error);
    EXPECT_THROW((void)draw(0, 1, 1e-300), Error);
    EXPECT_THROW((void)draw(2e11, 2e11 + 1, 1), Error);  // floats there are 16384 apart
}

Optics ramp(double low, double high, double alpha) {
    return Optics({.color = {{low, {.1, .2, .9}}, {high, {.9, .8, .1}}}, .opacity = {{low, 0}, {high, alpha}}}, .2);
}

TEST(RenderSplats, ColoursAreChangedWithoutPreparingTheViewAgain) {
    HexMesh ball = make_ball(3);
    test::add_field(ball, "f", [](const Vec3& p) { return p.x + .3 * std::sin(4 * p.y); });
    test::add_field(ball, "g", [](const Vec3& p) { return p.z; });
    const RbfVolume volume = sample(ball);
    const View front(orthographic(2.4, {0.1, -10, 0.2}), 60, 45);
    const View side({.eye = {4, -3, 1}, .target = {}, .up = {0, 0, 1}}, 60, 45);
    const Clip half{.planes = {{.point = {0, 0, .2}, .normal = {0, 0, 1}}}}, slice{.slices = {{.normal = {0, 1, 0}}}};
    struct Step {
        View view;
        Optics optics;
        Clip clip;
        bool kept;
    };
    // Of a view that has been seen twice, values on sheets are kept as deep as light came; then it comes deeper, and less deep.
    const std::vector<Step> steps{
        {front, ramp(-1, 1, .5), {}, false},  {front, ramp(-1, 1, .999), {}, true},   {front, ramp(-1, 1, .1), {}, true},
        {front, ramp(-1, 1, .3), {}, true},   {front, ramp(-.5, 1, .999), {}, false}, {side, ramp(-.5, 1, .2), {}, false},
        {side, ramp(-.5, 1, .7), {}, true},   {side, ramp(-.5, 1, .7), half, false},  {side, ramp(-.5, 1, .3), half, true},
        {side, ramp(-.5, 1, .4), half, true}, {side, ramp(-.5, 1, .3), slice, false}};
    const std::vector<SplatOptions> kinds{{.method = SplatMethod::Cpu},
                                          {.method = SplatMethod::Cpu, .shading = Shading{}},
                                          {.method = SplatMethod::Cpu, .color_channel = 1, .shadows = true},
                                          {.method = SplatMethod::Cpu, .samples = 2, .image_tolerance = 1e-5}};
    for (const SplatOptions& kind : kinds) {
        Splatter splatter(volume, kind);
        for (const Step& step : steps) {
            splatter.set_clip(step.clip);
            const SplatResult drawn = splatter.draw(step.view, step.optics);
            SplatOptions options = kind;
            options.clip = step.clip;
            const SplatResult anew = render_splats(volume, step.view, step.optics, options);
            EXPECT_EQ(drawn.image.rgba, anew.image.rgba);
            EXPECT_EQ(drawn.depth, anew.depth);
            EXPECT_EQ(drawn.report.kept, step.kept);
        }
        RbfVolume other = volume;
        for (float& value : other.channels[0].values) value = -value;
        splatter.set_kernels(other);
        const Step& last = steps.back();
        EXPECT_FALSE(splatter.draw(last.view, last.optics).report.kept) << "these kernels are others";
    }
}

TEST(RenderSplats, SamplesAreTheMeanOfAFinerPicture) {
    HexMesh ball = make_ball(3);
    test::add_field(ball, "f", [](const Vec3& p) { return p.x; });
    const RbfVolume volume = sample(ball);
    const Camera camera = orthographic(2.4, {0.1, -10, 0.2});
    const auto optics = constant_optics(.5, 1);
    for (const SplatMethod method : methods()) {
        const auto fine = render_splats(volume, View(camera, 60, 45), optics, {.method = method});
        const auto drawn = render_splats(volume, View(camera, 20, 15), optics, {.method = method, .samples = 3});
        ASSERT_EQ(drawn.image.width, 20);
        ASSERT_EQ(drawn.depth.size(), 20u * 15);
        int rim = 0;
        for (int y = 0; y < 15; ++y) {
            for (int x = 0; x < 20; ++x) {
                double alpha = 0, depth = 0;
                for (int k = 0; k < 9; ++k) {
                    const int i = 3 * x + k % 3, j = 3 * y + k / 3;
                    const double one = fine.image.pixel(i, j)[3];
                    const float at = fine.depth[static_cast<std::size_t>(60 * j + i)];
                    if (std::isfinite(at)) depth += one * at;
                    alpha += one;
                }
                const float got = drawn.depth[static_cast<std::size_t>(20 * y + x)];
                EXPECT_NEAR(drawn.image.pixel(x, y)[3], alpha / 9, 1e-7);  // rounding to float
                EXPECT_EQ(std::isfinite(got), alpha > 0);
                if (alpha > 0) {
                    EXPECT_NEAR(got, depth / alpha, 1e-5);
                }
                rim += alpha > 0 && fine.image.pixel(3 * x, 3 * y)[3] == 0 ? 1 : 0;
            }
        }
        EXPECT_GT(rim, 5) << "some pixels are covered in part";
    }
}

TEST(RenderSplats, RefusesWhatItCannotDraw) {
    HexMesh box = test::make_box(2, 2, 2);
    test::add_field(box, "f", [](const Vec3&) { return 1.0; });
    RbfVolume volume = sample(box);
    const View view(orthographic(4), 8, 8);
    const auto optics = constant_optics(.5, 1);
    EXPECT_THROW((void)render_splats(volume, view, optics, {.sheets = 1}), Error);
    EXPECT_THROW((void)render_splats(volume, view, optics, {.samples = 17}), Error);
    EXPECT_THROW((void)render_splats(volume, view, optics, {.channel = 1}), Error);
    volume.kernel = TableKernel{.radius = 1, .count = 2, .values = {1, .5, .5, .5, .5, .5, .5, 0}};
    EXPECT_THROW((void)render_splats(volume, view, optics, {.method = SplatMethod::Cpu}), Error);
    volume.kernel = CompactKernel{};
    for (auto& g : volume.channels[0].gradients) g = {};
    volume.channels[0].values[0] = 2;
    EXPECT_NO_THROW((void)render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .shading = Shading{}}));
    volume.boundary = {};  // without it, light needs gradients
    EXPECT_THROW((void)render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .shading = Shading{}}), Error);
}

}  // namespace render_splats_test
}  // namespace subvol
