// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "subvol/detail/atomic_file.h"
#include "subvol/edit_mesh.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/view_session.h"

namespace subvol {
namespace edit_test {

constexpr double kRounding = 1e-12;

TEST(EditMesh, ATwistTurnsTheUpperEndAndKeepsTheLower) {
    HexMesh mesh = make_model("ball", 3);
    const HexMesh before = mesh;
    twist_points(mesh, Selection(mesh.points.size(), 1.0), Vec3(0.0), Vec3(0, 0, 1), 90);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(mesh.points[p].z, before.points[p].z, kRounding);
        EXPECT_NEAR(glm::length(mesh.points[p]), glm::length(before.points[p]),
                    kRounding);  // from the axis, so from its middle
    }
    const auto top = std::ranges::max_element(before.points, {}, &Vec3::z) - before.points.begin();
    const Vec3 was = before.points[static_cast<std::size_t>(top)], is = mesh.points[static_cast<std::size_t>(top)];
    EXPECT_NEAR(is.x, -was.y, kRounding);
    EXPECT_NEAR(is.y, was.x, kRounding);
}

TEST(EditMesh, ABentRodIsAnArcOfTheSameLength) {
    HexMesh rod;
    for (int k = 0; k <= 100; ++k) rod.points.emplace_back(0, 0, 0.1 * k);
    bend_points(rod, Selection(rod.points.size(), 1.0), Vec3(0.0), Vec3(0, 0, 1), Vec3(1, 0, 0), 90);
    double length = 0;
    for (std::size_t p = 1; p < rod.points.size(); ++p) length += glm::distance(rod.points[p - 1], rod.points[p]);
    EXPECT_NEAR(length, 10, 2e-4);  // a polygon of 100 sides
    const double radius = 10 / (3.14159265358979323846 / 2);
    EXPECT_NEAR(glm::distance(rod.points.back(), Vec3(radius, 0, radius)), 0, 1e-9);
    EXPECT_NEAR(glm::distance(rod.points.front(), Vec3(0.0)), 0, kRounding);
}

TEST(EditMesh, ABrushWorksLessTowardsItsRim) {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    EXPECT_EQ(select_ball(mesh, Vec3(0.0), 1), (Selection{1, 0.5625, 0, 0}));
    move_points(mesh, select_ball(mesh, Vec3(0.0), 1), {0, 0, 1});
    EXPECT_EQ(mesh.points[0].z, 1);
    EXPECT_EQ(mesh.points[1].z, 0.5625);
    EXPECT_EQ(mesh.points[3].z, 0);
}

TEST(EditMesh, PointsBehindTheEyeAreNotSelectedInThePicture) {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}};
    for (const double ortho_height : {0.0, 2.0}) {
        const View view({.eye = {0, 0, 2}, .target = {0, 0, 0}, .up = {0, 1, 0}, .ortho_height = ortho_height}, 20, 20);
        EXPECT_EQ(select_pixels(mesh, view, {5, 5}, {15, 15}), (Selection{1, 1, 0})) << ortho_height;
    }
}

class Editing : public testing::Test {
protected:
    HexMesh mesh = make_model("ball", 3);
    ViewSession session{
        {.input = "ball", .read = [this](std::size_t) { return mesh; }},
        mesh,
        {.camera = fit_camera(bounds(mesh), {-1, 1, -1}), .width = 64, .height = 64, .look = {.look = Look::Solid}},
        {.splat = {.method = SplatMethod::Cpu}}};
};

/// The cells with a corner at which the edges along u, v and w are left-handed.
std::vector<std::size_t> left_handed(const HexMesh& mesh) {
    // The corners in VTK's order by their places in the unit cube.
    constexpr std::array<std::array<int, 3>, 8> kPlaces{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        bool wrong = false;
        for (const auto& place : kPlaces) {
            std::array<Vec3, 3> edges;
            for (std::size_t d = 0; d < 3; ++d) {
                auto low = place, high = place;
                low[d] = 0;
                high[d] = 1;
                const auto at = [&](const std::array<int, 3>& p) {
                    return mesh
                        .points[mesh.cells[c][static_cast<std::size_t>(std::ranges::find(kPlaces, p) - kPlaces.begin())]];
                };
                edges[d] = at(high) - at(low);
            }
            const Vec3 &u = edges[0], &v = edges[1], &w = edges[2];
            wrong = wrong || u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x) < 0;
        }
        if (wrong) found.push_back(c);
    }
    return found;
}

