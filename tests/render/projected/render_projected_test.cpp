// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_projected.h"

#include <gtest/gtest.h>

#include "lib/test_meshes.h"
#include "projected_scenes.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"

namespace subvol {
namespace render_projected_test {

using namespace test;

using RenderProjected = ProjectedTest;

TEST_F(RenderProjected, CellsOneByOneAreLikeRays) {
    // Six tetrahedra that fill the picture: silhouettes with three and four corners, thick segments across all knots.
    HexMesh mesh = test::box(1);
    for (const double height : {1.0, 0.3, 0.01, 1e-4}) {
        for (std::size_t i = 0; i < 4; ++i) mesh.points[4 + i].z = height * (1 + 0.1 * static_cast<double>(i));
        const auto values = evaluate(mesh, waves);
        for (const View& view : {slanted_view(64), orthographic_view(61, 47)}) {
            EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1)), kGlTol) << height;
        }
    }
}

TEST_F(RenderProjected, ConstantBoxIsBeerLambert) {
    const HexMesh mesh = test::jittered_box(6, 0.3, 11);
    const View view({.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = 0.99}, 48, 48);
    const auto result = render_projected(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(result.report.tets, 6u * 216);
    for (std::size_t i = 0; i < result.image.rgba.size(); ++i) ASSERT_NEAR(result.image.rgba[i], 0.5f, kFewTol) << i;
}

TEST_F(RenderProjected, LinearFieldIsLikeRays) {
    const Vec3 gradient(0.5, 0.2, 0.3);
    for (const HexMesh& mesh : {test::box(4), test::jittered_box(6, 0.3, 5)}) {
        const auto values = evaluate(mesh, [&](const Vec3& p) { return dot(gradient, p); });
        for (const View& view : {slanted_view(64), orthographic_view(61, 47)}) {
            EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.2)), kGlTol);
        }
    }
}

TEST_F(RenderProjected, BallIsLikeRays) {
    const HexMesh mesh = test::ball(8);
    const auto values = evaluate(mesh, waves);
    EXPECT_LT(difference_from_rays(mesh, values, ball_view(80, 64), ramp_optics(0.1)), kGlTol);
}

TEST_F(RenderProjected, FacesSeenEdgeOnAreLikeRays) {
    // Along diagonals of cells three corners of a silhouette lie in a line.
    const HexMesh mesh = make_model("ball", 4);
    const View view(fit_camera(bounds(mesh), {-1, 1, -1}), 96, 96);
    EXPECT_LT(difference_from_rays(mesh, mesh.attributes[0].values, view, ramp_optics(0.1)), kGlTol);
}

TEST_F(RenderProjected, EyeInsideSeesOnlyWhatIsInFront) {
    const HexMesh mesh = test::jittered_box(4, 0.2, 3);
    const auto values = evaluate(mesh, waves);
    const View view({.eye = {0.43, 0.37, 0.52}, .target = {0.9, 0.8, 0.3}, .up = {0, 0, 1}, .fovy_deg = 80}, 48, 40);
    EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1)), kGlTol);
}

TEST_F(RenderProjected, FarFromTheOriginNothingChanges) {
    HexMesh mesh = test::jittered_box(4, 0.2, 3);
    const auto values = evaluate(mesh, waves);
    for (Vec3& p : mesh.points) p = 1e-3 * p + Vec3(1000, -2000, 500);
    const Vec3 center = Vec3(1000, -2000, 500) + Vec3(5e-4);
    const View view({.eye = center + Vec3(1.6e-3, 1.2e-3, 2.4e-3), .target = center, .up = {0, 1, 0}, .fovy_deg = 35}, 64, 64);
    EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(1e-4)), kGlTol);
}

