// SPDX-License-Identifier: Apache-2.0
#include "subvol/view_session.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "seen_view.h"
#include "small_sessions.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/splat.h"

namespace subvol {
namespace view_session_test {

const Vec3 kFromCorner(-1, 1, -1);

class Session : public testing::Test {
protected:
    HexMesh mesh = ball_with_height();
    ViewSession session{{.input = "model:ball:3", .read = [](std::size_t) { return ball_with_height(); }, .times = {0, 1, 2}},
                        mesh,
                        small_state(bounds(mesh), kFromCorner),
                        kByCpu};

    [[nodiscard]] std::string refusal(const std::string& action) {
        try {
            session.run(action);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << action;
            return error.what();
        }
        return {};
    }
};

TEST_F(Session, ShowsThePictureOfTheRendererBitForBit) {
    session.run(R"({"orbit": [25, 10]})");
    session.run(R"({"opacity": [[-1, 0], [1, 0.8]]})");
    const auto shown = session.wait();
    const ViewState& state = session.state();
    const RbfVolume volume = sample_rbf_points(session.body().mesh).volume;
    const View view(state.camera, state.width, state.height);
    const SplatResult drawn = render_splats(volume, view, optics_of(state, session.body()), {.method = SplatMethod::Cpu});
    EXPECT_EQ(shown->image.rgba, drawn.image.rgba);
    EXPECT_EQ(shown->scale, 1);
}

TEST_F(Session, TheSameStateGivesTheSamePicture) {
    const auto before = session.wait();
    session.run(R"({"orbit": [90, 0]})");
    session.run(R"({"method": "tets"})");
    const auto other = session.wait();
    EXPECT_NE(other->image.rgba, before->image.rgba);
    session.run(R"({"method": "splat"})");
    for (int k = 0; k < 3; ++k) session.run(R"({"orbit": [90, 0]})");
    // Four quarter turns: the eye is back up to rounding, so the picture is, too.
    const auto after = session.wait();
    double most = 0;
    for (std::size_t k = 0; k < after->image.rgba.size(); ++k)
        most = std::max(most, std::abs(double{after->image.rgba[k]} - double{before->image.rgba[k]}));
    EXPECT_LT(most, 1e-3);
}

TEST_F(Session, ReferenceAndSplatsShowTheSame) {
    const auto splats = session.wait();
    session.run(R"({"method": "tets"})");
    const auto tets = session.wait();
    EXPECT_LT(rms_difference(tets->image, splats->image), 0.03);  // one kernel for each control point of 3³ cells
}

TEST_F(Session, CutsThePictureAndBringsItBack) {
    const auto whole = session.wait();
    session.run(R"({"clip": [[0, 0, 0, 1, 0, 0]]})");
    const auto cut = session.wait();
    const ViewState& state = session.state();
    const SplatOptions options{.method = SplatMethod::Cpu, .clip = {.planes = {{{0, 0, 0}, {1, 0, 0}}}}};
    const SplatResult drawn =
        render_splats(sample_rbf_points(session.body().mesh).volume, View(state.camera, state.width, state.height),
                      optics_of(state, session.body()), options);
    EXPECT_EQ(cut->image.rgba, drawn.image.rgba);
    EXPECT_NE(session.render_command().find("--clip 0,0,0,1,0,0"), std::string::npos);
    session.run(R"({"clip": []})");
    EXPECT_EQ(session.wait()->image.rgba, whole->image.rgba);
    session.run(R"({"slice": [[0, 0, 0, 0, 0, 1]]})");
    session.run(R"({"clip_box": [-1, -1, -1, 1, 0, 1]})");
    const auto slice = session.wait();
    EXPECT_NE(slice->image.rgba, whole->image.rgba);
    EXPECT_THROW(session.run(R"({"clip": [[0, 0, 0, 0, 0, 0]]})"), Error);
    EXPECT_THROW(session.run(R"({"clip_box": [1, 0, 0, 0, 1, 1]})"), Error);
}

TEST_F(Session, StateGoesToAFileAndBack) {
    const auto path = std::filesystem::temp_directory_path() / "subvol_view_state.json";
    session.run(R"({"orbit": [33, 5]})");
    session.run(R"({"tf": "coolwarm"})");
    session.run(R"({"range": [-0.5, 0.5]})");
    session.run(R"({"field": "height"})");
    const std::string saved = session.state_json();
    const auto picture = session.wait();
    session.run(R"({"save_state": ")" + path.string() + "\"}");
    session.run(R"({"view": "+x"})");
    session.run(R"({"look": "xray"})");
    session.run(R"({"range": null})");
    session.run(R"({"field": "density"})");
    EXPECT_NE(session.state_json(), saved);
    session.run(R"({"load_state": ")" + path.string() + "\"}");
    EXPECT_EQ(session.state_json(), saved);
    EXPECT_EQ(session.wait()->image.rgba, picture->image.rgba);
    std::filesystem::remove(path);
}

