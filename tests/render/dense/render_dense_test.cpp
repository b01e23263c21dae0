// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_dense.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "render/constant_optics.h"
#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "subvol/color_scale.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/render_field.h"
#include "subvol/render_tets.h"

namespace subvol {
namespace render_dense_test {

using test::largest_difference;

using test::constant_alpha;
using test::constant_optics;
using test::evaluate;
using test::valued;

// Images are in single precision, all before in double.
constexpr double kFloatTol = 1e-6;

Optics ramp_optics(double unit = 1) {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}}, {{0, 0.05}, {0.3, 0.1}, {0.35, 0.6}, {1, 0.8}}}, unit};
}

View straight_view(int size, double height = 1) {
    return {{.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = height}, size, size};
}

View slanted_view(int size) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

View ball_view(int size) {
    return {{.eye = {2.3, 1.9, 3.1}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 40}, size, size};
}

double chord_in_box(const Ray& ray) {
    double begin = 0, end = 1e300;
    for (int k = 0; k < 3; ++k) {
        const double a = -ray.origin[k] / ray.direction[k], b = (1 - ray.origin[k]) / ray.direction[k];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return std::max(0.0, end - begin) * glm::length(ray.direction);
}

double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        if (i % 4 != 3) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    }
    return std::sqrt(sum / (0.75 * double(a.rgba.size())));
}

/// The same volume drawn by render_tets after `refine`.
Image by_tets(const HexMesh& mesh, const RefineOptions& options, const View& view, const Optics& optics) {
    const HexMesh fine = test::numbered_by_position(on_limit(refine(mesh, options), options.scheme.kind));
    return render_tets(fine, {}, view, optics).image;
}

HexMesh with_field(HexMesh mesh, const std::function<double(const Vec3&)>& field) {
    mesh.attributes.push_back({"f", 1, evaluate(mesh, field)});
    return mesh;
}

double waves(const Vec3& p) {
    return 0.5 + 0.5 * std::sin(5 * p.x + 1) * std::cos(4 * p.y + p.z);
}

TEST(RenderDense, ConstantBoxHasAnalyticChords) {
    const HexMesh mesh = test::jittered_box(3, 0.2, 4);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    for (const View& view : {straight_view(33), slanted_view(48)}) {
        for (const int levels : {0, 1, 3}) {
            const auto result = render_dense(valued(mesh, ones), {}, view, constant_optics(), {.levels = levels});
            EXPECT_EQ(result.report.lost_rays, 0u);
            EXPECT_EQ(result.report.blocks, 27u);
            EXPECT_EQ(result.report.micro_cells, 27u << (3 * levels));
            for (int y = 0; y < view.height(); ++y) {
                for (int x = 0; x < view.width(); ++x) {
                    ASSERT_NEAR(result.image.pixel(x, y)[3], constant_alpha(chord_in_box(view.ray(x + 0.5, y + 0.5))),
                                kFloatTol)
                        << levels << ": " << x << ' ' << y;
                }
            }
        }
    }
}

TEST(RenderDense, RaysThroughLatticePointsAndEdgesAreExact) {
    const HexMesh mesh = test::box(2);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    for (const int size : {5, 9, 17}) {  // pixel centres lie on lattice points, edges and diagonals of all levels
        const auto result = render_dense(valued(mesh, ones), {}, straight_view(size, double(size) / (size - 1)),
                                         constant_optics(), {.levels = 2});
        EXPECT_EQ(result.report.lost_rays, 0u);
        for (int y = 1; y + 1 < size; ++y) {
            for (int x = 1; x + 1 < size; ++x) ASSERT_NEAR(result.image.pixel(x, y)[3], constant_alpha(1), kFloatTol);
        }
    }
    for (const Vec3& direction : {Vec3(1, 1, 1), Vec3(1, 1, 0), Vec3(-1, 1, 1), Vec3(0, 1, -1)}) {
        const View view({.eye = Vec3(0.5) + 4.0 * direction, .target = Vec3(0.5), .up = {0.1, 0.2, 1}, .ortho_height = 1.0}, 41,
                        41);
        const auto result = render_dense(valued(mesh, ones), {}, view, constant_optics(), {.levels = 2});
        EXPECT_EQ(result.report.lost_rays, 0u);
        EXPECT_NEAR(result.image.pixel(20, 20)[3], constant_alpha(glm::length(direction)), kFloatTol);
    }
}

