// SPDX-License-Identifier: Apache-2.0
// Volumes that are cut open: every renderer against a field with a closed form, and against itself.
#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "reference_methods.h"
#include "subvol/boundary_shading.h"
#include "subvol/render_field.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace clip_test {

/// The methods of the command.
enum class Method { Tets, Dense, Grid, Pt, Lists, Havs, Cpu, Gl, Sheets };
const std::vector<Method> kMethods{Method::Tets, Method::Dense, Method::Grid, Method::Pt,    Method::Lists,
                                   Method::Havs, Method::Cpu,   Method::Gl,   Method::Sheets};
const std::vector<std::string> kNames{"Tets", "Dense", "Grid", "Pt", "Lists", "Havs", "Cpu", "Gl", "Sheets"};

bool splats(Method method) {
    return method >= Method::Cpu;
}

constexpr int kVoxels = 16;
const Box kBlock{{-1, -1, -1}, {1, 1, 1}};

/// From 0 to 1, in a direction that is along no axis.
double linear(const Vec3& p) {
    return 0.5 + 0.25 * p.x - 0.15 * p.y + 0.1 * p.z;
}

/// A grid's voxels end half a voxel beyond the outermost centres, with constant values there.
Vec3 between_centres(Method method, const Vec3& p) {
    const double rim = method == Method::Grid ? 1.0 / kVoxels : 0;
    return glm::clamp(p, kBlock.lower + rim, kBlock.upper - rim);
}

/// The block, its inner points moved.
HexMesh box_about_origin() {
    HexMesh mesh = test::jittered_box(4, .2, 3);
    for (Vec3& p : mesh.points) p = 2.0 * p - 1.0;
    return mesh;
}