std::size_t red_pixels(const Image& image) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < image.rgba.size(); p += 4)
        count += image.rgba[p] > 0.5F && image.rgba[p + 1] < 0.1F && image.rgba[p + 2] < 0.1F ? 1 : 0;
    return count;
}

TEST_F(Editing, InvertedCellsAreKnownAfterEachMove) {
    EXPECT_TRUE(session.inverted_cells().empty());
    EXPECT_NE(session.state_json().find(R"("inverted_cells": 0)"), std::string::npos);
    std::size_t most = 0, changed = 0, before = 0;
    for (int k = 0; k < 24; ++k) {  // to and fro, so that cells are turned inside out and back
        const double angle = 1.9 * k;
        const std::string ball =
            std::to_string(0.6 * std::cos(angle)) + ", " + std::to_string(0.6 * std::sin(angle)) + ", 0, 0.7";
        session.run(R"({"select": {"ball": [)" + ball + "]}}");
        session.run(k % 3 == 2 ? R"({"undo": true})" : R"({"move": [0.25, -0.1, 0.3]})");
        EXPECT_EQ(session.inverted_cells(), left_handed(session.body().mesh)) << k;
        const std::size_t now = session.inverted_cells().size();
        EXPECT_NE(session.state_json().find("\"inverted_cells\": " + std::to_string(now)), std::string::npos);
        most = std::max(most, now);
        changed += now != before ? 1 : 0;
        before = now;
    }
    EXPECT_GT(most, 3U);
    EXPECT_GT(changed, 6U);
}

TEST_F(Editing, InvertedCellsAreMarkedInPictures) {
    EXPECT_EQ(red_pixels(session.wait()->image), 0U);
    session.run(R"({"select": {"ball": [0, 0, 0.5, 0.5]}})");
    session.run(R"({"move": [0, 0, -1]})");
    ASSERT_FALSE(session.inverted_cells().empty());
    EXPECT_GT(red_pixels(session.wait()->image), 20U);
    session.run(R"({"inverted": false})");
    EXPECT_EQ(red_pixels(session.wait()->image), 0U);
    session.run(R"({"inverted": true})");
    EXPECT_GT(red_pixels(session.wait()->image), 20U);
    session.run(R"({"undo": true})");
    session.run(R"({"undo": true})");
    session.run(R"({"undo": true})");
    EXPECT_EQ(red_pixels(session.wait()->image), 0U) << "the mesh as it was";
}

TEST_F(Editing, SavingSaysWhatIsInverted) {
    const detail::TemporaryFile saved("ball.vtu");
    const std::string save = R"({"save_mesh": ")" + saved.path().string() + "\"}";
    session.run(save);
    EXPECT_TRUE(session.warnings().empty());
    session.run(R"({"select": {"ball": [0, 0, 0.5, 0.5]}})");
    session.run(R"({"move": [0, 0, -1]})");
    session.run(save);
    const std::size_t count = left_handed(session.body().mesh).size();
    ASSERT_EQ(session.warnings().size(), 1U);
    EXPECT_NE(
        session.warnings().front().find(std::to_string(count) + " of its " + std::to_string(mesh.cells.size()) + " cells"),
        std::string::npos)
        << session.warnings().front();
    // A state that was saved with the count is read again.
    const detail::TemporaryFile state("state.json");
    session.run(R"({"save_state": ")" + state.path().string() + "\"}");
    session.run(R"({"undo": true})");
    session.run(R"({"load_state": ")" + state.path().string() + "\"}");
    EXPECT_EQ(session.inverted_cells().size(), count);
}

