#include "subvol/render_pt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/hex_meshes.h"
#include "subvol/error.h"
#include "subvol/render.h"

namespace subvol {
namespace {

using test::evaluate;

// Single precision on the device: places to 3e-8 of the diagonal, which is 1e-5 of the opacity unit below.
constexpr double kGlTol = 1e-4;
// Where light has one closed form and few segments.
constexpr double kFewTol = 1e-5;

class RenderPt : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

Optics constant_optics() {
    return {{{{0, {1, 1, 1}}}, {{0, 0.5}}}, 1.0};
}

// Colour and opacity change with the value in [0,1], with kinks and a part that cannot be seen.
Optics ramp_optics(double unit = 1) {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}},
             {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {0.6, 0}, {0.65, 0}, {1, 0.8}}},
            unit};
}

View slanted_view(int size) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

View orthographic_view(int width, int height) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .ortho_height = 1.9}, width, height};
}

View ball_view(int width, int height) {
    return {{.eye = {1.8, -2.9, 1.4}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 38}, width, height};
}

double largest_difference(const Image& a, const Image& b) {
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        const double difference = std::abs(double{a.rgba[i]} - double{b.rgba[i]});
        if (!(difference <= largest)) largest = difference;  // NaN counts
    }
    return largest;
}

double waves(const Vec3& p) {
    return 0.5 + 0.3 * std::sin(7 * p.x + 2 * p.y) + 0.2 * std::cos(9 * p.z - 3 * p.y);
}

/// The mesh drawn both ways.
double difference_from_rays(const HexMesh& mesh, std::span<const double> values, const View& view, const Optics& optics,
                            const PtOptions& options = {}) {
    const auto rays = render_tets(mesh, values, view, optics);
    return largest_difference(render_projected_tets(mesh, values, view, optics, options).image, rays.image);
}

TEST_F(RenderPt, CellsOneByOneAreLikeRays) {
    // Six tetrahedra that fill the picture: silhouettes of three and four corners, thick segments over all of the knots.
    HexMesh mesh = test::box(1);
    for (const double height : {1.0, 0.3, 0.01, 1e-4}) {
        for (std::size_t i = 0; i < 4; ++i) mesh.points[4 + i].z = height * (1 + 0.1 * static_cast<double>(i));
        const auto values = evaluate(mesh, waves);
        for (const View& view : {slanted_view(64), orthographic_view(61, 47)}) {
            EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1)), kGlTol) << height;
        }
    }
}

TEST_F(RenderPt, ConstantBoxIsBeerLambert) {
    const HexMesh mesh = test::jittered_box(6, 0.3, 11);
    const View view({.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = 0.99}, 48, 48);
    const auto result = render_projected_tets(mesh, std::vector<double>(mesh.points.size(), 1.0), view, constant_optics());
    EXPECT_EQ(result.report.tets, 6u * 216);
    for (std::size_t i = 0; i < result.image.rgba.size(); ++i) ASSERT_NEAR(result.image.rgba[i], 0.5f, kFewTol) << i;
}

TEST_F(RenderPt, LinearFieldIsLikeRays) {
    const Vec3 gradient(0.5, 0.2, 0.3);
    for (const HexMesh& mesh : {test::box(4), test::jittered_box(6, 0.3, 5)}) {
        const auto values = evaluate(mesh, [&](const Vec3& p) { return dot(gradient, p); });
        for (const View& view : {slanted_view(64), orthographic_view(61, 47)}) {
            EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.2)), kGlTol);
        }
    }
}

TEST_F(RenderPt, BallIsLikeRays) {
    const HexMesh mesh = test::ball(8);
    const auto values = evaluate(mesh, waves);
    EXPECT_LT(difference_from_rays(mesh, values, ball_view(80, 64), ramp_optics(0.1)), kGlTol);
    // Along diagonals of cells faces are seen edge on, and three corners of a silhouette lie in a line.
    const View diagonal({.eye = {3, -3, 3}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 30}, 96, 96);
    EXPECT_LT(difference_from_rays(mesh, values, diagonal, ramp_optics(0.1)), kGlTol);
}

TEST_F(RenderPt, EyeInsideSeesWhatIsBeforeIt) {
    const HexMesh mesh = test::jittered_box(4, 0.2, 3);
    const auto values = evaluate(mesh, waves);
    const View view({.eye = {0.43, 0.37, 0.52}, .target = {0.9, 0.8, 0.3}, .up = {0, 0, 1}, .fovy_deg = 80}, 48, 40);
    EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1)), kGlTol);
}

TEST_F(RenderPt, FarFromTheOriginNothingChanges) {
    HexMesh mesh = test::jittered_box(4, 0.2, 3);
    const auto values = evaluate(mesh, waves);
    for (Vec3& p : mesh.points) p = 1e-3 * p + Vec3(1000, -2000, 500);
    const Vec3 center = Vec3(1000, -2000, 500) + Vec3(5e-4);
    const View view({.eye = center + Vec3(1.6e-3, 1.2e-3, 2.4e-3), .target = center, .up = {0, 1, 0}, .fovy_deg = 35}, 64, 64);
    EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(1e-4)), kGlTol);
}