const Camera kPerspective{.eye = {2.6, -4.2, 2.0}, .target = {.05, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 36};
const Camera kOrthographic{.eye = {3, -4, 2.5}, .target = {0, .03, 0}, .up = {0, 0, 1}, .ortho_height = 3.2};

Optics smooth_optics() {
    return Optics({.color = {{0, {.1, .2, .9}}, {.5, {.9, .9, .3}}, {1, {.9, .2, .1}}}, .opacity = {{0, 0}, {1, .5}}}, .5);
}

HexMesh block_mesh() {
    HexMesh mesh = box_about_origin();
    test::add_field(mesh, "f", linear);
    return mesh;
}

/// A mesh whose field is `linear`; of voxels those of its box.
Image draw(Method method, const HexMesh& mesh, const View& view, const Optics& optics, const Clip& clip) {
    const auto pt = [&](ProjectedOrder order) {
        return render_projected(mesh, {}, view, optics, {.order = order, .kbuffer = 64, .clip = clip}).image;
    };
    const auto splat = [&](SplatMethod way) {
        return render_splats(sample_rbf_points(mesh, {.per_edge = 2}).volume, view, optics, {.method = way, .clip = clip})
            .image;
    };
    switch (method) {
        case Method::Tets:
            return render_tets(mesh, {}, view, optics, {.clip = clip}).image;
        case Method::Dense:
            return render_dense(mesh, {}, view, optics, {.levels = 1, .clip = clip}).image;
        case Method::Grid:
            return render_grid(test::VoxelBox(bounds(mesh), kVoxels, linear), view, optics, {.clip = clip, .tolerance = 1e-6})
                .image;
        case Method::Pt:
            return pt(ProjectedOrder::Topological);
        case Method::Lists:
            return pt(ProjectedOrder::Lists);
        case Method::Havs:
            return pt(ProjectedOrder::Havs);
        case Method::Cpu:
            return splat(SplatMethod::Cpu);
        case Method::Gl:
            return splat(SplatMethod::Gl);
        case Method::Sheets:
            return splat(SplatMethod::Sheets);
    }
    return {};
}

Image draw(Method method, const View& view, const Optics& optics, const Clip& clip) {
    return draw(method, block_mesh(), view, optics, clip);
}

struct Cut {
    const char* name;
    Clip clip;
};

std::vector<Cut> cuts() {
    const CutPlane slanted{{0.1, 0, 0}, {1, -0.5, 0.3}}, level{{0, 0, 0.2}, {0, -0.3, 2}};
    const Box box{{-0.5, -1.5, -0.7}, {0.6, 0.4, 0.8}};
    return {{"none", {}},
            {"clip", {.planes = {slanted}}},
            {"two planes", {.planes = {slanted, level}}},
            {"box", {.box = box}},
            {"slices", {.slices = {slanted, level}}},
            {"slice in the volume", {.slices = {slanted}, .around_slices = true}},
            {"all", {.planes = {level}, .box = box, .slices = {slanted}, .around_slices = true}}};
}

std::vector<View> views() {
    return {{kPerspective, 40, 36}, {kOrthographic, 36, 40}};
}

class Clips : public testing::TestWithParam<Method> {
protected:
    void SetUp() override {
        if (GetParam() > Method::Grid && GetParam() != Method::Cpu && gl_devices().empty())
            GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

TEST_P(Clips, PicturesAreThoseOfTheFieldCutExactlyThere) {
    // Rays in double or single precision; kernels represent a linear field between boundaries to a few parts in 1e4.
    const double tolerance = splats(GetParam()) ? 4e-3 : 2e-5;
    for (const auto& [name, clip] : cuts()) {
        for (const View& view : views()) {
            const Optics optics = smooth_optics();
            const auto field = [](const Vec3& p) { return std::optional(linear(between_centres(GetParam(), p))); };
            const Image expected = render_field(field, kBlock, view, optics, {.step_world = 1e-3, .clip = clip});
            const Image drawn = draw(GetParam(), view, optics, clip);
            const double error = test::largest_difference(drawn, expected);
            RecordProperty(std::string(name) + (view.perspective() ? ", perspective" : ""),
                           std::to_string(1e6 * error) + "e-6");
            EXPECT_LT(error, tolerance) << name << (view.perspective() ? ", perspective" : ", orthographic");
        }
    }
}

TEST_P(Clips, APlaneThatMissesTheVolumeChangesNoBit) {
    const View view = views()[0];
    const Clip far{.planes = {{{1.01, 0, 0}, {1, 0, 0}}, {{0, 0, -3}, {0.1, 0, -1}}}, .box = Box{{-2, -2, -2}, {2, 2, 2}}};
    const Image cut = draw(GetParam(), view, smooth_optics(), far);
    EXPECT_EQ(cut.rgba, draw(GetParam(), view, smooth_optics(), {}).rgba);
}

TEST_P(Clips, TwoPlanesAreTheBoxBetweenThem) {
    const View view = views()[0];
    const Clip planes{.planes = {{{-0.5, 7, 1}, {-3, 0, 0}}, {{0.25, 0, 0}, {0.5, 0, 0}}}};
    const Clip box{.box = Box{{-0.5, -9, -9}, {0.25, 9, 9}}};
    EXPECT_EQ(draw(GetParam(), view, smooth_optics(), planes).rgba, draw(GetParam(), view, smooth_optics(), box).rgba);
}

TEST_P(Clips, APlaneAlongTheViewLeavesOneSideAsItWas) {
    const View view({.eye = {0, -4, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, 30, 30);
    const Image whole = draw(GetParam(), view, smooth_optics(), {});
    const Image half = draw(GetParam(), view, smooth_optics(), {.planes = {{{0, 0, 0}, {1, 0, 0}}}});
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 30; ++x) {
            for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(half.pixel(x, y)[c], x < 15 ? whole.pixel(x, y)[c] : 0);
        }
    }
}

TEST_P(Clips, SlicesHaveTheColorsOfValuesThatAreTransparent) {
    const View view = views()[1];
    const Optics invisible({.color = smooth_optics().function().color, .opacity = {{0, 0}, {1, 0}}}, 1);
    const CutPlane plane{{0.1, 0.2, 0}, {0.5, -1, 0.2}};
    for (const bool around : {false, true}) {
        const Image drawn = draw(GetParam(), view, invisible, {.slices = {plane}, .around_slices = around});
        int seen = 0;
        for (int y = 0; y < view.height(); ++y) {
            for (int x = 0; x < view.width(); ++x) {
                if (drawn.pixel(x, y)[3] == 0) continue;
                ++seen;
                const Ray ray = view.ray(x + 0.5, y + 0.5);
                const double t = glm::dot(plane.normal, plane.point - ray.origin) / glm::dot(plane.normal, ray.direction);
                const Vec3 color = invisible.color(linear(between_centres(GetParam(), ray.origin + t * ray.direction)));
                EXPECT_EQ(drawn.pixel(x, y)[3], 1.0f);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(drawn.pixel(x, y)[static_cast<std::size_t>(c)], color[c], splats(GetParam()) ? 4e-3 : 1e-5);
            }
        }
        EXPECT_GT(seen, 300);
    }
}

/// A block whose faces are at places that no float has, between 3 cells along each axis.
HexMesh shifted_block() {
    HexMesh mesh = test::make_box(3, 3, 3);
    for (Vec3& p : mesh.points) p = Vec3(.1, .2, .3) + p / 3.0;
    test::add_field(mesh, "f", linear);
    return mesh;
}

/// How far the ray of a pixel is from the outline of a slice of the box, in world units: more than 0 where it meets the slice.
double within(const Box& box, const CutPlane& slice, const Ray& ray) {
    const double t = glm::dot(slice.normal, slice.point - ray.origin) / glm::dot(slice.normal, ray.direction);
    const Vec3 place = ray.origin + t * ray.direction, inside = glm::min(place - box.lower, box.upper - place);
    double least = t > 0 ? 1e9 : -1e9;
    for (int k = 0; k < 3; ++k) {
        if (slice.normal[k] == 0) least = std::min(least, inside[k]);
    }
    return least;
}

/// Expects that the slices, and nothing else, are seen in a block of transparent values.
void expect_whole(const Image& drawn, const View& view, const std::vector<CutPlane>& slices, const std::string& name) {
    const Box box = bounds(shifted_block());
    int seen = 0, holes = 0, beside = 0;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            double most = -1e9;
            for (const CutPlane& slice : slices) most = std::max(most, within(box, slice, view.ray(x + 0.5, y + 0.5)));
            if (std::abs(most) < 1e-4) continue;  // outlines are rasterised to 1/4096 of a pixel
            seen += most > 0;
            holes += most > 0 && drawn.pixel(x, y)[3] != 1.0f;
            beside += most < 0 && drawn.pixel(x, y)[3] != 0.0f;
        }
    }
    EXPECT_GT(seen, 20) << name;
    EXPECT_EQ(holes, 0) << name << ", of " << seen;
    EXPECT_EQ(beside, 0) << name;
}

/// From above, and from below in parallel.
std::vector<View> views_of_shifted_block() {
    return {{{.eye = {2.6, -2.1, 3.4}, .target = {.6, .7, .8}, .up = {0, 0, 1}, .fovy_deg = 30}, 24, 24},
            {{.eye = {-1.1, 2.9, -1.7}, .target = {.6, .7, .8}, .up = {0, 0, 1}, .ortho_height = 2}, 24, 24}};
}

Optics transparent() {
    return Optics({.color = smooth_optics().function().color, .opacity = {{0, 0}, {1, 0}}}, 1);
}

TEST_P(Clips, SlicesOnFacesAreWhole) {
    const HexMesh mesh = shifted_block();
    const Box box = bounds(mesh);
    for (const View& view : views_of_shifted_block()) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const double place :
                 {box.lower[axis], box.upper[axis], box.lower[axis] + 1.0 / 3}) {  // the last between cells
                CutPlane slice{box.center(), Vec3(0.0)};
                slice.point[axis] = place;
                slice.normal[axis] = place < 0.7 ? -2 : 1;
                const Image drawn = draw(GetParam(), mesh, view, transparent(), {.slices = {slice}});
                expect_whole(drawn, view, {slice}, "axis " + std::to_string(axis) + " at " + std::to_string(place));
            }
        }
    }
}