/// A pipe has no end that anything here would wait for; the session stays as it is.
TEST_F(Session, AStateNamesNoPipe) {
    const auto folder = std::filesystem::temp_directory_path() / ("subvol_view_pipe_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    ASSERT_EQ(::mkfifo((folder / "f.vtu").c_str(), 0600), 0);
    const auto state = (folder / "s.json").string();
    const std::string saved = session.state_json();
    for (const std::string name : {"f.vtu", "/dev/zero", "nothing.vtu"}) {
        std::ofstream(state) << R"({"mesh": ")" << name << "\"}";
        const std::string said = refusal(R"({"load_state": ")" + state + "\"}");
        EXPECT_NE(said.find("s.json, mesh: "), std::string::npos) << said;
        EXPECT_NE(said.find(name == "nothing.vtu" ? "there is no file" : "is not a regular file"), std::string::npos) << said;
    }
    EXPECT_EQ(session.state_json(), saved);
    std::filesystem::remove_all(folder);
}

TEST_F(Session, TheCommandNamesWhatIsShown) {
    session.run(R"({"opacity": [[0, 0.25], [0.5, 1]]})");
    session.run(R"({"step": 1})");
    session.run(R"({"ortho": true})");
    const std::string command = session.render_command();
    for (const char* words : {"subvol render model:ball:3 -o picture.png", "--size 48x40", "--look volume",
                              "--opacity 0:0.25,0.5:1", "--field density", "--step 1"}) {
        EXPECT_NE(command.find(words), std::string::npos) << command;
    }
}

TEST_F(Session, PicksTheLimitUnderThePointer) {
    session.run(R"({"look": "solid"})");
    session.run(R"({"field": "height"})");
    session.run(R"({"view": "-y"})");
    session.run(R"({"pick": [24, 10]})");
    ASSERT_TRUE(session.picked());
    EXPECT_NEAR(session.picked()->value, session.picked()->place.z, 1e-5);  // the field is the height; the limit reproduces it
    EXPECT_NEAR(session.picked()->gradient.z, 1, 1e-3);
    EXPECT_NEAR(session.picked()->place.x, 0, 1e-3);  // in the middle of the picture
    EXPECT_LT(session.picked()->place.y, 0);          // on the side of the eye
    session.run(R"({"pick": [0, 0]})");
    EXPECT_FALSE(session.picked());
}

TEST_F(Session, RefusesInOneSentenceAndChangesNothing) {
    const std::string before = session.state_json();
    EXPECT_NE(refusal(R"({"orbits": [1, 2]})").find("did you mean orbit"), std::string::npos);
    EXPECT_NE(refusal(R"({"orbit": [1]})").find("array of 2 numbers"), std::string::npos);
    for (const char* wrong : {"",
                              "[]",
                              "7",
                              R"({"orbit": "far"})",
                              R"({"zoom": 0})",
                              R"({"view": "up"})",
                              R"({"size": [0, 5]})",
                              R"({"size": [1e9, 5]})",
                              R"({"field": "nothing"})",
                              R"({"step": 3})",
                              R"({"method": "magic"})",
                              R"({"look": "nice"})",
                              R"({"tf": "nice"})",
                              R"({"range": [2, 1]})",
                              R"({"opacity": [[1, 0], [0, 1]]})",
                              R"({"opacity": [[0, 2]]})",
                              R"({"opacity_unit": -1})",
                              R"({"symlog": 0})",
                              R"({"bands": 1001})",
                              R"({"below": [1, 2, 0]})",
                              R"({"above": "red"})",
                              R"({"background": [2, 0, 0]})",
                              R"({"camera": [1, 2]})",
                              R"({"camera": {"eye": [0,0,0], "target": [0,0,0]}})",
                              R"({"axes": 1})",
                              R"({"orbit": [1, 2], "zoom": 2})",
                              R"({"screenshot": "a.png"})",
                              R"({"wait": "long"})"}) {
        EXPECT_NE(refusal(wrong), "") << wrong;
    }
    EXPECT_EQ(session.state_json(), before);
}