TEST_F(RenderProjected, ListsAreLikeRays) {
    const Optics optics = ramp_optics(0.1);
    const HexMesh ball = test::ball(8), corner = test::l_shape(6), cell = test::box(1);
    EXPECT_LT(difference_from_rays(ball, evaluate(ball, waves), ball_view(80, 64), optics, {.order = ProjectedOrder::Lists}),
              kGlTol);
    EXPECT_LT(difference_from_rays(corner, evaluate(corner, waves), slanted_view(64), optics, {.order = ProjectedOrder::Lists}),
              kGlTol);
    EXPECT_LT(
        difference_from_rays(cell, evaluate(cell, waves), orthographic_view(61, 47), optics, {.order = ProjectedOrder::Lists}),
        kGlTol);
}

TEST_F(RenderProjected, TopologicalOrderIsThatOfLists) {
    // Convex meshes without cycles: the same segments in the same order, composited from the other end.
    for (const HexMesh& mesh : {test::jittered_box(6, 0.3, 5), test::ball(6)}) {
        const auto values = evaluate(mesh, waves);
        const View view = ball_view(70, 60);
        const auto topological = render_projected(valued(mesh, values), {}, view, ramp_optics(0.1), {.count_violations = true});
        const auto lists = render_projected(valued(mesh, values), {}, view, ramp_optics(0.1), {.order = ProjectedOrder::Lists});
        EXPECT_EQ(topological.report.cycles, 0u);
        EXPECT_EQ(topological.report.violations, 0u);
        EXPECT_EQ(topological.report.fragments, lists.report.fragments);
        EXPECT_LT(largest_difference(topological.image, lists.image), kFewTol);
    }
}

TEST_F(RenderProjected, CentroidsAreWrongWhereTheyAreCounted) {
    // Flat cells, seen from a slant: the order of centroids is not that of the cells.
    HexMesh mesh = test::box(4);
    for (Vec3& p : mesh.points) p.z *= 0.1;
    const auto values = evaluate(mesh, waves);
    const View view({.eye = {2.5, 2.1, 0.9}, .target = {0.5, 0.5, 0}, .up = {0, 0, 1}, .fovy_deg = 30}, 64, 48);
    const Optics optics = ramp_optics(0.05);
    const auto right = render_projected(valued(mesh, values), {}, view, optics, {.count_violations = true});
    const auto wrong =
        render_projected(valued(mesh, values), {}, view, optics, {.order = ProjectedOrder::Centroid, .count_violations = true});
    const auto lists = render_projected(valued(mesh, values), {}, view, optics, {.order = ProjectedOrder::Lists});
    EXPECT_EQ(right.report.violations, 0u);
    ASSERT_GT(wrong.report.violations, 0u);
    EXPECT_EQ(lists.report.violations, wrong.report.violations);
    std::size_t changed = 0;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const auto a = wrong.image.pixel(x, y), b = lists.image.pixel(x, y);
            changed += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 1e-4f ? 1 : 0;
        }
    }
    EXPECT_GT(changed, 0u);
    EXPECT_LE(changed, *wrong.report.violations);
}

/// A bar of cells, seen along its axis.
HexMesh long_bar(Index cells) {
    HexMesh mesh = test::make_box(1, 1, cells);
    for (Vec3& p : mesh.points) p.z *= 0.02;
    return mesh;
}