TEST_P(Clips, SlicesAtOnePlaceWithEachOtherOrWithACutAreWhole) {
    const HexMesh mesh = shifted_block();
    const View view = views_of_shifted_block()[0];
    const CutPlane bottom{{.6, .7, .3}, {0, 0, 1}}, again{{-.3, 1.9, .3}, {0, 0, -.7}}, inner{{.1, 4, .77}, {0, 0, 3}};
    const CutPlane side{{.1, .7, .8}, {1, 0, 0}};
    const auto below = [](const CutPlane& plane) { return CutPlane{plane.point + Vec3(.37, .11, 0), {0, 0, -1}}; };
    const auto above = [](const CutPlane& plane) { return CutPlane{plane.point + Vec3(.53, .07, 0), {0, 0, 1}}; };
    const auto expect = [&](const Clip& clip, const char* name) {
        for (const bool around : {false, true}) {
            Clip one = clip;
            one.around_slices = around;
            expect_whole(draw(GetParam(), mesh, view, transparent(), one), view, clip.slices, name);
        }
    };
    expect({.slices = {bottom, again}}, "two on a face");
    expect({.slices = {inner, inner}}, "two inside");
    expect({.slices = {bottom, side}}, "two faces");
    expect({.planes = {below(bottom)}, .slices = {bottom}}, "a cut on the face");
    expect({.planes = {below(inner)}, .slices = {inner}}, "a cut that leaves what is above");
    expect({.planes = {above(inner)}, .slices = {inner}}, "a cut that leaves what is below");
    expect({.planes = {above(inner), below(inner)}, .slices = {inner}}, "two cuts that leave the slice alone");
    expect({.planes = {above(bottom)}, .slices = {bottom}}, "a cut that leaves only the face");
}