TEST_F(RenderPt, ListsAreLikeRays) {
    const Optics optics = ramp_optics(0.1);
    const HexMesh ball = test::ball(8), corner = test::l_shape(6), cell = test::box(1);
    EXPECT_LT(difference_from_rays(ball, evaluate(ball, waves), ball_view(80, 64), optics, {.order = PtOrder::Lists}), kGlTol);
    EXPECT_LT(difference_from_rays(corner, evaluate(corner, waves), slanted_view(64), optics, {.order = PtOrder::Lists}),
              kGlTol);
    EXPECT_LT(difference_from_rays(cell, evaluate(cell, waves), orthographic_view(61, 47), optics, {.order = PtOrder::Lists}),
              kGlTol);
}

TEST_F(RenderPt, TopologicalOrderIsThatOfLists) {
    // Convex meshes without a cycle: the same segments in the same order, but composited from the other end.
    for (const HexMesh& mesh : {test::jittered_box(6, 0.3, 5), test::ball(6)}) {
        const auto values = evaluate(mesh, waves);
        const View view = ball_view(70, 60);
        const auto topological = render_projected_tets(mesh, values, view, ramp_optics(0.1), {.count_violations = true});
        const auto lists = render_projected_tets(mesh, values, view, ramp_optics(0.1), {.order = PtOrder::Lists});
        EXPECT_EQ(topological.report.cycles, 0u);
        EXPECT_EQ(topological.report.violations, 0u);
        EXPECT_EQ(topological.report.fragments, lists.report.fragments);
        EXPECT_LT(largest_difference(topological.image, lists.image), kFewTol);
    }
}

TEST_F(RenderPt, CentroidsAreWrongWhereTheyAreCounted) {
    // Flat cells, seen slantwise: centroids are not in the order of the cells.
    HexMesh mesh = test::box(4);
    for (Vec3& p : mesh.points) p.z *= 0.1;
    const auto values = evaluate(mesh, waves);
    const View view({.eye = {2.5, 2.1, 0.9}, .target = {0.5, 0.5, 0}, .up = {0, 0, 1}, .fovy_deg = 30}, 64, 48);
    const Optics optics = ramp_optics(0.05);
    const auto right = render_projected_tets(mesh, values, view, optics, {.count_violations = true});
    const auto wrong =
        render_projected_tets(mesh, values, view, optics, {.order = PtOrder::Centroid, .count_violations = true});
    const auto lists = render_projected_tets(mesh, values, view, optics, {.order = PtOrder::Lists});
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

TEST_F(RenderPt, ListsInPartsAreTheSame) {
    const HexMesh mesh = test::ball(5);
    const auto values = evaluate(mesh, waves);
    const View view = ball_view(50, 40);
    const auto draw = [&](std::size_t bytes) {
        return render_projected_tets(mesh, values, view, ramp_optics(0.1), {.order = PtOrder::Lists, .list_bytes = bytes});
    };
    const auto whole = draw(1 << 28), rows = draw(32 * 2000), pixels = draw(32 * 150);
    EXPECT_EQ(whole.report.parts, 1u);
    EXPECT_GT(rows.report.parts, 2u);
    EXPECT_GT(pixels.report.parts, 40u) << "rows are divided";
    EXPECT_EQ(rows.image.rgba, whole.image.rgba);
    EXPECT_EQ(pixels.image.rgba, whole.image.rgba);
    EXPECT_EQ(pixels.report.violations, whole.report.violations);
    EXPECT_THROW((void)draw(32), Error);
}

TEST_F(RenderPt, IsTheSameEveryTime) {
    const HexMesh mesh = test::ball(6);
    const auto values = evaluate(mesh, waves);
    for (const PtOrder order : {PtOrder::Centroid, PtOrder::Topological, PtOrder::Lists}) {
        const auto draw = [&] {
            return render_projected_tets(mesh, values, ball_view(50, 50), ramp_optics(0.1), {.order = order}).image.rgba;
        };
        const auto first = draw();
        for (int i = 0; i < 2; ++i) EXPECT_EQ(draw(), first);
    }
}

TEST_F(RenderPt, RefusesWrongInput) {
    const HexMesh mesh = test::box(1);
    EXPECT_THROW((void)render_projected_tets(mesh, std::vector<double>(7), slanted_view(4), constant_optics()), Error);
    EXPECT_THROW(
        (void)render_projected_tets(mesh, std::vector<double>(8, 1.0), slanted_view(4), constant_optics(), {.device = 99}),
        Error);
}

}  // namespace
}  // namespace subvol
