// SPDX-License-Identifier: Apache-2.0
// Keys of the window, and the list of them that is shown as help. A key becomes an action of the session, or a change of the
// window's look, such as a panel or a tool:
//
//     always                Escape, ctrl + o, F1
//     no file is shown      the letters for help, quit, and dark or light panels
//     a file is shown       letters; ctrl and a letter; arrows, with shift too; Tab, F12, Enter
//
// Letters come as characters, other keys and those with ctrl by number. No key is taken while the file dialog is open, but for
// Escape and the one that opens it. Escape leaves one thing at a time: the dialog, a menu, notes or help, a tool, playing, and
// then what is at work. Edits that are in no file are dropped only at the second attempt.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <string>

#include "panel.h"

namespace subvol::detail {

namespace {

struct Line {
    const char *keys, *effect;
};

constexpr std::array kLines{Line{"drag, arrows", "turn"},
                            Line{"shift + drag, middle button", "move"},
                            Line{"wheel, right button", "larger, smaller, about the pointer"},
                            Line{"click", "value, place and cell under the pointer"},
                            Line{"double click", "brings the place to the middle"},
                            Line{"right click", "menu"},
                            Line{"+  -  f, Enter", "larger, smaller, fit"},
                            Line{"1 ... 6  7, 9", "views +x -x +y -y +z -z iso"},
                            Line{"o", "orthographic or perspective"},
                            Line{"k", "next look"},
                            Line{"s  t  p  d  v", "method: splat, tets, pt, dense, grid"},
                            Line{"n", "next field"},
                            Line{",  .  space", "step before, step after, play"},
                            Line{"a  m  l", "axes, control mesh, legend"},
                            Line{"r  [  ]  x", "reference beside it, its border, difference"},
                            Line{"e", "next tool for the mesh; shift + drag selects"},
                            Line{"ctrl + z, ctrl + y", "undo, redo"},
                            Line{"ctrl + o", "open a file"},
                            Line{"ctrl + p, F12", "write the picture"},
                            Line{"ctrl + s, ctrl + l", "save the state, load it"},
                            Line{"ctrl + c", "copy as render command"},
                            Line{"Tab, b", "hide the panel; dark or light"},
                            Line{"Esc", "leaves menus, tools, what is at work"},
                            Line{"?, h, F1;  q", "these keys; quit"}};

void next_look(WindowHost& host, WindowMemory& memory) {
    const std::vector<std::string> names = names_of<Look>();
    const auto shown = std::ranges::find(names, name_of(host.state().look.look));
    run(host, memory, "look", json_text(shown + 1 == names.end() ? names.front() : shown[1]));
}

void next_field(WindowHost& host, WindowMemory& memory) {
    const auto names = host.fields();
    const auto now = std::ranges::find(names, host.state().field);
    if (names.size() < 2) return;
    const std::size_t next = now == names.end() ? 0 : (static_cast<std::size_t>(now - names.begin()) + 1) % names.size();
    run(host, memory, "field", json_text(names[next]));
}

void go_to_step(WindowHost& host, WindowMemory& memory, int by) {
    const int count = static_cast<int>(host.times().size());
    if (count > 1) run(host, memory, "step", std::to_string((static_cast<int>(host.state().step) + by + count) % count));
}

void with_control(WindowHost& host, WindowMemory& memory, int key) {
    const std::string picture = memory.picture_file, state = memory.state_file;
    if (key == GLFW_KEY_P) run_and_tell(host, memory, "screenshot", json_text(picture), "wrote " + picture);
    if (key == GLFW_KEY_S) save_state(host, memory);
    if (key == GLFW_KEY_L) run_and_tell(host, memory, "load_state", json_text(state), "read " + state);
    if (key == GLFW_KEY_Z) run(host, memory, "undo", "true");
    if (key == GLFW_KEY_Y) run(host, memory, "redo", "true");
    if (key == GLFW_KEY_C) copy_command(host, memory);
}

void next_tool(WindowHost& host) {
    constexpr std::array kTools{"turn", "brush", "move", "rotate", "scale", "twist", "bend", "paint"};
    const auto now = std::ranges::find(kTools, host.look().tool);
    const std::size_t next = now == kTools.end() ? 0 : static_cast<std::size_t>(now - kTools.begin()) + 1;
    host.look().tool = kTools[next % kTools.size()];
    host.look().section = "sculpt";
}

const char* toggled(bool now) {
    return now ? "false" : "true";
}

void take_letter(WindowHost& host, WindowMemory& memory, unsigned letter) {
    const ViewState& state = host.state();
    constexpr std::array kSides{"+x", "-x", "+y", "-y", "+z", "-z", "iso"};
    if (letter >= '1' && letter <= '7') run(host, memory, "view", json_text(std::string(kSides[letter - '1'])));
    switch (letter) {
        case '9':
            run(host, memory, "view", "\"iso\"");
            break;
        case '?':
        case 'h':
            host.look().help = !host.look().help;
            break;
        case 'q':
            memory.quit = may_drop_edits(host, memory);
            break;
        case '+':
        case '=':
            run(host, memory, "zoom", "1.2");
            break;
        case '-':
            run(host, memory, "zoom", json_text(1 / 1.2));
            break;
        case 'f':
            run(host, memory, "fit", "true");
            break;
        case 'o':
            run(host, memory, "ortho", toggled(state.camera.ortho_height > 0));
            break;
        case 'k':
            next_look(host, memory);
            break;
        case 's':
            run(host, memory, "method", "\"splat\"");
            break;
        case 't':
            run(host, memory, "method", "\"tets\"");
            break;
        case 'd':
            run(host, memory, "method", "\"dense\"");
            break;
        case 'p':
            run(host, memory, "method", "\"pt\"");
            break;
        case 'v':
            run(host, memory, "method", "\"grid\"");
            break;
        case 'n':
            next_field(host, memory);
            break;
        case ',':
            go_to_step(host, memory, -1);
            break;
        case '.':
            go_to_step(host, memory, 1);
            break;
        case ' ':
            host.look().play = !host.look().play;
            break;
        case 'a':
            run(host, memory, "axes", toggled(state.axes));
            break;
        case 'm':
            run(host, memory, "edges", toggled(state.edges));
            break;
        case 'l':
            run(host, memory, "legend", toggled(state.legend));
            break;
        case 'r':
            host.look().section = "compare";
            run(host, memory, "compare", !state.compare ? json_text(host.methods()[2 % host.methods().size()]) : "null");
            break;
        case '[':
            run(host, memory, "slider", json_text(std::max(0.0, state.slider - 0.05)));
            break;
        case ']':
            run(host, memory, "slider", json_text(std::min(1.0, state.slider + 0.05)));
            break;
        case 'x':
            run(host, memory, "difference", toggled(state.difference));
            break;
        case 'e':
            next_tool(host);
            break;
        case 'b':
            host.look().dark = !host.look().dark;
            break;
        default:
            break;
    }
}

}  // namespace

void take_key(WindowHost& host, WindowMemory& memory, unsigned character, int key, bool control, bool shift) {
    if (key == GLFW_KEY_ESCAPE) return leave(host, memory);
    if (control && key == GLFW_KEY_O) {
        memory.dialog.open = true;
        return;
    }
    if (memory.dialog.open) return;
    if (key == GLFW_KEY_F1) host.look().help = !host.look().help;
    if (!host.has_session()) {
        if (character == '?' || character == 'q' || character == 'b' || character == 'h') take_letter(host, memory, character);
        return;
    }
    if (character != 0) return take_letter(host, memory, character);
    if (control) return with_control(host, memory, key);
    if (key == GLFW_KEY_TAB) host.look().panel = !host.look().panel;
    if (key == GLFW_KEY_F12) with_control(host, memory, GLFW_KEY_P);
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) run(host, memory, "fit", "true");
    const int right = key == GLFW_KEY_RIGHT  ? 1
                      : key == GLFW_KEY_LEFT ? -1
                                             : 0,
              up = key == GLFW_KEY_UP     ? 1
                   : key == GLFW_KEY_DOWN ? -1
                                          : 0;
    if (right == 0 && up == 0) return;
    if (shift) {
        run(host, memory, "pan", json_text(0.05 * right, 0.05 * up));
    } else {
        run(host, memory, "orbit", json_text(5.0 * right, 5.0 * up));
    }
}