TEST_F(Editing, PicturesFollowTheMeshAndUndoBringsThemBack) {
    const auto before = session.wait();
    session.run(R"({"select": {"box": [-2, -2, 0.2, 2, 2, 2]}})");
    session.run(R"({"move": [0, 0, 0.5]})");
    const auto moved = session.wait();
    EXPECT_NE(moved->image.rgba, before->image.rgba);
    session.run(R"({"undo": true})");
    EXPECT_EQ(session.wait()->image.rgba, before->image.rgba);
    session.run(R"({"redo": true})");
    EXPECT_EQ(session.wait()->image.rgba, moved->image.rgba);
}

TEST_F(Editing, ADragInManyStepsIsUndoneAsOne) {
    const HexMesh before = session.body().mesh;
    session.run(R"({"select": "all"})");
    session.run(R"({"grab": true})");
    for (int k = 0; k < 20; ++k) session.run(R"({"twist": {"angle": 3}})");
    session.run(R"({"wait": "first"})");
    session.run(R"({"grab": false})");
    const auto dragged = session.wait();
    const HexMesh after = session.body().mesh;
    EXPECT_NE(after.points, before.points);
    // The picture is that of a session that begins with the mesh as it is now.
    ViewSession other({.input = "ball", .read = [&](std::size_t) { return after; }}, after, session.state(),
                      {.splat = {.method = SplatMethod::Cpu}});
    EXPECT_EQ(other.wait()->image.rgba, dragged->image.rgba);
    session.run(R"({"undo": true})");
    EXPECT_EQ(session.body().mesh.points, before.points);
}

/// A refined ball with fine bumps, also of its field.
HexMesh bumpy_ball() {
    HexMesh mesh = refine(make_model("ball", 2), {.levels = 2});
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        mesh.points[p] *= 1 + 0.002 * static_cast<double>(p % 7);
        mesh.attributes.front().values[p] += 0.01 * static_cast<double>(p % 5);
    }
    return mesh;
}

class EditingLevels : public testing::Test {
protected:
    HexMesh mesh = bumpy_ball();
    ViewSession session{
        {.input = "ball", .read = [this](std::size_t) { return mesh; }},
        mesh,
        {.camera = fit_camera(bounds(mesh), {-1, 1, -1}), .width = 64, .height = 64, .look = {.look = Look::Solid}},
        {.splat = {.method = SplatMethod::Cpu}}};
};

TEST_F(EditingLevels, ATurnOfAllControlPointsTurnsTheDetails) {
    session.run(R"({"edit_level": 2})");
    EXPECT_EQ(session.handles().cells.size() * 64, mesh.cells.size());
    session.run(R"({"select": "all"})");
    session.run(R"({"rotate": {"angle": 90, "center": [0, 0, 0]}})");
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3 was = mesh.points[p], is = session.body().mesh.points[p];
        EXPECT_LT(glm::distance(is, Vec3(-was.y, was.x, was.z)), 1e-9);
    }
}

TEST_F(EditingLevels, UndoAndAnotherLevelGoOnFromTheMeshAsItIs) {
    session.run(R"({"edit_level": 1})");
    session.run(R"({"select": {"ball": [0, 0, 1, 0.7]}})");
    const auto move = [&] {
        session.run(R"({"grab": true})");
        for (int k = 0; k < 5; ++k) session.run(R"({"move": [0, 0, 0.05]})");
        session.run(R"({"grab": false})");
    };
    move();
    const std::vector<Vec3> moved = session.body().mesh.points;
    const auto top = std::ranges::max_element(mesh.points, {}, &Vec3::z) - mesh.points.begin();
    const auto low = std::ranges::min_element(mesh.points, {}, &Vec3::z) - mesh.points.begin();
    EXPECT_GT(moved[static_cast<std::size_t>(top)].z, mesh.points[static_cast<std::size_t>(top)].z + 0.1);
    EXPECT_LT(glm::distance(moved[static_cast<std::size_t>(low)], mesh.points[static_cast<std::size_t>(low)]), kRounding);
    session.run(R"({"undo": true})");
    EXPECT_EQ(session.body().mesh.points, mesh.points);
    move();  // the level is that of the mesh before again
    for (std::size_t p = 0; p < moved.size(); ++p) {
        EXPECT_LT(glm::distance(session.body().mesh.points[p], moved[p]), kRounding);
    }
    session.run(R"({"edit_level": 2})");
    EXPECT_TRUE(session.selection().empty());
    session.run(R"({"select": "all"})");
    session.run(R"({"move": [1, 0, 0]})");
    for (std::size_t p = 0; p < moved.size(); ++p) {
        EXPECT_LT(glm::distance(session.body().mesh.points[p], moved[p] + Vec3(1, 0, 0)), 1e-9);
    }
}

