// SPDX-License-Identifier: Apache-2.0
// Dear ImGui knows widgets by an identifier, a hash of their label and of what they are in. Two of one frame with the same one
// are one widget to it: a click on the first is taken by the second. The linker puts a function of this file before
// ImGui::ItemAdd, which all widgets call, so that the test sees the identifiers of everything that a frame draws.
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "lib/temp_folder.h"
#include "panel.h"
#include "view/session/small_sessions.h"

struct ImRect {  // as in imgui_internal.h
    ImVec2 min, max;
};

namespace subvol {
namespace widgets_test {

struct Widget {
    ImGuiID id = 0;
    ImVec2 middle{};
};

std::vector<Widget>* g_seen = nullptr;  // of the frame that is being drawn

}  // namespace widgets_test
}  // namespace subvol

extern "C" {
// NOLINTBEGIN: names that the linker makes
bool __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect& box, ImGuiID id, const ImRect* box_for_keys, int flags);
bool __wrap__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect& box, ImGuiID id, const ImRect* box_for_keys, int flags);
bool __wrap__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect& box, ImGuiID id, const ImRect* box_for_keys, int flags) {
    if (id != 0 && subvol::widgets_test::g_seen != nullptr)
        subvol::widgets_test::g_seen->push_back({id, {(box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2}});
    return __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(box, id, box_for_keys, flags);
}
// NOLINTEND
}

namespace subvol {
namespace widgets_test {

using detail::WindowHost;
using detail::WindowMemory;

constexpr float kWidth = 900, kHeight = 1400, kPanel = 340;  // high enough for every part of the panel

/// A mesh with names that Dear ImGui would take for marks, in two steps.
HexMesh awkward_mesh() {
    HexMesh mesh = make_model("ball", 2);
    for (const char* name : {"a##1", "a##2", "b###same", "c###same", "##"}) mesh.attributes.push_back({name, 1, {}});
    for (Attribute& field : mesh.attributes) field.values.assign(mesh.points.size(), 1);
    mesh.attributes.front().values.front() = 2;  // a range
    return mesh;
}

/// A session in a window without a screen.
class HiddenWindow {
public:
    explicit HiddenWindow(const std::vector<std::string>& actions) {
        const HexMesh mesh = awkward_mesh();
        ViewSource source{
            .input = "ball", .read = [mesh](std::size_t) { return mesh; }, .times = {0, 1}, .notes = {"one", "two"}};
        auto session = std::make_unique<ViewSession>(std::move(source), mesh, small_state(bounds(mesh), {1, 1, 1}), kByCpu);
        for (const std::string& action : actions) session->run(action);
        options_.extensions = {".vtu"};
        options_.models = {"model:pawn", "model:ball"};
        host_ = detail::window_host(std::move(session), options_);
        context_ = ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {kWidth, kHeight};
        io.DeltaTime = 1.0F / 60;
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        detail::set_style(true, 1);
    }
    ~HiddenWindow() {
        g_seen = nullptr;
        ImGui::DestroyContext(context_);
    }
    HiddenWindow(const HiddenWindow&) = delete;
    HiddenWindow& operator=(const HiddenWindow&) = delete;

    [[nodiscard]] WindowHost& host() { return *host_; }
    [[nodiscard]] WindowMemory& memory() { return memory_; }

    /// Draws a frame as the module does, but for the picture. returns: its widgets
    std::vector<Widget> draw(bool start_page = false) {
        std::vector<Widget> seen;
        (void)host_->settle();
        ImGui::NewFrame();
        g_seen = &seen;
        if (start_page) {
            draw_start_page(*host_, memory_, kWidth, kHeight);
        } else {
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({kWidth - kPanel, kHeight});
            ImGui::Begin("picture", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBringToFrontOnFocus);
            draw_menu(*host_, memory_);
            ImGui::End();
            draw_panel(*host_, memory_, kWidth - kPanel, kPanel, kHeight);
        }
        if (host_->look().help) draw_help(*host_, memory_);
        draw_notes(*host_, memory_);
        draw_file_dialog(*host_, memory_);
        g_seen = nullptr;
        ImGui::Render();
        return seen;
    }

    /// Draws until windows have their sizes.
    std::vector<Widget> settled(bool start_page = false) {
        draw(start_page);
        return draw(start_page);
    }