TEST(RenderDense, LinearFieldIsOneSegment) {
    const auto ramp = [](const Vec3& p) { return dot(Vec3(0.5, 0.2, 0.3), p); };
    const HexMesh mesh = test::jittered_box(4, 0.2, 5);
    const View view = slanted_view(48);
    const auto dense = render_dense(valued(mesh, ramp), {}, view, ramp_optics(), {.levels = 2});
    // Schemes are affine, so values that are linear in space stay linear, and a box of one cell has the same field exactly.
    const HexMesh one = test::box(1);
    const auto exact = render_tets(valued(one, ramp), {}, view, ramp_optics());
    EXPECT_LT(largest_difference(dense.image, exact.image), kFloatTol);
    EXPECT_EQ(dense.report.lost_rays, 0u);
}

TEST(RenderDense, BallHasItsOpticalDepth) {
    const View view({.eye = {0.3, 1, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .ortho_height = 2.2}, 64, 64);
    const auto error = [&](Index cells, int levels) {
        const HexMesh mesh = test::ball(cells);
        const auto result = render_dense(valued(mesh, 1.0), {}, view, constant_optics(), {.levels = levels});
        EXPECT_EQ(result.report.lost_rays, 0u);
        double sum = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const Ray ray = view.ray(x + 0.5, y + 0.5);
                const Vec3 d = glm::normalize(ray.direction);
                const double b2 = dot(ray.origin, ray.origin) - std::pow(dot(ray.origin, d), 2);
                sum += std::pow(result.image.pixel(x, y)[3] - constant_alpha(2 * std::sqrt(std::max(0.0, 1 - b2))), 2);
            }
        }
        return std::sqrt(sum / (64 * 64));
    };
    const double coarse = error(8, 3), fine = error(16, 2);
    // Between control points the surface differs from the sphere by the error of quadratic extrapolation at the cube's edges:
    // of third order in the cell size, so it falls to an eighth, blurred by the silhouettes of single pixels. Facets add the
    // same small error at equal fineness.
    EXPECT_LT(fine, coarse / 4);
    EXPECT_LT(fine, 1e-3);
}

TEST(RenderDense, IsTheWalkThroughTheRefinedMesh) {
    const HexMesh box = with_field(test::jittered_box(3, 0.3, 7), waves);
    const HexMesh ball = with_field(make_model("ball", 2), waves);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        for (const int levels : {0, 1, 2, 3}) {
            RefineOptions refine{.scheme = {scheme}, .levels = levels};
            for (const HexMesh* mesh : {&box, &ball}) {
                const View view = mesh == &box ? slanted_view(40) : ball_view(40);
                const auto dense = render_dense(*mesh, {}, view, ramp_optics(0.3), {.refine = refine, .levels = levels});
                EXPECT_EQ(dense.report.lost_rays, 0u);
                EXPECT_LT(largest_difference(dense.image, by_tets(*mesh, refine, view, ramp_optics(0.3))), kFloatTol)
                    << "scheme " << static_cast<int>(scheme) << " level " << levels;
            }
        }
    }
}

TEST(RenderDense, EyeInsideSeesWhatIsInFront) {
    const HexMesh mesh = with_field(test::jittered_box(3, 0.3, 7), waves);
    const View view({.eye = {0.3, 0.45, 0.62}, .target = {1, 0.5, 0.2}, .up = {0, 1, 0}, .fovy_deg = 100}, 48, 48);
    const auto dense = render_dense(mesh, {}, view, ramp_optics(0.3), {.levels = 2});
    EXPECT_LT(largest_difference(dense.image, by_tets(mesh, {.levels = 2}, view, ramp_optics(0.3))), kFloatTol);
}

TEST(RenderDense, ConvergesToTheLimitWithTheSecondOrder) {
    const HexMesh mesh = make_model("twist", 4);
    const View view({.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}}, 64, 64);
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                         .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
                        0.1);
    const auto draw = [&](int levels) { return render_dense(mesh, {}, view, optics, {.levels = levels}).image; };
    std::vector<double> change;
    Image last = draw(1);
    for (int levels = 2; levels <= 5; ++levels) {
        Image next = draw(levels);
        change.push_back(rms(next, last));
        last = std::move(next);
    }
    for (std::size_t i = 0; i < change.size(); ++i) {
        RecordProperty("change_at_level_" + std::to_string(i + 2), std::to_string(change[i]));
    }
    // Trilinear cells are of second order: a change falls to a quarter; silhouettes that cross pixel centres fall slower.
    for (std::size_t i = 1; i < change.size(); ++i) EXPECT_LT(change[i], change[i - 1] / 2.5) << "level " << i + 2;
    EXPECT_LT(change.back(), change.front() / 30);
}