TEST_F(Session, AStepWithoutTheFieldChangesNothing) {
    const auto read = [&](std::size_t step) { return step == 1 ? make_model("ball", 2) : mesh; };
    ViewSession steps({.input = "ball", .read = read, .times = {0, 1, 2}}, mesh, small_state(bounds(mesh), kFromCorner),
                      kByCpu);
    steps.run(R"({"field": "height"})");
    const std::string before = steps.state_json();
    EXPECT_THROW(steps.run(R"({"step": 1})"), Error);
    EXPECT_EQ(steps.state_json(), before);
    EXPECT_EQ(steps.fields(), session.fields());
    steps.run(R"({"step": 2})");
    EXPECT_EQ(steps.state().step, 2u);
}

TEST_F(Session, AScriptNamesTheActionThatIsWrong) {
    try {
        session.run_script(R"([{"orbit": [1, 2]}, {"zoom": "in"}])", "turn.json");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("turn.json, action 2: zoom"), std::string::npos) << error.what();
    }
}

TEST_F(Session, ComparesTwoMethodsLeftAndRightOfTheSlider) {
    const auto splats = session.wait();
    session.run(R"({"compare": "tets"})");
    session.run(R"({"slider": 0.25})");
    const Image both = session.composed(*session.wait());
    session.run(R"({"compare": null})");
    session.run(R"({"method": "tets"})");
    const auto tets = session.wait();
    for (int y = 0; y < both.height; ++y) {
        for (int x = 0; x < both.width; ++x) {
            if (x == both.width / 4) continue;  // the line
            const Image& side = x < both.width / 4 ? splats->image : tets->image;
            EXPECT_TRUE(std::ranges::equal(both.pixel(x, y), side.pixel(x, y))) << x << ", " << y;
        }
    }
}

TEST_F(Session, ManyMotionsEndInTheLastPicture) {
    for (int k = 0; k < 50; ++k) session.run(R"({"orbit": [7, 0]})");
    const auto shown = session.wait();
    EXPECT_EQ(shown->state.camera.eye, session.state().camera.eye);
    EXPECT_EQ(shown->scale, 1);
    EXPECT_FALSE(session.worker().busy());
}

TEST(SolidSession, ShowsTheColoursOfTheBoundary) {
    const HexMesh mesh = make_model("ball", 3);
    ViewSession session({.input = "ball", .read = [&](std::size_t) { return mesh; }}, mesh,
                        small_state(bounds(mesh), kFromCorner, Look::Solid), kByCpu);
    const auto shown = session.wait();
    const ViewState& state = session.state();
    const Optics optics = optics_of(state, session.body());
    const View view(state.camera, state.width, state.height);
    const BoundaryValues skin = boundary_values(session.body().mesh, {.levels = picture_levels(session.body().mesh)});
    const Image image = draw_boundary(skin.surface, skin.values.back(), view, optics, Shading{}, 2).image;
    EXPECT_EQ(shown->image.rgba, image.rgba);
}

TEST(FitSession, TheBodyIsBesideTheLegend) {
    const HexMesh mesh = make_model("ball", 3);
    ViewState state = small_state(bounds(mesh), kFromCorner, Look::Solid);
    state.width = 260;
    state.height = 240;
    state.legend = true;
    ViewSession session({.input = "ball", .read = [&](std::size_t) { return mesh; }}, mesh, state, kByCpu);
    session.run(R"({"fit": true})");
    const View seen = detail::seen_view(session.state(), session.body());
    ASSERT_LT(seen.width(), seen.height()) << "the legend decides how far the camera is";
    const auto shown = session.wait();
    int first = seen.width(), last = -1;
    for (int x = 0; x < seen.width(); ++x) {
        for (int y = 0; y < seen.height(); ++y) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(shown->image.width) + static_cast<std::size_t>(x);
            if (shown->image.rgba[4 * pixel + 3] < .5F) continue;
            first = std::min(first, x);
            last = std::max(last, x);
        }
    }
    EXPECT_GT(first, 0);
    EXPECT_LT(last, seen.width() - 1);
    EXPECT_GT(last - first, seen.width() * 3 / 4);
}

TEST(WrongLook, BecomesTheErrorOfThePicture) {
    const HexMesh mesh = make_model("ball", 2);
    ViewSession session({.input = "ball", .read = [&](std::size_t) { return mesh; }}, mesh,
                        small_state(bounds(mesh), kFromCorner, Look::Isosurface), kByCpu);
    (void)session.wait();
    session.run(R"({"method": "tets"})");
    EXPECT_THROW((void)session.wait(), Error);
    session.run(R"({"method": "splat"})");
    EXPECT_NO_THROW((void)session.wait());
}

}  // namespace view_session_test
}  // namespace subvol