TEST(FieldClips, SlicesOnFacesAreWhole) {
    const Box box = bounds(shifted_block());
    const auto field = [&](const Vec3& p) {
        return glm::clamp(p, box.lower, box.upper) == p ? std::optional(linear(p)) : std::nullopt;
    };
    for (const View& view : views_of_shifted_block()) {
        for (const double z : {box.lower.z, box.upper.z}) {
            const CutPlane slice{{.6, .7, z}, {0, 0, 1}};
            const Image drawn = render_field(field, box, view, transparent(), {.step_world = .1, .clip = {.slices = {slice}}});
            expect_whole(drawn, view, {slice}, std::to_string(z));
        }
    }
}

TEST_P(Clips, SlicesOutsideOrBehindTheEyeAreNotSeen) {
    const HexMesh mesh = shifted_block();
    const View view({.eye = {.6, .7, .8}, .target = {.6, .7, 0}, .up = {0, 1, 0}, .ortho_height = 2}, 24, 24);
    for (const double z : {.29999, .9, 1.3, .8}) {  // the last goes through the eye
        const CutPlane slice{{.6, .7, z}, {0, 0, 1}};
        const Image drawn = draw(GetParam(), mesh, view, transparent(), {.slices = {slice}});
        EXPECT_EQ(std::ranges::max(drawn.rgba), 0) << z;
    }
}

/// The depths at which the rays of a view meet a plane; infinity where they do not.
std::vector<float> depths_of(const CutPlane& plane, const View& view) {
    std::vector<float> depths;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Ray ray = view.ray(x + 0.5, y + 0.5);
            const double t = glm::dot(plane.normal, plane.point - ray.origin) / glm::dot(plane.normal, ray.direction);
            depths.push_back(t > 0 ? static_cast<float>(t) : std::numeric_limits<float>::infinity());
        }
    }
    return depths;
}

View ended(View view, std::vector<float> depths) {
    view.end_rays(std::move(depths));
    return view;
}

// Ends are floats: at a depth of 5 they are off by 2.4e-7, and opacities by half of that. Single precision adds as much.
constexpr double kEndTolerance = 2e-6;

TEST_P(Clips, RaysThatEndAtAPlaneSeeWhatAPlaneLeaves) {
    for (const View& view : views()) {
        const CutPlane back{{0.1, 0.1, 0}, {-0.4, 1, -0.2}};
        ASSERT_GT(glm::dot(back.normal, view.ray(20, 20).direction), 0);
        const Image cut = draw(GetParam(), view, smooth_optics(), {.planes = {back}});
        const Image drawn = draw(GetParam(), ended(view, depths_of(back, view)), smooth_optics(), {});
        EXPECT_LT(test::largest_difference(drawn, cut), kEndTolerance) << view.perspective();
        EXPECT_GT(test::largest_difference(drawn, draw(GetParam(), view, smooth_optics(), {})), 0.05);
    }
}