TEST(RenderDense, NearsTheExactFieldWithLevelsAndCells) {
    const View view({.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}}, 64, 64);
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .30}, {0, 0}, {1, .40}}}, 0.1);
    Box box = bounds(make_model("twist", 8));
    box.add(box.lower - Vec3(.2));  // the curved block reaches beyond its points
    box.add(box.upper + Vec3(.2));
    const Image exact =
        render_field([](const Vec3& x) { return TwistField{}.value(x); }, box, view, optics, {.step_world = .004});
    const auto error = [&](int cells, int levels) {
        const HexMesh mesh = make_model("twist", cells);
        return rms(render_dense(mesh, {}, view, optics, {.levels = levels}).image, exact);
    };
    const double control = error(16, 0), first = error(16, 1), second = error(16, 2);
    EXPECT_LT(first, control / 2.5);
    EXPECT_LT(second, first);
    // The error left at level 2 is mostly the scheme's error against the field, of more than second order.
    EXPECT_LT(second, error(8, 2) / 4);
}

TEST(RenderDense, LevelsRiseUntilThePictureStays) {
    const HexMesh mesh = with_field(make_model("ball", 2), waves);
    const View view = ball_view(32);
    const auto result = render_dense(mesh, {}, view, ramp_optics(0.3), {.image_tolerance = 2e-3});
    EXPECT_TRUE(result.report.converged);
    ASSERT_TRUE(result.report.image_change);
    EXPECT_LT(*result.report.image_change, 2e-3);
    const int levels = result.report.levels;
    ASSERT_GT(levels, 1);
    const auto draw = [&](int l) { return render_dense(mesh, {}, view, ramp_optics(0.3), {.levels = l}).image; };
    EXPECT_EQ(draw(levels).rgba, result.image.rgba);
    EXPECT_NEAR(*result.report.image_change, rms(draw(levels), draw(levels - 1)), 1e-12);
    const auto capped = render_dense(mesh, {}, view, ramp_optics(0.3), {.max_levels = 2, .image_tolerance = 1e-9});
    EXPECT_EQ(capped.report.levels, 2);
    EXPECT_FALSE(capped.report.converged);
}

TEST(RenderDense, TheBoundaryLiesWithinAQuarterOfAPixel) {
    const HexMesh mesh = with_field(make_model("ball", 2), [](const Vec3&) { return .5; });
    int before = -1;
    for (const int size : {16, 64, 256}) {  // four times the pixels for each length: the error is four times as many pixels
        const DenseReport found = render_dense(mesh, "f", ball_view(size), ramp_optics(0.3)).report;
        ASSERT_TRUE(found.error_px);
        EXPECT_TRUE(found.converged) << size;
        EXPECT_LE(*found.error_px, .25) << size;
        EXPECT_GT(*found.error_px, .25 / 4) << size;
        EXPECT_EQ(*found.error_color, 0) << size;
        EXPECT_FALSE(found.image_change);
        if (before >= 0) {
            EXPECT_EQ(found.levels, before + 1) << size;
        }
        before = found.levels;
    }
    const DenseReport capped = render_dense(mesh, "f", ball_view(256), ramp_optics(0.3), {.max_levels = 1}).report;
    EXPECT_EQ(capped.levels, 1);
    EXPECT_FALSE(capped.converged);
    EXPECT_GT(*capped.error_px, .25);
}

TEST(RenderDense, ColoursLieWithinTheErrorThatIsSaid) {
    const HexMesh mesh = with_field(test::box(6), waves);
    const View view = slanted_view(64);
    const DenseResult found = render_dense(mesh, {}, view, ramp_optics(0.3));
    EXPECT_TRUE(found.report.converged);
    EXPECT_LE(*found.report.error_color, 1 / 256.0);
    const int levels = found.report.levels;
    ASSERT_GT(levels, 0);
    const auto draw = [&](int l) { return render_dense(mesh, {}, view, ramp_optics(0.3), {.levels = l}).image; };
    EXPECT_LT(rms(found.image, draw(levels + 2)), *found.report.error_color);
}