TEST_F(EditingLevels, PaintsTheControlValues) {
    session.run(R"({"edit_level": 2})");
    session.run(R"({"select": "all"})");
    session.run(R"({"paint": {"value": 3}})");
    const std::vector<double>& painted = session.body().mesh.attributes.front().values;
    double mean = 0, spread = 0;
    for (const double v : painted) mean += v / static_cast<double>(painted.size());
    for (const double v : painted) spread = std::max(spread, std::abs(v - 3));
    EXPECT_GT(spread, 0);  // the finer details of the field are still there
    EXPECT_NEAR(mean, 3, spread);
}

TEST_F(EditingLevels, RefusesALevelThatIsNotThere) {
    for (const char* wrong : {R"({"edit_level": 3})", R"({"edit_level": -1})", R"({"edit_level": "fine"})"}) {
        EXPECT_THROW(session.run(wrong), Error) << wrong;
    }
    EXPECT_EQ(session.edit_level(), 0);
}

TEST_F(Editing, PaintChangesValuesAndTheMeshGoesToAFile) {
    const auto path = std::filesystem::temp_directory_path() / "subvol_view_edited.vtu";
    session.run(R"({"select": {"ball": [0, 0, 1, 0.5]}})");
    session.run(R"({"paint": {"value": 7}})");
    EXPECT_GT(session.body().range.max, 2);  // the values were at most 1
    session.run(R"({"save_mesh": ")" + path.string() + "\"}");
    const HexMesh read = read_mesh(path).mesh;
    EXPECT_EQ(read.points, session.body().mesh.points);
    EXPECT_EQ(read.attributes.front().values, session.body().mesh.attributes.front().values);
    std::filesystem::remove(path);
}

TEST_F(Editing, TheBrushIsWhereTheBodyIs) {
    (void)session.wait();
    session.run(R"({"select": {"brush": [32, 32, 12]}})");
    Vec3 middle = middle_of(session.body().mesh, session.selection());
    EXPECT_GT(glm::dot(middle, session.state().camera.eye), 0);  // on the side of the eye
    EXPECT_THROW(session.run(R"({"select": {"brush": [1, 1, 5]}})"), Error);
}

TEST_F(Editing, RefusesWhatCannotBeDone) {
    for (const char* wrong :
         {R"({"move": [1, 0, 0]})", R"({"select": {"box": [5, 5, 5, 6, 6, 6]}})", R"({"select": {"ball": [0, 0, 0, 0]}})",
          R"({"select": "some"})", R"({"twist": {"angle": 5}})", R"({"paint": {"strength": 1}})"}) {
        EXPECT_THROW(session.run(wrong), Error) << wrong;
    }
    session.run(R"({"select": "all"})");
    for (const char* wrong : {R"({"move": [1e30, 0, 0]})", R"({"twist": {"angle": 5, "axis": [0, 0, 0]}})", R"({"twist": {}})",
                              R"({"scale": "big"})", R"({"save_mesh": "a.png"})"}) {
        EXPECT_THROW(session.run(wrong), Error) << wrong;
    }
}

}  // namespace edit_test
}  // namespace subvol