    /// Clicks on a place. returns: the widgets of the frames meanwhile
    std::vector<std::vector<Widget>> click(const ImVec2& place) {
        std::vector<std::vector<Widget>> frames;
        ImGuiIO& io = ImGui::GetIO();
        io.MousePos = place;
        frames.push_back(draw());
        for (const bool down : {true, false}) {
            io.MouseDown[0] = down;
            frames.push_back(draw());
        }
        for (int k = 0; k < 2; ++k) frames.push_back(draw());  // a list that opens is there in the second frame
        return frames;
    }

private:
    WindowOptions options_{};
    std::unique_ptr<WindowHost> host_;
    WindowMemory memory_{};
    ImGuiContext* context_ = nullptr;
};

/// How many identifiers are of more than one widget.
std::size_t shared(const std::vector<Widget>& widgets) {
    std::map<ImGuiID, std::size_t> times;
    for (const Widget& widget : widgets) ++times[widget.id];
    return static_cast<std::size_t>(std::ranges::count_if(times, [](const auto& one) { return one.second > 1; }));
}

/// Parts of the panel, with what makes all of their widgets visible.
struct Part {
    std::string section;
    std::vector<std::string> actions{};
};

std::vector<Part> parts() {
    return {{""},
            {"colours", {R"({"look": "volume"})", R"({"symlog": 0.5})", R"({"below": [0, 0, 0]})", R"({"above": [1, 1, 1]})"}},
            {"camera"},
            {"cuts",
             {R"({"add_cut": {"clip": [1, 0, 0]}})", R"({"add_cut": {"clip": [0, 1, 0]}})",
              R"({"add_cut": {"slice": [1, 0, 0]}})", R"({"add_cut": {"slice": [0, 1, 0]}})"}},
            {"compare", {R"({"compare": "tets"})"}},
            {"sculpt", {R"({"select": "all"})", R"({"scale": -1})"}},
            {"files"},
            {"input"}};
}

std::vector<std::string> opened(const Part& part) {
    std::vector<std::string> actions = part.actions;
    actions.push_back(R"({"window": {"section": ")" + part.section + R"("}})");
    if (part.section.empty()) actions.back() = R"({"window": {"dark": true}})";
    return actions;
}

class Widgets : public test::TempFolder {
protected:
    void SetUp() override {
        HiddenWindow window({});
        ASSERT_FALSE(window.settled().empty())
            << "Dear ImGui " << IMGUI_VERSION << " does not add its widgets by ImGui::ItemAdd";
        for (const char* name : {"a##1.vtu", "a##2.vtu", "b###same.vtu", "c###same.vtu"}) write(name, "no mesh");
        before_ = std::filesystem::current_path();
        std::filesystem::current_path(path("."));  // buttons write files
    }
    void TearDown() override {
        if (!before_.empty()) std::filesystem::current_path(before_);
    }

private:
    std::filesystem::path before_{};
};

TEST_F(Widgets, ThisTestSeesTwoOfOneIdentifier) {
    HiddenWindow window({});
    window.draw();
    std::vector<Widget> seen;
    ImGui::NewFrame();
    g_seen = &seen;
    float number = 0;
    ImGui::Begin("two");
    ImGui::Button("brush");
    ImGui::SliderFloat("brush", &number, 0, 1);
    ImGui::End();
    g_seen = nullptr;
    ImGui::EndFrame();
    EXPECT_EQ(shared(seen), 1U);
}

TEST_F(Widgets, OfEachPartHaveTheirOwnIdentifiers) {
    HiddenWindow closed(opened({""}));
    std::set<ImGuiID> always;
    for (const Widget& widget : closed.settled()) always.insert(widget.id);
    std::map<ImGuiID, std::string> of_parts;
    for (const Part& part : parts()) {
        HiddenWindow window(opened(part));
        const auto widgets = window.settled();
        EXPECT_EQ(shared(widgets), 0U) << part.section;
        std::size_t own = 0;
        for (const Widget& widget : widgets) {
            if (always.contains(widget.id)) continue;
            ++own;
            const auto [other, fresh] = of_parts.emplace(widget.id, part.section);
            EXPECT_TRUE(fresh) << part.section << " and " << other->second;
        }
        EXPECT_GE(own, part.section.empty() ? 0U : 3U) << part.section;
    }
}

TEST_F(Widgets, OfDialogsHaveTheirOwnIdentifiers) {
    HiddenWindow window({});
    EXPECT_EQ(shared(window.settled(true)), 0U) << "the start page";
    window.host().look().help = window.memory().shows_notes = true;
    EXPECT_EQ(shared(window.settled()), 0U) << "keys and warnings";
    window.memory().dialog.open = true;
    const std::size_t without = HiddenWindow({}).settled().size();
    const auto widgets = window.settled();
    EXPECT_GE(widgets.size(), without + 4) << "the four files";
    EXPECT_EQ(shared(widgets), 0U) << "files";
    window.memory().dialog.open = false;
    window.memory().asks_menu = true;
    window.draw();
    EXPECT_EQ(shared(window.settled()), 0U) << "the menu";
}

TEST_F(Widgets, StayApartWhateverIsClicked) {
    for (const Part& part : parts()) {
        const std::vector<Widget> all = HiddenWindow(opened(part)).settled();
        for (std::size_t k = 0; k < all.size(); ++k) {
            HiddenWindow window(opened(part));
            window.settled();
            const double brush = window.host().look().brush_px;
            for (const auto& frame : window.click(all[k].middle)) EXPECT_EQ(shared(frame), 0U) << part.section << ", " << k;
            const bool is_slider = part.section == "sculpt" && window.host().look().brush_px != brush;
            EXPECT_TRUE(!is_slider || window.host().look().tool == "turn") << "the size changes by its slider alone";
        }
    }
}

TEST_F(Widgets, AToolLeavesTheSizeOfTheBrush) {
    const Part sculpt{"sculpt"};
    std::set<std::string> tools;
    const std::vector<Widget> all = HiddenWindow(opened(sculpt)).settled();
    for (const Widget& widget : all) {
        HiddenWindow window(opened(sculpt));
        window.settled();
        window.click(widget.middle);
        const detail::WindowLook& look = window.host().look();
        if (look.tool == "turn" || look.section != "sculpt") continue;
        tools.insert(look.tool);
        EXPECT_EQ(look.brush_px, detail::WindowLook{}.brush_px) << look.tool;
    }
    EXPECT_EQ(tools.size(), 7U);  // of the eight, `turn` is chosen already
}

}  // namespace widgets_test
}  // namespace subvol