bool may_drop_edits(const WindowHost& host, WindowMemory& memory) {
    const std::uintptr_t edits = host.unsaved_edits();
    if (edits == 0 || edits == memory.asked_about) return true;
    memory.asked_about = edits;
    memory.problem = "the edits of the mesh are not saved: ctrl + s saves them with the state; once more drops them";
    return false;
}

void leave(WindowHost& host, WindowMemory& memory) {
    if (memory.dialog.open) {
        memory.dialog.open = false;
    } else if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) {
        memory.close_popup = true;
    } else if (memory.shows_notes || host.look().help) {
        memory.shows_notes = host.look().help = false;
    } else if (host.look().tool != "turn") {
        host.look().tool = "turn";
    } else if (host.look().play) {
        host.look().play = false;
    } else if (host.busy()) {
        host.stop();
    }
    memory.problem.clear();
}

void draw_help(WindowHost& host, const WindowMemory& memory) {
    const float edge = 24 * memory.scale;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({edge, edge});
    ImGui::SetNextWindowSize({std::min(540 * memory.scale, screen.x - 2 * edge), 0});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x, screen.y - 2 * edge});
    ImGui::Begin("Keys", &host.look().help, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingStretchProp)) {
        for (const auto& [keys, effect] : kLines) {
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", keys);
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", effect);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace subvol::detail