TEST(RenderDense, WhereColoursJumpTheLevelIsNoFinerAndThePictureNear) {
    const HexMesh mesh = with_field(test::box(4), waves);
    const View view = slanted_view(64);
    const auto optics = [](const ColorShape& shape) {
        TransferFunction ramp = transfer_function_preset("viridis", .1, .9);
        ramp.opacity = {{.1, .3}, {.9, .3}};
        return Optics(shaped(ramp, shape), .3);
    };
    const int smooth = render_dense(mesh, {}, view, optics({}), {}).report.levels;
    for (const ColorShape& shape :
         {ColorShape{.bands = 5}, ColorShape{.bands = 40}, ColorShape{.below = Vec3(1, 0, 0), .above = Vec3(1)}}) {
        const DenseResult found = render_dense(mesh, {}, view, optics(shape));
        EXPECT_TRUE(found.report.converged);
        EXPECT_LE(*found.report.error_px, .25);
        EXPECT_LE(found.report.levels, smooth + 1);  // each level costs eight times as much
        // A line a quarter of a pixel beside its place changes a quarter of the pixels along it, by less than the whole colour;
        // lines go through at most a tenth of these 64² pixels each: √(.25 · .1) · .2 of 1 for bands, and opacity takes half.
        const Image finer = render_dense(mesh, {}, view, optics(shape), {.levels = found.report.levels + 1}).image;
        EXPECT_LT(rms(found.image, finer), .015) << shape.bands;
    }
}

TEST(RenderDense, AJumpOutsideTheFieldNeedsNoLevel) {
    const HexMesh mesh = with_field(test::box(4), [](const Vec3& p) { return p.x * p.x; });
    TransferFunction step{{{0, {1, 0, 0}}, {2, {1, 0, 0}}, {2 + 1e-12, {0, 0, 1}}, {3, {0, 0, 1}}}, {{0, .5}, {3, .5}}};
    EXPECT_EQ(render_dense(mesh, {}, slanted_view(64), Optics(step, .3)).report.levels, 0);
}

TEST(RenderDense, WhatIsLinearNeedsNoLevel) {
    const HexMesh mesh = with_field(test::box(4), [](const Vec3& p) { return p.x; });
    const DenseReport found = render_dense(mesh, {}, slanted_view(64), ramp_optics(0.3)).report;
    EXPECT_EQ(found.levels, 0);
    EXPECT_LT(*found.error_px, 1e-9);
}

