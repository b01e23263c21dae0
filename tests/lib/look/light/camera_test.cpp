// SPDX-License-Identifier: Apache-2.0
#include "subvol/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "subvol/camera_fit.h"

namespace subvol {
namespace camera_test {

using test::expect_error;

constexpr double kRounding = 1e-12;  // a few operations on numbers of size 1..1000

const Camera kBenchmark{.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 40};

std::array<Vec3, 8> corners(const Box& box) {
    std::array<Vec3, 8> all;
    for (std::size_t k = 0; k < 8; ++k) {
        all[k] = {(k & 1 ? box.upper : box.lower).x, (k & 2 ? box.upper : box.lower).y, (k & 4 ? box.upper : box.lower).z};
    }
    return all;
}

void expect_near(const Vec3& a, const Vec3& b) {
    EXPECT_NEAR(glm::distance(a, b), 0, kRounding);
}

TEST(View, AxesAreRightHandedAndPixelZeroIsTheTopLeft) {
    const View view(kBenchmark, 512, 512);
    const auto& [right, up, forward] = view.axes();
    expect_near(glm::cross(right, up), -forward);
    expect_near(forward, glm::normalize(kBenchmark.target - kBenchmark.eye));
    EXPECT_GT(up.z, 0);
    EXPECT_NEAR(right.z, 0, kRounding);
    const Vec2 first = view.slopes(0.5, 0.5);
    EXPECT_LT(first.x, 0);
    EXPECT_GT(first.y, 0);
    // The picture's upper edge is at half the field of view.
    EXPECT_NEAR(view.slopes(256, 0).y, std::tan(20 * std::numbers::pi / 180), kRounding);
}

TEST(View, RaysAndPixelsAreInverse) {
    Camera orthographic = kBenchmark;
    orthographic.ortho_height = 2.5;
    for (const Camera& camera : {kBenchmark, orthographic}) {
        const View view(camera, 640, 360);
        EXPECT_EQ(view.perspective(), camera.ortho_height == 0);
        for (const Vec2 pixel : {Vec2(0.5, 0.5), Vec2(639.5, 0.5), Vec2(100.25, 300.75)}) {
            for (const double depth : {0.5, 5.0, 80.0}) {
                const Ray ray = view.ray(pixel.x, pixel.y);
                const Vec3 eye_point = view.to_eye(ray.origin + depth * ray.direction);
                EXPECT_NEAR(eye_point.z, depth, 1e-11);  // 80 world units
                const Vec2 back = view.to_pixels(eye_point);
                EXPECT_NEAR(back.x, pixel.x, 1e-10);  // 640 pixels
                EXPECT_NEAR(back.y, pixel.y, 1e-10);
            }
        }
    }
}

TEST(View, OrthographicPictureIsAsHighAsAsked) {
    Camera camera = kBenchmark;
    camera.ortho_height = 2.5;
    const View view(camera, 200, 100);
    EXPECT_NEAR(glm::distance(view.ray(0, 0).origin, view.ray(0, 100).origin), 2.5, kRounding);
    EXPECT_NEAR(glm::distance(view.ray(0, 0).origin, view.ray(200, 0).origin), 5.0, kRounding);
}

TEST(View, RefusesCamerasThatSeeNothing) {
    const auto with = [](auto change) {
        Camera camera = kBenchmark;
        change(camera);
        return [camera] { View(camera, 64, 64); };
    };
    const auto invalid = ErrorCode::InvalidInput;
    expect_error(invalid, "same point", with([](Camera& c) { c.target = c.eye; }));
    expect_error(invalid, "parallel", with([](Camera& c) { c.up = 3.0 * (c.eye - c.target); }));
    expect_error(invalid, "up is zero", with([](Camera& c) { c.up = Vec3(0); }));
    expect_error(invalid, "finite", with([](Camera& c) { c.eye.y = NAN; }));
    expect_error(invalid, "fovy_deg", with([](Camera& c) { c.fovy_deg = 180; }));
    expect_error(invalid, "fovy_deg", with([](Camera& c) { c.fovy_deg = NAN; }));
    expect_error(invalid, "ortho_height", with([](Camera& c) { c.ortho_height = -1; }));
    for (const int size : {0, -1, 65537}) expect_error(invalid, "1..65536", [=] { View(kBenchmark, 64, size); });
    expect_error(invalid, "2^28", [] { View(kBenchmark, 65536, 4097); });
    EXPECT_NO_THROW(View(kBenchmark, 65536, 4096));
}

TEST(View, EndsRaysPixelByPixelInAnySize) {
    View view(kBenchmark, 3, 2);
    EXPECT_TRUE(std::isinf(view.ray(0.5, 0.5).end));
    EXPECT_FALSE(view.ends_rays());
    view.end_rays({1, 2, 3, 4, 5, 6});
    EXPECT_EQ(view.ray(2.5, 1.5).end, 6);
    EXPECT_EQ(view.ray(0.01, 1.99).end, 4);
    EXPECT_EQ(view.ray(-1, -1).end, 1);  // beside the picture: as the next pixel
    const View fine = view.resized(21, 14), coarse = view.resized(1, 1);
    for (int y = 0; y < 14; ++y) {
        for (int x = 0; x < 21; ++x) EXPECT_EQ(fine.ray(x + 0.5, y + 0.5).end, 1 + x / 7 + 3 * (y / 7)) << x << ' ' << y;
    }
    EXPECT_EQ(coarse.ray(0.5, 0.5).end, 5);  // of the pixel at its centre
    EXPECT_EQ(fine.camera().eye, kBenchmark.eye);
}

TEST(View, RefusesEndsOfRaysThatAreNotOneForEachPixel) {
    View view(kBenchmark, 3, 2);
    expect_error(ErrorCode::InvalidInput, "there are 5 depths", [&] { view.end_rays(std::vector<float>(5, 1.0F)); });
    expect_error(ErrorCode::InvalidInput, "a depth is not a number",
                 [&] { view.end_rays(std::vector<float>(6, std::nanf(""))); });
    EXPECT_FALSE(view.ends_rays());
}

TEST(FitCamera, SeesTheWholeBoxWithFivePercentToSpare) {
    const Box box{{-1, 0.5, -3}, {2, 0.75, 4}};
    for (const Vec3 direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -2), Vec3(-1, 1, -1)}) {
        for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
            const View view(fit_camera(box, direction, 30, aspect), static_cast<int>(900 * aspect), 900);
            double reach = 0;  // 1 if a corner touches the edge of the picture
            for (const Vec3& corner : corners(box)) {
                const Vec3 eye_point = view.to_eye(corner);
                ASSERT_GT(eye_point.z, 0);
                const Vec2 pixel = view.to_pixels(eye_point);
                reach = std::max({reach, std::abs(2 * pixel.x / view.width() - 1), std::abs(2 * pixel.y / view.height() - 1)});
            }
            EXPECT_NEAR(reach, 1 / 1.05, 1e-9);
            EXPECT_NEAR(glm::dot(view.axes()[2], glm::normalize(direction)), 1, kRounding);
        }
    }
}