TEST_F(RenderProjected, ListsOfManyTetrahedraAreSorted) {
    // Mesa's software ends all loops of a thread after 65,535 iterations; insertion of as many in the wrong order takes more.
    const HexMesh mesh = long_bar(400);
    const auto values = evaluate(mesh, [](const Vec3& p) { return 0.5 + 0.4 * std::sin(3 * p.z); });
    const View view({.eye = {0.5, 0.5, -3}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = 0.9}, 8, 8);
    const Optics optics = ramp_optics(5);
    const auto rays = render_tets(valued(mesh, values), {}, view, optics).image;
    for (const ProjectedOrder order : {ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        const auto drawn = render_projected(valued(mesh, values), {}, view, optics, {.order = order});
        EXPECT_GT(drawn.report.fragments, 64u * 800u) << "more than 400 tetrahedra on each ray";
        EXPECT_LT(largest_difference(drawn.image, rays), kGlTol);
    }
    // A wide window takes a long way from the wrong order; that of the lists is right, and so the picture does not change.
    const auto wide =
        render_projected(valued(mesh, values), {}, view, optics, {.order = ProjectedOrder::Havs, .kbuffer = 65536});
    EXPECT_LT(largest_difference(wide.image, rays), kGlTol);
}

TEST_F(RenderProjected, LongListsTakeAnyNumberOfStepsForASegment) {
    // Each segment is looked for among many knots, and cut by many planes that miss the bar.
    const HexMesh mesh = long_bar(1500);
    const auto values = evaluate(mesh, [](const Vec3& p) { return 0.5 + 0.4 * std::sin(p.z); });
    const View view({.eye = {0.5, 0.5, -3}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = 0.9}, 4, 4);
    TransferFunction function{.color = {{0, {1, 1, 0.5}}}, .opacity = {}};
    for (int i = 0; i <= 500; ++i) function.opacity.push_back({i / 500.0, i % 2 == 0 ? 0.3 : 0.2});
    const Optics optics(function, 40);
    Clip clip;
    for (int i = 0; i < 20; ++i) clip.planes.push_back({.point = {0.001 * i, 0, 0}, .normal = {-1, 0, 0}});
    const auto rays = render_tets(valued(mesh, values), {}, view, optics, {.clip = clip}).image;
    for (const ProjectedOrder order : {ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        const auto drawn = render_projected(valued(mesh, values), {}, view, optics, {.order = order, .clip = clip});
        EXPECT_LT(largest_difference(drawn.image, rays), kGlTol);
    }
}

TEST_F(RenderProjected, FunctionsWithTooManyKnotsAreRefused) {
    TransferFunction function{.color = {{0, {1, 1, 1}}}, .opacity = {}};
    for (int i = 0; i <= 2048; ++i) function.opacity.push_back({i / 2048.0, i % 2 == 0 ? 0.1 : 0.2});
    const HexMesh mesh = test::box(1);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    EXPECT_THROW((void)render_projected(valued(mesh, ones), {}, slanted_view(8), Optics(function, 1)), Error);
}

TEST_F(RenderProjected, ListsCountEveryDepthOnceWhereCellsFoldOver) {
    // The colour of a fold depends on which of the cells is drawn, its opacity does not.
    const HexMesh mesh = test::jittered_box(5, 0.9, 4);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    const auto lists =
        render_projected(valued(mesh, ones), {}, slanted_view(64), constant_optics(), {.order = ProjectedOrder::Lists});
    EXPECT_GT(lists.report.inverted_tets, 0u);
    EXPECT_LT(
        largest_difference(lists.image, render_tets(valued(test::box(1), 1.0), {}, slanted_view(64), constant_optics()).image),
        kFewTol);
}

TEST_F(RenderProjected, ListsInPartsAreTheSame) {
    const HexMesh mesh = test::ball(5);
    const auto values = evaluate(mesh, waves);
    const View view = ball_view(50, 40);
    const auto draw = [&](std::size_t bytes) {
        return render_projected(valued(mesh, values), {}, view, ramp_optics(0.1),
                                {.order = ProjectedOrder::Lists, .list_bytes = bytes});
    };
    const auto whole = draw(1 << 28), rows = draw(20 * 2000), pixels = draw(20 * 150);
    EXPECT_EQ(whole.report.parts, 1u);
    EXPECT_GT(rows.report.parts, 2u);
    EXPECT_GT(pixels.report.parts, 40u) << "rows are divided";
    EXPECT_EQ(rows.image.rgba, whole.image.rgba);
    EXPECT_EQ(pixels.image.rgba, whole.image.rgba);
    EXPECT_EQ(pixels.report.violations, whole.report.violations);
    EXPECT_THROW((void)draw(20), Error);
}

TEST_F(RenderProjected, IsTheSameEveryTime) {
    const HexMesh mesh = test::ball(6);
    const auto values = evaluate(mesh, waves);
    for (const ProjectedOrder order :
         {ProjectedOrder::Centroid, ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        const auto draw = [&] {
            return render_projected(valued(mesh, values), {}, ball_view(50, 50), ramp_optics(0.1), {.order = order}).image.rgba;
        };
        const auto first = draw();
        for (int i = 0; i < 2; ++i) EXPECT_EQ(draw(), first);
    }
}

TEST_F(RenderProjected, RendererKeepsNothingOfThePictureBefore) {
    const HexMesh mesh = test::ball(6);
    const auto values = evaluate(mesh, waves);
    ProjectedRenderer renderer(valued(mesh, values));
    // Another size, projection, number of knots and order each time.
    const std::vector<View> views{ball_view(50, 40), orthographic_view(31, 60), ball_view(64, 64)};
    for (const ProjectedOrder order : {ProjectedOrder::Havs, ProjectedOrder::Topological, ProjectedOrder::Lists,
                                       ProjectedOrder::Centroid, ProjectedOrder::Havs}) {
        for (const View& view : views) {
            for (const Optics& optics : {ramp_optics(0.1), constant_optics()}) {
                const auto kept = renderer.draw(view, optics, {.order = order});
                const auto fresh = render_projected(valued(mesh, values), {}, view, optics, {.order = order});
                EXPECT_EQ(kept.image.rgba, fresh.image.rgba);
                EXPECT_EQ(kept.report.fragments, fresh.report.fragments);
                EXPECT_EQ(kept.report.violations, fresh.report.violations);
            }
        }
    }
}

TEST_F(RenderProjected, SamplesAreThoseOfRays) {
    const HexMesh mesh = test::ball(4);
    const auto values = evaluate(mesh, waves);
    const View view = ball_view(40, 31);
    const auto rays = render_tets(valued(mesh, values), {}, view, ramp_optics(0.1), {.samples = 3});
    const auto once = render_tets(valued(mesh, values), {}, view, ramp_optics(0.1));
    EXPECT_GT(largest_difference(rays.image, once.image), 0.05) << "samples matter";
    for (const ProjectedOrder order : {ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        const auto drawn = render_projected(valued(mesh, values), {}, view, ramp_optics(0.1), {.order = order, .samples = 3});
        EXPECT_LT(largest_difference(drawn.image, rays.image), kGlTol);
    }
}

TEST_F(RenderProjected, RealMeshesAreLikeRays) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    expect_real_meshes_like_rays(*data, {.order = ProjectedOrder::Lists});
}

class Stopper : public Progress {
public:
    void report(std::string_view, double fraction) override {
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1 + 1e-9);
        last = fraction;
    }
    [[nodiscard]] bool cancelled() const override { return stop && last > 0; }
    double last = -1;
    bool stop = false;
};

TEST_F(RenderProjected, ReportsProgressAndStops) {
    const HexMesh mesh = test::box(3);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    for (const ProjectedOrder order : {ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        Stopper progress;
        const auto draw = [&] {
            return render_projected(valued(mesh, ones), {}, slanted_view(40), constant_optics(),
                                    {.order = order, .progress = &progress});
        };
        (void)draw();
        EXPECT_NEAR(progress.last, 1.0, 1e-9);
        progress.stop = true;
        try {
            (void)draw();
            FAIL() << "not stopped";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::Cancelled);
        }
    }
}

TEST_F(RenderProjected, RefusesWrongInput) {
    const HexMesh mesh = test::box(1);
    EXPECT_THROW((void)render_projected(valued(mesh, std::vector<double>(7)), {}, slanted_view(4), constant_optics()), Error);
    EXPECT_THROW((void)render_projected(valued(mesh, 1.0), {}, slanted_view(4), constant_optics(), {.device = 99}), Error);
}

}  // namespace render_projected_test
}  // namespace subvol