TEST(RenderDense, ThreadsAndMemoryChangeNoBit) {
    const HexMesh mesh = with_field(test::jittered_box(5, 0.35, 3), waves);
    const auto draw = [&](std::size_t threads, std::size_t memory) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render_dense(mesh, {}, slanted_view(90), ramp_optics(0.3), {.levels = 2, .memory = memory, .samples = 2});
    };
    const auto one = draw(1, std::size_t{1} << 30), two = draw(2, std::size_t{1} << 30), little = draw(2, 600'000);
    EXPECT_EQ(one.report.passes, 1u);
    EXPECT_GE(little.report.passes, 4u);
    EXPECT_GT(one.report.bytes, 600'000u);
    EXPECT_LE(little.report.bytes, 600'000u);
    for (const auto* other : {&two, &little}) {
        EXPECT_EQ(std::memcmp(one.image.rgba.data(), other->image.rgba.data(), one.image.rgba.size() * sizeof(float)), 0);
        EXPECT_EQ(one.report.rays, other->report.rays);
        EXPECT_EQ(one.report.segments, other->report.segments);
        EXPECT_EQ(other->report.lost_rays, 0u);
    }
}

/// Opaque, and clear enough that some rays come through the outer cells.
Optics opaque_optics(double alpha) {
    return {{{{0, {1, 0, 0}}, {1, {0.1, 0.3, 1}}}, {{0, alpha}, {1, 0.99}}}, 0.01};
}

TEST(RenderDense, CellsThatNoRayComesToAreNotMade) {
    const HexMesh mesh = with_field(test::jittered_box(9, 0.2, 4), waves);
    for (const double alpha : {0.999, 0.7}) {  // sight ends within 2 and 12 % of a side: in the outer cells, and beyond them
        const auto draw = [&](std::size_t threads, std::size_t memory) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            return render_dense(mesh, {}, slanted_view(70), opaque_optics(alpha),
                                {.levels = 1, .memory = memory, .samples = 2});
        };
        const DenseResult drawn = draw(4, std::size_t{2} << 30), whole = draw(4, 1);
        EXPECT_LT(drawn.report.blocks, 729u) << alpha;
        EXPECT_EQ(drawn.report.blocks + drawn.report.skipped_blocks, 729u);
        EXPECT_EQ(drawn.report.micro_cells, 8 * drawn.report.blocks);
        EXPECT_EQ(drawn.report.lost_rays, 0u);
        EXPECT_EQ(drawn.image.rgba, whole.image.rgba) << alpha;
        EXPECT_EQ(drawn.report.rays, whole.report.rays);
        EXPECT_EQ(drawn.report.segments, whole.report.segments);
        const DenseResult alone = draw(1, std::size_t{2} << 30);
        EXPECT_EQ(alone.image.rgba, drawn.image.rgba);
        EXPECT_EQ(alone.report.blocks, drawn.report.blocks);
    }
}

TEST(RenderDense, AnOpaqueVolumeThatIsCutOpenShowsItsInside) {
    const HexMesh mesh = with_field(test::jittered_box(9, 0.2, 4), waves);
    const auto draw = [&](std::size_t memory) {
        DenseOptions options{.levels = 1, .memory = memory};
        options.clip.planes.push_back({.point = {0.5, 0.5, 0.5}, .normal = {0.3, 0.2, 1}});
        return render_dense(mesh, {}, slanted_view(70), opaque_optics(0.999), options).image.rgba;
    };
    EXPECT_EQ(draw(std::size_t{2} << 30), draw(1));
}

TEST(RenderDense, InvisibleBlocksAreSkippedWithoutChange) {
    const HexMesh mesh = with_field(test::box(6), [](const Vec3& p) { return p.x; });
    const View view = slanted_view(48);
    const Optics optics({{{0, {1, 0, 0}}, {1, {0, 1, 1}}}, {{0.7, 0}, {0.75, 0.9}, {0.8, 0}}}, 0.2);
    const auto dense = render_dense(mesh, {}, view, optics, {.levels = 1});
    EXPECT_EQ(dense.report.blocks, 36u);  // the layer between x = 4/6 and 5/6
    EXPECT_EQ(dense.report.skipped_blocks, 180u);
    EXPECT_LT(largest_difference(dense.image, by_tets(mesh, {.levels = 1}, view, optics)), kFloatTol);
}

TEST(RenderDense, PlaceDoesNotMatter) {
    // Coordinates are quarters, so equal ones stay equal: the order of positions, which decides how cells are split, is kept.
    const HexMesh mesh = with_field(test::jittered_box(4, 0.3, 8), waves);
    const auto draw = [&](const Vec3& move) {
        HexMesh moved = mesh;
        for (Vec3& p : moved.points) p += move;
        const Camera camera{.eye = Vec3(2.1, 1.7, 2.9) + move, .target = Vec3(0.5) + move, .fovy_deg = 35};
        const auto result =
            render_dense(valued(moved, mesh.attributes[0].values), {}, View(camera, 64, 64), ramp_optics(), {.levels = 2});
        EXPECT_EQ(result.report.lost_rays, 0u);
        return result.image;
    };
    // At 1e6 a coordinate is rounded by 1e-10; the steepest silhouette and field make less than 1e-7 of it.
    EXPECT_LT(largest_difference(draw(Vec3(0)), draw(Vec3(1e6, -1e6, 1e6))), 1e-6);
}

TEST(RenderDense, TangledCellsLoseNoRay) {
    const HexMesh mesh = test::jittered_box(5, 0.9, 99);
    const View view = slanted_view(64);
    const auto result = render_dense(valued(mesh, 1.0), {}, view, constant_optics(), {.levels = 2});
    EXPECT_EQ(result.report.lost_rays, 0u);
    for (const float value : result.image.rgba) ASSERT_TRUE(std::isfinite(value) && value >= 0 && value <= 1 + kFloatTol);
    HexMesh flat = test::box(2);
    for (Vec3& p : flat.points) p = Vec3(0.5);
    const auto nothing = render_dense(valued(flat, 1.0), {}, view, constant_optics(), {.levels = 1});
    for (const float value : nothing.image.rgba) ASSERT_EQ(value, 0.0f);
}

TEST(RenderDense, RefusesWrongInput) {
    const HexMesh mesh = test::box(1);
    const std::vector<double> ones(8, 1.0);
    const View view = slanted_view(4);
    const Optics optics = constant_optics();
    EXPECT_THROW((void)render_dense(valued(mesh, std::vector<double>(7)), {}, view, optics), Error);
    EXPECT_THROW((void)render_dense(valued(mesh, std::nan("")), {}, view, optics), Error);
    EXPECT_THROW((void)render_dense(valued(mesh, ones), {}, view, optics, {.levels = 9}), Error);
    EXPECT_THROW((void)render_dense(valued(mesh, ones), {}, view, optics, {.levels = -1}), Error);
    EXPECT_THROW((void)render_dense(valued(mesh, ones), {}, view, optics, {.image_tolerance = 0}), Error);
    EXPECT_THROW((void)render_dense(valued(mesh, ones), {}, view, optics, {.samples = 0}), Error);
}

}  // namespace render_dense_test
}  // namespace subvol