TEST(FitCamera, TakesAFlatBoxAndAPointAndRefusesNone) {
    EXPECT_NO_THROW(View(fit_camera({{0, 0, 0}, {1, 1, 0}}, {1, 0, 0}), 8, 8));
    EXPECT_NO_THROW(View(fit_camera({{3, 3, 3}, {3, 3, 3}}, {1, 0, 0}), 8, 8));
    expect_error(ErrorCode::InvalidInput, "no box", [] { (void)fit_camera({}, {1, 0, 0}); });
    expect_error(ErrorCode::InvalidInput, "direction", [] { (void)fit_camera({{0, 0, 0}, {1, 1, 1}}, {0, 0, 0}); });
}

/// How far a box reaches from the middle of a picture: 1 if a corner touches the edge.
double reach(const Camera& camera, const Box& box, double aspect) {
    const View view(camera, static_cast<int>(900 * aspect), 900);
    double farthest = 0;
    for (const Vec3& corner : corners(box)) {
        const Vec3 eye_point = view.to_eye(corner);
        EXPECT_GT(eye_point.z, 0);
        const Vec2 pixel = view.to_pixels(eye_point);
        farthest = std::max({farthest, std::abs(2 * pixel.x / view.width() - 1), std::abs(2 * pixel.y / view.height() - 1)});
    }
    return farthest;
}

const Box kSlab{{-1, 0.5, -3}, {2, 0.75, 4}};

TEST(FitCamera, MovesAlongTheLineOfSightOnly) {
    Camera orthographic = kBenchmark;
    orthographic.ortho_height = 1e-3;
    for (const Camera& camera : {kBenchmark, orthographic}) {
        for (const double aspect : {0.5, 1.0, 1.5}) {
            const Camera fitted = fit_camera(camera, kSlab, aspect);
            EXPECT_NEAR(reach(fitted, kSlab, aspect), 1 / 1.05, 1e-9);
            const Vec3 forward = glm::normalize(camera.target - camera.eye);
            expect_near(glm::normalize(fitted.target - fitted.eye), forward);
            const Vec3 moved = fitted.eye - camera.eye;
            expect_near(moved, glm::dot(moved, forward) * forward);
            EXPECT_EQ(fitted.fovy_deg, camera.fovy_deg);
            EXPECT_EQ(fitted.up, camera.up);
            EXPECT_EQ(fitted.ortho_height > 0, camera.ortho_height > 0);
        }
    }
}

