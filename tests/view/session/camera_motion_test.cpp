// SPDX-License-Identifier: Apache-2.0
#include "camera_motion.h"

#include <gtest/gtest.h>

namespace subvol {
namespace camera_motion_test {

constexpr double kRounding = 1e-12;  // of a few rotations

const Camera kFront{.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 30};

TEST(CameraMotion, AFullTurnEndsWhereItBegan) {
    Camera camera = kFront;
    for (int k = 0; k < 12; ++k) camera = detail::orbited(camera, 30, 0);
    EXPECT_NEAR(glm::distance(camera.eye, kFront.eye), 0, kRounding);
}

TEST(CameraMotion, OrbitKeepsTheDistanceAndRises) {
    const Camera camera = detail::orbited(kFront, 0, 40);
    EXPECT_NEAR(glm::distance(camera.eye, camera.target), 5, kRounding);
    EXPECT_NEAR(camera.eye.z, 5 * std::sin(40 * 3.14159265358979323846 / 180), 1e-12);
}

TEST(CameraMotion, NeverPassesThePoles) {
    const Camera camera = detail::orbited(kFront, 10, 500);
    EXPECT_GT(camera.eye.z, 4.99);
    EXPECT_NO_THROW(View(camera, 4, 4));  // up is not parallel to the view
}

TEST(CameraMotion, PanMovesWhatIsAtTheTarget) {
    const View before(kFront, 200, 100), after(detail::panned(kFront, 0.25, 0.5), 200, 100);
    const Vec2 place = after.to_pixels(after.to_eye(kFront.target));
    EXPECT_NEAR(place.x, 100 + 25, 1e-9);  // a quarter and half of the height, in pixels
    EXPECT_NEAR(place.y, 50 - 50, 1e-9);
}

TEST(CameraMotion, ParallelRaysKeepTheSizeAtTheTarget) {
    const Camera parallel = detail::with_parallel_rays(kFront, true);
    const View a(kFront, 100, 100), b(parallel, 100, 100);
    const Vec3 at_target(0.3, 0, 0.2);
    EXPECT_NEAR(glm::distance(a.to_pixels(a.to_eye(at_target)), b.to_pixels(b.to_eye(at_target))), 0, 1e-9);
    EXPECT_NEAR(glm::distance(detail::with_parallel_rays(parallel, false).eye, kFront.eye), 0, kRounding);
}

TEST(CameraMotion, ZoomScalesWhatIsAtTheTarget) {
    const View a(kFront, 100, 100), b(detail::zoomed(kFront, 2), 100, 100);
    const Vec3 near_target(0, 0, 0.1);
    const double before = 50 - a.to_pixels(a.to_eye(near_target)).y, after = 50 - b.to_pixels(b.to_eye(near_target)).y;
    EXPECT_NEAR(after, 2 * before, 1e-9);
}

TEST(CameraMotion, ZoomKeepsThePlaceUnderThePointer) {
    const Vec2 pointer(0.3, -0.2);  // right and up of the middle, in heights
    for (const Camera& camera : {kFront, detail::with_parallel_rays(kFront, true)}) {
        const View before(camera, 200, 100), after(detail::zoomed(camera, 3, pointer), 200, 100);
        const double height = 2 * 5 * std::tan(15 * 3.14159265358979323846 / 180);  // of the picture at the target
        const Vec3 place(height * pointer.x, 0, height * pointer.y);
        EXPECT_NEAR(before.to_pixels(before.to_eye(place)).x, 100 + 30, 1e-9);
        EXPECT_NEAR(glm::distance(before.to_pixels(before.to_eye(place)), after.to_pixels(after.to_eye(place))), 0, 1e-9);
    }
}

TEST(CameraMotion, AimedPutsAPlaceInTheMiddleWithoutTurning) {
    const Vec3 place(0.4, -0.3, 0.2);
    const Camera aimed = detail::aimed(kFront, place);
    const View view(aimed, 200, 100);
    EXPECT_NEAR(glm::distance(view.to_pixels(view.to_eye(place)), Vec2(100, 50)), 0, 1e-9);
    EXPECT_NEAR(glm::distance(aimed.target - aimed.eye, kFront.target - kFront.eye), 0, kRounding);
}

}  // namespace camera_motion_test
}  // namespace subvol
