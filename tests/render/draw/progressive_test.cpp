// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/progressive.h"
#include "subvol/render_tets.h"

namespace subvol {
namespace progressive_test {

const Camera kCamera{.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}};

Optics optics() {
    return {{.color = {{-1, {.1, .2, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .3}, {0, 0}, {1, .4}}}, .1};
}

double rmse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

class Pictures : public Progress {
public:
    void report(std::string_view, double) override {}
    void picture(const Image& image) override { images.push_back(image); }
    [[nodiscard]] bool cancelled() const override { return images.size() >= stop_after; }

    std::vector<Image> images;
    std::size_t stop_after = 1000;
};

TEST(Progressive, PicturesComeNearerToTheLastOne) {
    Pictures pictures;
    const auto result = render_progressively(
        make_model("twist", 8), View(kCamera, 90, 71), optics(),
        {.seconds = 6000, .footprint_px = {4, 2}, .splat = {.method = SplatMethod::Cpu}, .progress = &pictures});
    ASSERT_EQ(result.steps, 5);  // quarter, half, whole, and two finer samplings: cells are 8 pixels wide
    EXPECT_EQ(result.picture_scale, 1);
    EXPECT_EQ(result.footprint_px, 2);
    ASSERT_EQ(pictures.images.size(), 5);
    EXPECT_EQ(pictures.images.back().rgba, result.splat.image.rgba);
    double last = 1;
    for (std::size_t i = 0; i + 1 < pictures.images.size(); ++i) {
        EXPECT_EQ(pictures.images[i].width, 90);
        EXPECT_EQ(pictures.images[i].height, 71);
        ASSERT_EQ(pictures.images[i].rgba.size(), 4u * 90 * 71);
        const double error = rmse(pictures.images[i], pictures.images.back());
        EXPECT_LT(error, last) << i;
        EXPECT_GT(error, 0) << i;
        last = error;
    }
}

TEST(Progressive, WithoutTimeTheFirstPictureIsReturned) {
    const auto result = render_progressively(make_model("twist", 8), View(kCamera, 64, 64), optics(),
                                             {.seconds = 1e-9, .splat = {.method = SplatMethod::Cpu}});
    EXPECT_EQ(result.steps, 1);
    EXPECT_EQ(result.picture_scale, 4);
    EXPECT_EQ(result.splat.image.width, 64);
    EXPECT_EQ(result.splat.depth.size(), 64u * 64);
    const auto* pixel = &result.splat.image.rgba[4 * (32 * 64 + 32)];
    EXPECT_GT(pixel[3], .1f);
    EXPECT_EQ(pixel[3], pixel[4 * 3 + 3]) << "a pixel of the small picture is four pixels wide";
}

TEST(Progressive, RequestToStopEndsTheWork) {
    Pictures pictures;
    pictures.stop_after = 2;
    try {
        (void)render_progressively(make_model("twist", 8), View(kCamera, 64, 64), optics(),
                                   {.seconds = 6000, .splat = {.method = SplatMethod::Cpu}, .progress = &pictures});
        FAIL() << "the work was not stopped";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    }
    EXPECT_EQ(pictures.images.size(), 2);
}

class ProgressiveProjected : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
    HexMesh mesh_ = make_model("twist", 8);
    View view_{kCamera, 70, 61};
};

TEST_F(ProgressiveProjected, PicturesConvergeToTheExactOne) {
    ProjectedRenderer renderer(mesh_);
    const auto exact = render_tets(mesh_, {}, view_, optics()).image;
    Pictures pictures;
    const auto result = render_progressively(renderer, view_, optics(), {.seconds = 6000, .progress = &pictures});
    EXPECT_TRUE(result.finished);
    EXPECT_EQ(result.lod, 1);
    ASSERT_EQ(pictures.images.size(), static_cast<std::size_t>(result.steps));
    ASSERT_GE(result.steps, 5);  // the boundary, three fractions, all
    EXPECT_EQ(pictures.images.back().rgba, result.projected.image.rgba);
    double last = 1;
    for (int i = 0; i < 5; ++i) {
        const double error = rmse(pictures.images[static_cast<std::size_t>(i)], exact);
        EXPECT_LT(error, last) << i;
        last = error;
    }
    EXPECT_LT(last, 1e-5);  // single precision, as in render_projected_test
}

TEST_F(ProgressiveProjected, ListsDrawWhatTheKBufferMisses) {
    for (Vec3& p : mesh_.points) p.z *= 0.02;  // flat cells
    ProjectedRenderer renderer(mesh_);
    const auto havs = renderer.draw(view_, optics(), {.order = ProjectedOrder::Havs, .kbuffer = 1});
    ASSERT_GT(havs.report.late_faces, 0u);
    const auto result =
        render_progressively(renderer, view_, optics(), {.seconds = 6000, .projected = {.kbuffer = 1, .samples = 2}});
    EXPECT_TRUE(result.finished);
    const auto lists = renderer.draw(view_, optics(), {.order = ProjectedOrder::Lists, .samples = 2});
    EXPECT_EQ(result.projected.image.rgba, lists.image.rgba);
}

TEST_F(ProgressiveProjected, WithoutTimeTheBoundaryIsReturned) {
    ProjectedRenderer renderer(mesh_);
    const auto result = render_progressively(renderer, view_, optics(), {.seconds = 1e-9});
    EXPECT_EQ(result.steps, 1);
    EXPECT_EQ(result.lod, 0);
    EXPECT_FALSE(result.finished);
    const auto boundary = renderer.draw(view_, optics(), {.order = ProjectedOrder::Havs, .lod = 0});
    EXPECT_EQ(result.projected.image.rgba, boundary.image.rgba);
}

TEST_F(ProgressiveProjected, RequestToStopEndsTheWork) {
    ProjectedRenderer renderer(mesh_);
    Pictures pictures;
    pictures.stop_after = 2;
    try {
        (void)render_progressively(renderer, view_, optics(), {.seconds = 6000, .progress = &pictures});
        FAIL() << "the work was not stopped";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    }
    EXPECT_EQ(pictures.images.size(), 2);
    EXPECT_THROW((void)render_progressively(renderer, view_, optics(), {.seconds = 0}), Error);
    EXPECT_THROW((void)render_progressively(renderer, view_, optics(), {.lod = {2}}), Error);
}

TEST(Progressive, RefusesImpossibleTimes) {
    EXPECT_THROW((void)render_progressively(make_model("twist", 4), View(kCamera, 8, 8), optics(), {.seconds = 0}), Error);
    EXPECT_THROW((void)render_progressively(make_model("twist", 4), View(kCamera, 8, 8), optics(), {.footprint_px = {0}}),
                 Error);
}

}  // namespace progressive_test
}  // namespace subvol
