// SPDX-License-Identifier: Apache-2.0
// Sessions of kernels without a mesh, and what a window starts without waiting.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "small_sessions.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace points_session_test {

class PointsSession : public testing::Test {
protected:
    std::shared_ptr<const RbfVolume> volume = std::make_shared<const RbfVolume>(sample_rbf_points(ball_with_height()).volume);
    ViewSession session{{.input = "points.ply", .points = {.volume = volume, .box = volume->bounds}},
                        mesh_of_points(*volume),
                        small_state(volume->bounds, {0, 1, 0}),
                        kByCpu};
};

TEST_F(PointsSession, AreDrawnAsTheyAreChannelByChannel) {
    for (const std::size_t channel : {0, 1}) {
        session.run(R"({"field": ")" + volume->channels[channel].name + "\"}");
        const auto shown = session.wait();
        const View view(session.state().camera, 48, 40);
        const SplatResult drawn = render_splats(*volume, view, optics_of(session.state(), session.body()),
                                                {.method = SplatMethod::Cpu, .channel = channel});
        EXPECT_EQ(shown->image.rgba, drawn.image.rgba) << channel;
    }
}

TEST_F(PointsSession, ArePickedByTheirSum) {
    session.run(R"({"field": "height"})");
    session.run(R"({"look": "isosurface"})");
    session.run(R"({"look": "solid"})");
    session.run(R"({"pick": [24, 12]})");
    ASSERT_TRUE(session.picked());
    EXPECT_NEAR(session.picked()->value, session.picked()->place.z, 0.02);
    EXPECT_NEAR(session.picked()->gradient.z, 1, 0.1);
    EXPECT_EQ(session.picked()->cell, kNone);
}

TEST_F(PointsSession, HaveNoCellsToDrawOrToEdit) {
    for (const char* wrong : {R"({"method": "tets"})", R"({"method": "grid"})", R"({"compare": "dense"})",
                              R"({"select": "all"})", R"({"edges": true})", R"({"step": 1})"}) {
        EXPECT_THROW(session.run(wrong), Error) << wrong;
    }
    EXPECT_EQ(session.methods(), (std::vector<std::string>{"splat", "sheets"}));
}

class WaitingNowhere : public testing::Test {
protected:
    HexMesh mesh = ball_with_height();
    ViewSession session{
        {.input = "ball",
         .read = [](std::size_t step) { return make_model("ball", step == 0 ? 3 : 2); },
         .times = {0, 1, 2},
         .write_picture = [this](const std::filesystem::path&, const Image& image, const Vec3&) { written = image; }},
        mesh,
        small_state(bounds(mesh), {0, 1, 0}),
        kByCpu};
    Image written{};

    void settle() {
        while (session.busy()) {
            session.settle();
            std::this_thread::yield();
        }
        session.settle();
    }
};

TEST_F(WaitingNowhere, StartsWhatIsSlowAndTakesItsResults) {
    session.run(R"({"look": "solid"})");
    session.start(R"({"pick": [24, 20]})");
    session.start(R"({"screenshot": "a.png"})");
    EXPECT_FALSE(session.picked());  // results are taken by `settle`
    settle();
    ASSERT_TRUE(session.picked());
    EXPECT_EQ(written.rgba, session.wait()->image.rgba);
    session.start(R"({"step": 1})");
    session.start(R"({"step": 2})");
    EXPECT_EQ(session.state().step, 0u);
    settle();
    EXPECT_EQ(session.state().step, 2u);
    EXPECT_LT(session.body().mesh.cells.size(), mesh.cells.size());
    EXPECT_THROW(session.start(R"({"step": 3})"), Error);
    session.start(R"({"orbit": [10, 0]})");  // all else is done at once
    EXPECT_NE(session.state().camera.eye, small_state(bounds(mesh), {0, 1, 0}).camera.eye);
}

TEST_F(WaitingNowhere, DrawsProjectedTetrahedra) {
    if (gl_devices().empty()) GTEST_SKIP() << "there is no OpenGL 4.5";
    session.run(R"({"method": "pt"})");
    const auto shown = session.wait();
    session.run(R"({"method": "tets"})");
    const auto traced = session.wait();
    EXPECT_LT(rms_difference(shown->image, traced->image), 1e-3);  // both are exact, one in single precision
    EXPECT_EQ(shown->backend, "gl");
}

TEST_F(WaitingNowhere, SavesItsColoursForParaView) {
    const auto path = std::filesystem::temp_directory_path() / "subvol_view_map.json";
    session.run(R"({"tf": "coolwarm"})");
    session.run(R"({"opacity": [[0.1, 0], [0.4, 0.25], [1, 0.75]]})");
    const TransferFunction shown = optics_of(session.state(), session.body()).function();
    session.run(R"({"save_tf": ")" + path.string() + "\"}");
    const TransferFunction again = read_transfer_function(path);
    for (int k = 0; k <= 100; ++k) {
        const double value = shown.color.front().value + 0.01 * k * (shown.color.back().value - shown.color.front().value);
        EXPECT_NEAR(glm::distance(color_at(shown, value), color_at(again, value)), 0, 1.0 / 256) << value;
        EXPECT_NEAR(alpha_at(shown, value), alpha_at(again, value), 1e-6) << value;
    }
    std::filesystem::remove(path);
    EXPECT_THROW(session.run(R"({"save_tf": "map.txt"})"), Error);
}

}  // namespace points_session_test
}  // namespace subvol