TEST(FitCamera, WorksFromBehindAndFromInside) {
    for (const Vec3 eye : {Vec3(0.5, 0.6, 0.1), Vec3(0.5, 40, 0.5)}) {
        const Camera camera{.eye = eye, .target = eye + Vec3(0.1, 1, 0), .up = {0, 0, 1}, .fovy_deg = 60};
        EXPECT_NEAR(reach(fit_camera(camera, kSlab, 1), kSlab, 1), 1 / 1.05, 1e-9);
    }
}

TEST(FitCamera, MakesOrthographicCameras) {
    const Camera camera = orthographic_camera(kBenchmark, kSlab, 1.5);
    EXPECT_GT(camera.ortho_height, 0);
    EXPECT_NEAR(reach(camera, kSlab, 1.5), 1 / 1.05, 1e-9);
    // A cube of side 2 from the front is 2.1 high.
    EXPECT_NEAR(orthographic_camera(parse_camera("-y", {{-1, -1, -1}, {1, 1, 1}}), {{-1, -1, -1}, {1, 1, 1}}).ortho_height, 2.1,
                kRounding);
    EXPECT_GT(orthographic_camera(kBenchmark, {{1, 1, 1}, {1, 1, 1}}).ortho_height, 0);
}

// The outline is in the middle of the picture, and points inside it change not even a bit: bricks do not have them.
TEST(FitCamera, OfPointsDependsOnTheirOutlineOnly) {
    std::vector<Vec3> points{{0, 0, 0}, {3, 0.2, 0}, {0.1, 2, 0.3}, {0, 0.4, 1}};
    const Camera camera = fit_camera_to_points(kBenchmark, points, 1.5);
    Vec2 low(INFINITY), high(-INFINITY);
    const View view(camera, 1500, 1000);
    for (const Vec3& p : points) {
        const Vec2 pixel = view.to_pixels(view.to_eye(p));
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    constexpr double kFewSteps_px = 10;  // twice the distance from the middle that four steps leave
    EXPECT_NEAR(low.x + high.x, 1500, kFewSteps_px);
    EXPECT_NEAR(low.y + high.y, 1000, kFewSteps_px);
    points.insert(points.begin() + 2, {Vec3(0.4, 0.4, 0.2), Vec3(1, 0.3, 0.1)});
    const Camera same = fit_camera_to_points(kBenchmark, points, 1.5);
    EXPECT_EQ(same.eye, camera.eye);
    EXPECT_EQ(same.target, camera.target);
}

TEST(Turntable, TurnsAboutUpThroughTheCentre) {
    const Vec3 center(1, 2, 3);
    const Camera first{.eye = {4, 2, 5}, .target = {1, 2.5, 3}, .up = {0, 0, 2}, .fovy_deg = 25};
    const auto cameras = turntable(first, center, 4);
    ASSERT_EQ(cameras.size(), 4u);
    EXPECT_EQ(cameras[0].eye, first.eye);
    EXPECT_EQ(cameras[0].target, first.target);
    expect_near(cameras[1].eye, {1, 5, 5});  // a quarter counter-clockwise: x to y
    expect_near(cameras[1].target, {0.5, 2, 3});
    expect_near(cameras[2].eye, {-2, 2, 5});
    expect_near(cameras[3].eye, {1, -1, 5});
    for (const Camera& camera : cameras) {
        EXPECT_EQ(camera.up, first.up);
        EXPECT_EQ(camera.fovy_deg, 25);
    }
    EXPECT_EQ(turntable(first, center, 1).size(), 1u);
    for (const int frames : {0, -1, 100001}) {
        expect_error(ErrorCode::InvalidInput, "frames", [&] { (void)turntable(first, center, frames); });
    }
}

TEST(Turntable, IsFittedForEveryFrame) {
    for (const double ortho_height : {0.0, 1.0}) {
        Camera camera = kBenchmark;
        camera.ortho_height = ortho_height;
        double farthest = 0;
        for (const Camera& frame : turntable(fit_turntable(camera, kSlab, 12, 1.5), kSlab.center(), 12)) {
            farthest = std::max(farthest, reach(frame, kSlab, 1.5));
        }
        EXPECT_NEAR(farthest, 1 / 1.05, 1e-9);
    }
}

TEST(ParseCamera, AViewStandsOnTheSideItIsNamedFor) {
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_GT(parse_camera("+x", box).eye.x, 1);
    EXPECT_LT(parse_camera("-x", box).eye.x, -1);
    EXPECT_GT(parse_camera("+y", box).eye.y, 1);
    EXPECT_LT(parse_camera("-y", box).eye.y, -1);
    EXPECT_GT(parse_camera("+z", box).eye.z, 1);
    EXPECT_LT(parse_camera("-z", box).eye.z, -1);
    EXPECT_EQ(parse_camera("+z", box).up, Vec3(0, 1, 0));
    EXPECT_EQ(parse_camera("iso", box).up, Vec3(0, 0, 1));
    // The front view: x to the right, z up.
    const View front(parse_camera("-y", box), 10, 10);
    expect_near(front.axes()[0], {1, 0, 0});
    expect_near(front.axes()[1], {0, 0, 1});
}

TEST(ParseCamera, ReadsTenNumbers) {
    const Camera camera = parse_camera("2.6,-4.2,2.0,-.55,0,0,0,0,1,40", {});
    EXPECT_EQ(camera.eye, kBenchmark.eye);
    EXPECT_EQ(camera.target, kBenchmark.target);
    EXPECT_EQ(camera.up, kBenchmark.up);
    EXPECT_EQ(camera.fovy_deg, 40);
    expect_error(ErrorCode::InvalidInput, "ten", [] { (void)parse_camera("1,2,3", {}); });
    expect_error(ErrorCode::InvalidInput, "finite", [] { (void)parse_camera("1,2,nan,0,0,0,0,0,1,40", {}); });
    expect_error(ErrorCode::InvalidInput, "fovy_deg", [] { (void)parse_camera("1,2,3,0,0,0,0,0,1,-40", {}); });
    expect_error(ErrorCode::InvalidInput, "iso", [] { (void)parse_camera("sideways", {}); });
    expect_error(ErrorCode::InvalidInput, "iso", [] { (void)parse_camera("", {}); });
}

class CameraFile : public test::TempFolder {
protected:
    [[nodiscard]] Camera parse(const std::string& content) const {
        return parse_camera(write("camera.json", content).string(), {});
    }
};

TEST_F(CameraFile, IsJson) {
    const Camera camera = parse(R"({"eye": [1, 2, 3], "target": [0, 0, 0.5], "fovy_deg": 25, "ortho_height": 2})");
    EXPECT_EQ(camera.eye, Vec3(1, 2, 3));
    EXPECT_EQ(camera.target, Vec3(0, 0, 0.5));
    EXPECT_EQ(camera.up, Vec3(0, 0, 1));
    EXPECT_EQ(camera.fovy_deg, 25);
    EXPECT_EQ(camera.ortho_height, 2);
}

TEST_F(CameraFile, NamesTheKeyThatIsWrong) {
    const auto refused = [this](const std::string& part, const std::string& content) {
        expect_error(ErrorCode::InvalidInput, part, [&] { (void)parse(content); });
    };
    refused("'target' is missing", R"({"eye": [1, 2, 3]})");
    refused("'eye' is not an array of three", R"({"eye": [1, 2], "target": [0, 0, 0]})");
    refused("'eye' is not an array of three", R"({"eye": [1, 2, "3"], "target": [0, 0, 0]})");
    refused("'fovy_deg' is not a number", R"({"eye": [1, 2, 3], "target": [0, 0, 0], "fovy_deg": "wide"})");
    refused("not a JSON object", "[1, 2]");
    refused("camera.json", R"({"eye": )");
    expect_error(ErrorCode::Io, "cannot be read", [this] { (void)parse_camera(path(".").string(), {}); });
}

TEST(ParseCamera, AnotherAxisIsUp) {
    // A body of three lengths, turned so that its z becomes y or x: the picture of each side is the same.
    const Box z_up{{-1, -2, -3}, {2, 3, 5}};
    for (const UpAxis up : {UpAxis::X, UpAxis::Y}) {
        Box turned;
        for (const Vec3& corner : {z_up.lower, z_up.upper}) turned.add(turned_upright(corner, up));
        EXPECT_EQ(turned_upright(Vec3(0, 0, 1), up), up == UpAxis::X ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
        for (const char* side : {"iso", "front", "back", "left", "right", "top", "bottom"}) {
            const View straight(parse_camera(side, z_up, 1.5), 60, 40), after(parse_camera(side, turned, 1.5, up), 60, 40);
            const Vec3 place(.3, -1.2, 2.7);
            EXPECT_LT(glm::distance(straight.to_eye(place), after.to_eye(turned_upright(place, up))), 1e-12) << side;
        }
        // The axes keep their names, with the axis up in the picture unless the view is along it.
        const Camera front = parse_camera("+z", turned, 1, up);
        EXPECT_GT(front.eye.z, turned.upper.z);
        EXPECT_EQ(front.up, turned_upright(Vec3(0, 0, 1), up));
        const Camera above = parse_camera(up == UpAxis::X ? "+x" : "+y", turned, 1, up);
        EXPECT_EQ(above.up, turned_upright(Vec3(0, 1, 0), up));
    }
}

}  // namespace camera_test
}  // namespace subvol
