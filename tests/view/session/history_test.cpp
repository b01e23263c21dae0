// SPDX-License-Identifier: Apache-2.0
// Undo takes back whatever actions change, and figures of a comparison belong to the pictures that are shown.
#include <gtest/gtest.h>

#include "small_sessions.h"

namespace subvol {
namespace history_test {

class History : public testing::Test {
protected:
    HexMesh mesh = ball_with_height();
    int compared = 0;
    ViewSession session{{.input = "model:ball:3",
                         .read = [](std::size_t) { return ball_with_height(); },
                         .times = {0, 1, 2},
                         .measure =
                             [this](const Image& a, const Image& b) {
                                 ++compared;
                                 return PictureFigures{rms_difference(a, b), 0};
                             }},
                        mesh,
                        small_state(bounds(mesh), Vec3(-1, 1, -1)),
                        kByCpu};

    void undo() { session.run(R"({"undo": true})"); }
};

TEST_F(History, EveryActionIsTakenBackAndDoneAgain) {
    std::vector<std::string> states{session.state_json()};
    for (const char* action :
         {R"({"orbit": [30, 5]})", R"({"look": "xray"})", R"({"field": "height"})", R"({"add_cut": {"clip": [1, 0, 0]}})",
          R"({"set_cut": {"clip": 0, "plane": [0, 0, 0.2, 0, 0, 1]}})", R"({"step": 1})", R"({"tf": "plasma"})",
          R"({"range": [0.1, 2]})", R"({"log": true})", R"({"symlog": 0.1})", R"({"bands": 7})", R"({"below": [1, 0, 0]})",
          R"({"compare": "tets"})", R"({"legend": true})", R"({"zoom": [2, 10, 10]})"}) {
        session.run(action);
        EXPECT_NE(session.state_json(), states.back()) << action;
        states.push_back(session.state_json());
    }
    for (std::size_t k = states.size() - 1; k > 0; --k) {
        EXPECT_EQ(session.state_json(), states[k]);
        undo();
    }
    EXPECT_EQ(session.state_json(), states.front());
    undo();  // there is nothing before
    EXPECT_EQ(session.state_json(), states.front());
    for (std::size_t k = 1; k < states.size(); ++k) {
        session.run(R"({"redo": true})");
        EXPECT_EQ(session.state_json(), states[k]);
    }
}

TEST_F(History, AMotionIsOneStep) {
    const std::string before = session.state_json();
    for (int k = 0; k < 5; ++k) session.run(R"({"orbit": [3, 0]})");
    const std::string turned = session.state_json();
    session.run(R"({"grab": true})");  // as while a button of the mouse is held
    session.run(R"({"zoom": 1.2})");
    session.run(R"({"slider": 0.3})");
    session.run(R"({"grab": false})");
    undo();
    EXPECT_EQ(session.state_json(), turned);
    undo();
    EXPECT_EQ(session.state_json(), before);
}

TEST_F(History, WhatChangesNothingIsNotKept) {
    session.run(R"({"look": "xray"})");
    for (const char* action :
         {R"({"look": "xray"})", R"({"pick": [24, 20]})", R"({"select": "all"})", R"({"window": {"dark": false}})"})
        session.run(action);
    undo();
    EXPECT_EQ(session.state().look.look, Look::Volume);
}

TEST_F(History, TheSizeOfTheWindowStays) {
    session.run(R"({"look": "xray"})");
    session.run(R"({"size": [60, 30]})");
    undo();
    EXPECT_EQ(session.state().look.look, Look::Volume);
    EXPECT_EQ(session.state().width, 60);
}

TEST_F(History, EditsAreTakenBackAcrossFields) {
    const auto points = session.body().mesh.points;
    session.run(R"({"select": "all"})");
    session.run(R"({"move": [1, 0, 0]})");
    const auto moved = session.body().mesh.points;
    EXPECT_NE(moved, points);
    session.run(R"({"field": "height"})");
    EXPECT_EQ(session.body().mesh.points, moved);
    undo();
    EXPECT_EQ(session.body().mesh.points, moved);
    undo();
    EXPECT_EQ(session.body().mesh.points, points);
    session.run(R"({"field": "height"})");  // the other fields' points have gone back, too
    EXPECT_EQ(session.body().mesh.points, points);
}

TEST_F(History, LoadingAStateIsOneStep) {
    const std::string before = session.state_json();
    session.run(R"({"orbit": [30, 5]})");
    session.run(R"({"tf": "plasma"})");
    const std::string file = testing::TempDir() + "history_state.json";
    session.run(R"({"save_state": ")" + file + "\"}");
    undo();
    undo();
    EXPECT_EQ(session.state_json(), before);
    session.run(R"({"load_state": ")" + file + "\"}");
    EXPECT_EQ(session.state().look.colors, "plasma");
    undo();
    EXPECT_EQ(session.state_json(), before);
}

TEST_F(History, TheDoubleClickedPlaceComesToTheMiddle) {
    session.run(R"({"pick": [30, 18]})");
    const auto picked = session.picked();
    ASSERT_TRUE(picked);
    session.run(R"({"focus": [30, 18]})");
    EXPECT_EQ(session.state().camera.target, picked->place);
    undo();
    EXPECT_NE(session.state().camera.target, picked->place);
    const std::string before = session.state_json();
    session.run(R"({"focus": [0, 0]})");  // beside the body
    EXPECT_EQ(session.state_json(), before);
}

TEST_F(History, ComparisonsHaveFiguresOfBothFullPictures) {
    session.measure();
    EXPECT_FALSE(session.compared());
    session.run(R"({"compare": "tets"})");
    const auto picture = session.wait();
    session.measure();
    ASSERT_TRUE(session.compared());
    EXPECT_GT(session.compared()->psnr, 0);
    session.run(R"({"compare": "splat"})");
    EXPECT_FALSE(session.compared());
    (void)session.wait();
    session.measure();
    ASSERT_TRUE(session.compared());
    EXPECT_EQ(session.compared()->psnr, 0);  // of the same picture twice
    EXPECT_EQ(compared, 2);
}

TEST_F(History, AStoppedPictureIsDrawnByTheNextAction) {
    session.run(R"({"stop": true})");
    session.run(R"({"orbit": [10, 0]})");
    EXPECT_EQ(session.wait()->scale, 1);
}

}  // namespace history_test
}  // namespace subvol
