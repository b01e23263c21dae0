// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/view_session.h"

namespace subvol {
namespace cut_actions_test {

class Cuts : public testing::Test {
protected:
    HexMesh mesh = make_model("ball", 2);
    ViewSession session{{.input = "ball"},
                        mesh,
                        {.camera = fit_camera(bounds(mesh), {-1, 0.6, -0.4}), .width = 200, .height = 160},
                        {.splat = {.method = SplatMethod::Cpu}}};

    [[nodiscard]] const CutPlane& plane() const { return session.state().clip.planes.at(0); }
    [[nodiscard]] double offset() const { return glm::dot(plane().point, plane().normal); }
};

TEST_F(Cuts, AreAddedInTheMiddleAndRemoved) {
    session.run(R"({"add_cut": {"clip": [0, 0, 2]}})");
    session.run(R"({"add_cut": {"slice": [1, 0, 0]}})");
    ASSERT_EQ(session.state().clip.planes.size(), 1u);
    EXPECT_EQ(plane().point, session.body().box.center());
    ASSERT_EQ(session.cut_handles().size(), 2u);
    EXPECT_TRUE(session.cut_handles()[1].slice);
    session.run(R"({"remove_cut": {"clip": 0}})");
    EXPECT_TRUE(session.state().clip.planes.empty());
    EXPECT_EQ(session.state().clip.slices.size(), 1u);
}

TEST_F(Cuts, MoveAlongTheirNormal) {
    session.run(R"({"clip": [[0.3, 0.2, 0.1, 1, 2, -1]]})");
    const double before = glm::dot(plane().point, glm::normalize(plane().normal));
    session.run(R"({"move_cut": {"clip": 0, "by": 0.25}})");
    EXPECT_NEAR(offset(), before + 0.25, 1e-12);
    EXPECT_NEAR(glm::length(plane().normal), 1, 1e-12);
}

TEST_F(Cuts, FollowThePointer) {
    session.run(R"({"clip": [[0, 0, 0, 1, 1, 0.3]]})");
    const detail::CutHandle before = session.cut_handles().at(0);
    const Vec2 along = glm::normalize(before.tip - before.at);
    session.run(R"({"move_cut": {"clip": 0, "drag": [)" + std::to_string(8 * along.x) + ", " + std::to_string(8 * along.y) +
                "]}}");
    const detail::CutHandle after = session.cut_handles().at(0);
    EXPECT_NEAR(glm::distance(after.at, before.at), 8, 0.5);  // the handle comes nearer to the eye or goes away from it
    const Vec2 across(-along.y, along.x);
    session.run(R"({"move_cut": {"clip": 0, "drag": [)" + std::to_string(8 * across.x) + ", " + std::to_string(8 * across.y) +
                "]}}");
    EXPECT_NEAR(glm::distance(session.cut_handles().at(0).at, after.at), 0, 0.05);
}

TEST_F(Cuts, HaveTheirHandlesBesideTheLegend) {
    session.run(R"({"clip": [[0, 0, 0, 1, 0, 0]]})");
    EXPECT_NEAR(session.cut_handles().at(0).at.x, 100, 0.5);  // the middle of the picture
    session.run(R"({"size": [400, 160]})");
    session.run(R"({"legend": true})");
    const auto shown = session.wait();
    EXPECT_EQ(shown->image.width, 400);
    const double middle = session.cut_handles().at(0).at.x;
    EXPECT_LT(middle, 195);
    session.run(R"({"pick": [)" + std::to_string(middle) + ", 80]}");
    ASSERT_TRUE(session.picked());
    EXPECT_NEAR(glm::length(glm::cross(session.picked()->place, glm::normalize(session.state().camera.eye))), 0, 0.02);
}

TEST_F(Cuts, TurnAboutTheirHandle) {
    session.run(R"({"clip": [[0, 0, 0.4, 0, 0, 1]]})");
    const Vec3 normal = plane().normal;
    session.run(R"({"turn_cut": {"clip": 0, "by": [20, 0]}})");
    session.run(R"({"turn_cut": {"clip": 0, "by": [0, 35]}})");
    EXPECT_NEAR(glm::length(plane().normal), 1, 1e-12);
    EXPECT_GT(glm::distance(plane().normal, normal), 0.3);
    session.run(R"({"turn_cut": {"clip": 0, "flip": true}})");
    const Vec3 flipped = plane().normal;
    session.run(R"({"turn_cut": {"clip": 0, "flip": true}})");
    EXPECT_NEAR(glm::distance(plane().normal, -flipped), 0, 1e-12);
}

TEST_F(Cuts, APlaneThatFacesTheEyeTurnsToTheSideOfTheDrag) {
    const Camera& camera = session.state().camera;
    const Vec3 to_eye = glm::normalize(camera.eye - camera.target);
    const auto number = [](double x) { return std::to_string(x); };
    session.run(R"({"clip": [[0, 0, 0, )" + number(to_eye.x) + ", " + number(to_eye.y) + ", " + number(to_eye.z) + "]]}");
    session.run(R"({"turn_cut": {"clip": 0, "by": [30, 0]}})");
    const auto handle = session.cut_handles().at(0);
    EXPECT_GT(handle.tip.x, handle.at.x + 5);
    session.run(R"({"turn_cut": {"clip": 0, "by": [0, 30]}})");
    EXPECT_LT(session.cut_handles().at(0).tip.y, handle.tip.y - 5);  // rows are counted downwards
}

TEST_F(Cuts, AreRefusedInOneSentence) {
    session.run(R"({"clip": [[0, 0, 0, 1, 0, 0]]})");
    const std::string before = session.state_json();
    for (const char* wrong :
         {R"({"move_cut": {"clip": 1, "by": 0}})", R"({"move_cut": {"by": 0}})", R"({"move_cut": {"clip": 0}})",
          R"({"move_cut": {"slice": 0, "by": 1}})", R"({"turn_cut": {"clip": 0, "by": [1]}})",
          R"({"turn_cut": {"clip": -1, "by": [1, 1]}})", R"({"add_cut": {"clip": [0, 0, 0]}})", R"({"add_cut": 7})",
          R"({"remove_cut": {"slice": 0}})", R"({"move_cut": {"clip": 0, "by": "far"}})"}) {
        EXPECT_THROW(session.run(wrong), Error) << wrong;
    }
    EXPECT_EQ(session.state_json(), before);
}

}  // namespace cut_actions_test
}  // namespace subvol