TEST_P(Clips, WhatIsOpaqueInsideIsMetWithoutASeam) {
    const Vec3 color(0.25, 0.5, 0.75);
    const Optics constant({.color = {{0, color}, {1, color}}, .opacity = {{0, 0}, {1, .5}}}, .5);
    const CutPlane plane{{0.1, 0, 0}, {0.7, 1, -0.2}};  // its slice has that colour everywhere
    for (const View& view : views()) {
        const Image whole = draw(GetParam(), view, constant, {.slices = {plane}, .around_slices = true});
        const Image alone = draw(GetParam(), view, constant, {.slices = {plane}});
        const Image before = draw(GetParam(), ended(view, depths_of(plane, view)), constant, {});
        int met = 0;
        for (std::size_t i = 0; i < alone.rgba.size(); i += 4) {
            if (alone.rgba[i + 3] < 1) continue;
            ++met;
            for (std::size_t c = 0; c < 3; ++c) {
                const double over = double{before.rgba[i + c]} + (1 - double{before.rgba[i + 3]}) * color[static_cast<int>(c)];
                EXPECT_NEAR(over, double{whole.rgba[i + c]}, kEndTolerance) << "pixel " << i / 4;
            }
        }
        EXPECT_GT(met, 200);
    }
}

TEST_P(Clips, EachPixelHasItsOwnEnd) {
    const View view = views()[0];
    std::vector<float> depths(40 * 36);
    for (std::size_t i = 0; i < depths.size(); ++i) {
        const float kinds[]{0, -1, std::numeric_limits<float>::infinity(), 1, 99, 5};  // the body is between 3 and 7
        depths[i] = kinds[i % 6];
    }
    const Image whole = draw(GetParam(), view, smooth_optics(), {});
    const Image half = draw(GetParam(), ended(view, std::vector<float>(depths.size(), 5.0F)), smooth_optics(), {});
    const Image drawn = draw(GetParam(), ended(view, depths), smooth_optics(), {});
    for (std::size_t i = 0; i < depths.size(); ++i) {
        for (std::size_t c = 4 * i; c < 4 * i + 4; ++c) {
            const float expected = depths[i] == 5 ? half.rgba[c] : depths[i] > 5 ? whole.rgba[c] : 0;
            // GL finds the intervals of a view with ends on the host, where triangles are rounded otherwise.
            ASSERT_NEAR(drawn.rgba[c], expected, 5e-5) << "pixel " << i << ", end " << depths[i];
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, Clips, testing::ValuesIn(kMethods),
                         [](const auto& one) { return kNames[static_cast<std::size_t>(one.param)]; });

TEST(RayEnds, AreTheSameForAllSamplesOfAPixelAndAnyNumberOfThreads) {
    const View view({.eye = {0, -4, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, 30, 30);
    std::vector<float> depths(30 * 30, 4.0F);  // the middle of the block
    for (std::size_t i = 0; i < depths.size(); i += 2) depths[i] = 0;
    HexMesh mesh = box_about_origin();
    test::add_field(mesh, "f", [](const Vec3&) { return 1.0; });
    const RbfVolume volume = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    const auto picture = [&] {
        return render_splats(volume, ended(view, depths), smooth_optics(), {.method = SplatMethod::Cpu, .samples = 3}).image;
    };
    const Image drawn = picture();
    const double expected = 1 - std::pow(1 - 0.5, 1 / 0.5);  // opacity .5 for each .5, over a length of 1
    for (const int x : {10, 12, 14, 16}) {
        EXPECT_EQ(drawn.pixel(x, 15)[3], 0) << x;
        EXPECT_NEAR(drawn.pixel(x + 1, 15)[3], expected, 1e-3) << x;
    }
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(picture().rgba, drawn.rgba);
}

TEST(RayEnds, OtherDepthsForTheSameViewAreAnotherPicture) {
    const View view = views()[0];
    const RbfVolume volume = sample_rbf_points(block_mesh(), {.per_edge = 2}).volume;
    Splatter splatter(volume, {.method = SplatMethod::Cpu});
    const auto at = [&](float depth) { return ended(view, std::vector<float>(40 * 36, depth)); };
    (void)splatter.draw(at(4.8F), smooth_optics());
    const SplatResult second = splatter.draw(at(5.2F), smooth_optics());
    EXPECT_EQ(second.image.rgba, render_splats(volume, at(5.2F), smooth_optics(), {.method = SplatMethod::Cpu}).image.rgba);
    for (const float depth : second.depth) EXPECT_TRUE(depth < 5.2F || std::isinf(depth));
    EXPECT_TRUE(splatter.draw(at(5.2F), smooth_optics()).report.kept);
}

/// A plane that looks at the camera, through an opaque, lit block whose values are constant on the plane.
TEST(ClippedSolid, CapsAreLitByTheirPlane) {
    const Vec3 normal = glm::normalize(Vec3(0.25, -0.8, 0.4));
    HexMesh mesh = box_about_origin();
    test::add_field(mesh, "f", [&](const Vec3& p) { return 0.5 + 0.2 * glm::dot(normal, p); });
    const Optics solid({.color = {{0, {1, 0, 0}}, {1, {0, 0, 1}}}, .opacity = {{0, 1}}}, 1e-6);
    const Shading shading;
    const View view({.eye = 6.0 * Vec3(0.2, -1, 0.3), .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, 41, 41);
    const Clip clip{.planes = {{{0, 0, 0}, normal}}};
    Vec3 in_eye;
    for (int k = 0; k < 3; ++k) in_eye[k] = glm::dot(view.axes()[static_cast<std::size_t>(k)], normal);
    const Vec3 to_eye(0, 0, -1), key = glm::normalize(shading.key);
    const double head = glm::dot(in_eye, to_eye), side = std::max(0.0, glm::dot(in_eye, key));
    const double gloss = std::pow(head, shading.shininess) +
                         std::pow(std::max(0.0, glm::dot(in_eye, glm::normalize(key + to_eye))), shading.shininess);
    const Vec3 expected =
        solid.color(0.5) * (shading.ambient + shading.diffuse * 0.5 * (head + side)) + shading.specular * 0.5 * gloss;
    const auto expect_cap = [&](const Image& image, const char* what) {
        for (const auto& [x, y] : {std::pair{20, 20}, {14, 23}, {25, 17}}) {
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(image.pixel(x, y)[static_cast<std::size_t>(c)], expected[c], 4e-3) << what << x << ' ' << y;
        }
    };
    const RbfVolume volume = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    Image splatted = render_splats(volume, view, solid, {.method = SplatMethod::Cpu, .shading = shading, .clip = clip}).image;
    expect_cap(splatted, "splats");
    if (!gl_devices().empty()) {
        for (const SplatMethod method : {SplatMethod::Gl, SplatMethod::Sheets}) {
            expect_cap(render_splats(volume, view, solid, {.method = method, .shading = shading, .clip = clip}).image, "GL");
        }
    }
    // Colours of the boundary, here black ones, must not reach the cap.
    const std::vector<double> nothing(volume.boundary.points.size(), 0);
    const Optics black({.color = {{0, {0, 0, 0}}}, .opacity = {{0, 1}}}, 1e-6);
    color_boundary(splatted, volume.boundary, nothing, view, black, shading, 1, clip);
    expect_cap(splatted, "splats with the boundary's colours");

    Image traced = render_tets(mesh, {}, view, solid, {.clip = clip}).image;
    light_boundary(traced, boundary_surface(mesh), view, shading, 1, clip);
    expect_cap(traced, "tetrahedra");
}

/// The eye inside an opaque, lit body with a steep field: there is no surface to light.
TEST(SolidFromInside, EveryMethodShowsTheMaterialAtTheEyeWithoutLight) {
    HexMesh mesh = box_about_origin();
    test::add_field(mesh, "f", linear);
    const RbfVolume volume = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    const Clip behind{.planes = {{{0.6, 0, 0}, {1, 0, 0}}}};
    for (const auto& [ortho_height, unit] : {std::pair{0.0, 1e-6}, {0.5, 1e-6}, {0.0, 1e-3}, {0.5, 1e-3}}) {
        const Optics solid({.color = smooth_optics().function().color, .opacity = {{0, 1}}}, unit * bounds(mesh).diagonal());
        const Camera camera{.eye = {.1, .2, -.1}, .target = {1, .4, .3}, .up = {0, 0, 1}, .ortho_height = ortho_height};
        const View view(camera, 20, 16);
        for (const Clip& clip : {Clip{}, behind}) {
            const auto expect = [&](const Image& image, const char* what) {
                double worst = 0;
                for (int y = 0; y < view.height(); ++y) {
                    for (int x = 0; x < view.width(); ++x) {
                        const Vec3 color = solid.color(linear(view.ray(x + 0.5, y + 0.5).origin));
                        for (int c = 0; c < 3; ++c)
                            worst = std::max(
                                worst,
                                std::abs(static_cast<double>(image.pixel(x, y)[static_cast<std::size_t>(c)]) - color[c]));
                    }
                }
                EXPECT_LT(worst, 2e-3) << what << ", " << ortho_height << ", " << unit;  // values of kernels; the nearest depth
            };
            std::vector<SplatMethod> methods{SplatMethod::Cpu};
            if (!gl_devices().empty()) methods.insert(methods.end(), {SplatMethod::Gl, SplatMethod::Sheets});
            for (const SplatMethod method : methods) {
                expect(render_splats(volume, view, solid, {.method = method, .shading = Shading{}, .clip = clip}).image,
                       "splats");
            }
            for (const Method method : {Method::Tets, Method::Dense, Method::Pt}) {
                if (method == Method::Pt && gl_devices().empty()) continue;
                Image image = draw(method, mesh, view, solid, clip);
                light_boundary(image, boundary_surface(mesh), view, Shading{}, 1, clip);
                expect(image, kNames[static_cast<std::size_t>(method)].c_str());
            }
        }
    }
}

TEST(ClippedKernels, AVolumeWithoutABoundaryIsCutToo) {
    RbfVolume volume = sample_rbf_points(block_mesh(), {.per_edge = 2}).volume;
    volume.boundary = {};
    const View view({.eye = {0, -4, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, 30, 30);
    // The sum of weights falls to half at some distance from the faces: the cut is compared well inside.
    const Clip front{.planes = {{{0, 0, 0}, {0, -1, 0}}}};
    std::vector<SplatMethod> methods{SplatMethod::Cpu};
    if (!gl_devices().empty()) methods.insert(methods.end(), {SplatMethod::Gl, SplatMethod::Sheets});
    for (const SplatMethod method : methods) {
        Splatter splatter(volume, {.method = method});
        const auto alpha = [&](const Clip& clip) {
            splatter.set_clip(clip);
            return static_cast<double>(splatter.draw(view, smooth_optics()).image.pixel(16, 14)[3]);
        };
        const double whole = alpha({}), back = alpha(front);
        const double other = alpha({.planes = {{{0, 0, 0}, {0, 1, 0}}}});
        EXPECT_GT(back, 0.1);
        EXPECT_GT(other, 0.1);
        EXPECT_NEAR((1 - back) * (1 - other), 1 - whole, 2e-4) << "the halves make up the whole";
        EXPECT_EQ(alpha({}), whole);
        splatter.set_clip({.slices = {{{0, 0, 0}, {0, 1, 0}}}});
        const auto slice = splatter.draw(view, smooth_optics()).image;
        EXPECT_EQ(slice.pixel(16, 14)[3], 1.0f);
        EXPECT_EQ(slice.pixel(0, 0)[3], 0.0f) << "outside there is nothing";
    }
}

TEST(Clip, WrongPlanesAndBoxesAreRefused) {
    const auto refused = [](const Clip& clip, const char* word) {
        test::expect_error(ErrorCode::InvalidInput, word, [&] { validate(clip); });
    };
    refused({.planes = {{}, {{0, 0, 0}, {0, 0, 0}}}}, "no length");
    refused({.slices = {{{0, 0, NAN}, {0, 0, 1}}}}, "not finite");
    refused({.box = Box{{0, 0, 0}, {1, 0, 1}}}, "box");
    refused({.box = Box{}}, "box");
    EXPECT_NO_THROW(validate({.planes = {{{0, 0, 0}, {0, 0, 1e-300}}}}));
}

}  // namespace clip_test
}  // namespace subvol
