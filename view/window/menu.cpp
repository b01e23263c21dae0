// SPDX-License-Identifier: Apache-2.0
// The menu of the picture, tooltips, and the warnings of the file.
#include <imgui.h>

#include <array>
#include <string>

#include "panel.h"

namespace subvol::detail {

namespace {

constexpr double kTip_s = 0.5;  // the pointer rests before a tooltip shows

/// One of several words, of which one is chosen.
void draw_choice(WindowHost& host, WindowMemory& memory, const char* label, const char* action, const std::string& now,
                 const std::vector<std::string>& words) {
    if (!ImGui::BeginMenu(label)) return;
    for (std::size_t k = 0; k < words.size(); ++k) {
        if (draw_entry(k, words[k], words[k] == now)) run(host, memory, action, json_text(words[k]));
    }
    ImGui::EndMenu();
}

void draw_flag(WindowHost& host, WindowMemory& memory, const char* label, const char* key, const char* action, bool now) {
    if (ImGui::MenuItem(label, key, now)) run(host, memory, action, now ? "false" : "true");
}

/// A plane through the middle that faces the eye, so that clipping takes the half in front away.
void add_facing(WindowHost& host, WindowMemory& memory, const char* kind) {
    const Camera& camera = host.state().camera;
    const Vec3 n = glm::normalize(camera.eye - camera.target);
    run(host, memory, "add_cut",
        "{\"" + std::string(kind) + "\": [" + json_text(n.x) + ", " + json_text(n.y) + ", " + json_text(n.z) + "]}");
    host.look().section = "cuts";
}

void draw_camera_items(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    const ImVec2 fine = ImGui::GetIO().DisplayFramebufferScale;
    const ImVec2 at = ImGui::GetMousePosOnOpeningCurrentPopup();
    const std::string pixel = json_text(double{at.x * fine.x}, double{at.y * fine.y});
    if (ImGui::MenuItem("Value at this place", "click")) run(host, memory, "pick", pixel);
    if (ImGui::MenuItem("Bring it to the middle", "double click")) run(host, memory, "focus", pixel);
    ImGui::Separator();
    if (ImGui::MenuItem("Fit", "f")) run(host, memory, "fit", "true");
    if (ImGui::BeginMenu("View")) {
        constexpr std::array kSides{"+x", "-x", "+y", "-y", "+z", "-z", "iso"};
        for (std::size_t k = 0; k < kSides.size(); ++k) {
            if (ImGui::MenuItem(kSides[k], std::to_string(k + 1).c_str()))
                run(host, memory, "view", json_text(std::string(kSides[k])));
        }
        ImGui::EndMenu();
    }
    draw_flag(host, memory, "Orthographic", "o", "ortho", state.camera.ortho_height > 0);
}

}  // namespace

void draw_menu(WindowHost& host, WindowMemory& memory) {
    if (memory.asks_menu) ImGui::OpenPopup("menu");
    memory.asks_menu = false;
    if (!ImGui::BeginPopup("menu")) return;
    if (memory.close_popup) {
        ImGui::CloseCurrentPopup();
        return ImGui::EndPopup();
    }
    const ViewState state = host.state();
    draw_camera_items(host, memory);
    ImGui::Separator();
    draw_choice(host, memory, "Look", "look", std::string(name_of(state.look.look)), names_of<Look>());
    draw_choice(host, memory, "Field", "field", state.field, host.fields());
    draw_choice(host, memory, "Method", "method", std::string(name_of(state.method)), host.methods());
    draw_flag(host, memory, "Axes", "a", "axes", state.axes);
    draw_flag(host, memory, "Control mesh", "m", "edges", state.edges);
    draw_flag(host, memory, "Legend", "l", "legend", state.legend);
    ImGui::Separator();
    if (ImGui::MenuItem("Clip, facing the eye")) add_facing(host, memory, "clip");
    if (ImGui::MenuItem("Slice, facing the eye")) add_facing(host, memory, "slice");
    ImGui::Separator();
    if (ImGui::MenuItem("Undo", "ctrl + z")) run(host, memory, "undo", "true");
    if (ImGui::MenuItem("Redo", "ctrl + y")) run(host, memory, "redo", "true");
    ImGui::Separator();
    if (ImGui::MenuItem("Open a file ...", "ctrl + o")) memory.dialog.open = true;
    const std::string picture = memory.picture_file;
    if (ImGui::MenuItem("Write the picture", "ctrl + p"))
        run_and_tell(host, memory, "screenshot", json_text(picture), "wrote " + picture);
    if (ImGui::MenuItem("Copy as render command", "ctrl + c")) copy_command(host, memory);
    ImGui::EndPopup();
}

void tip(WindowMemory& memory, const char* text, const char* key) {
    if (!ImGui::IsItemHovered()) return;
    if (memory.tip != text) {
        memory.tip = text;
        memory.tip_since = ImGui::GetTime();
    }
    if (ImGui::GetTime() - memory.tip_since < kTip_s) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    ImGui::TextUnformatted(text);
    if (key != nullptr) ImGui::TextDisabled("key: %s", key);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void draw_notes(WindowHost& host, WindowMemory& memory) {
    if (!memory.shows_notes) return;
    const float edge = 24 * memory.scale;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({edge, edge});
    ImGui::SetNextWindowSize({std::min(560 * memory.scale, screen.x - 2 * edge), 0});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x, screen.y - 2 * edge});
    ImGui::Begin("Warnings of the file", &memory.shows_notes, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    for (const std::string& note : host.notes()) {
        ImGui::Bullet();
        ImGui::TextWrapped("%s", note.c_str());
    }
    ImGui::End();
}

}  // namespace subvol::detail
