// SPDX-License-Identifier: Apache-2.0
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

constexpr std::array kLines{Line{"drag", "turn"},
                            Line{"shift + drag, middle button", "move"},
                            Line{"wheel, right button", "larger, smaller"},
                            Line{"click", "value, place and cell under the pointer"},
                            Line{"arrows, shift + arrows", "turn, move"},
                            Line{"+  -  f", "larger, smaller, fit"},
                            Line{"1 ... 6  7", "views +x -x +y -y +z -z iso"},
                            Line{"o", "parallel rays"},
                            Line{"k", "next look"},
                            Line{"s  t  p  d  v", "method: splat, tets, pt, dense, grid"},
                            Line{"n", "next field"},
                            Line{",  .  space", "step before, step after, play"},
                            Line{"a  m  l", "axes, control mesh, legend"},
                            Line{"r  [  ]  x", "reference beside it, its border, difference"},
                            Line{"e", "next tool for the mesh; shift + drag selects"},
                            Line{"ctrl + z, ctrl + y", "undo, redo"},
                            Line{"ctrl + p", "write the picture"},
                            Line{"ctrl + s, ctrl + o", "save the state, load it"},
                            Line{"ctrl + c", "copy as render command"},
                            Line{"b", "dark or light panels"},
                            Line{"?  q", "these keys, quit"}};

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
    if (key == GLFW_KEY_S) run_and_tell(host, memory, "save_state", json_text(state), "wrote " + state);
    if (key == GLFW_KEY_O) run_and_tell(host, memory, "load_state", json_text(state), "read " + state);
    if (key == GLFW_KEY_Z) run(host, memory, "undo", "true");
    if (key == GLFW_KEY_Y) run(host, memory, "redo", "true");
    if (key == GLFW_KEY_C) ImGui::SetClipboardText(host.render_command().c_str());
}

void next_tool(WindowHost& host) {
    constexpr std::array kTools{"turn", "brush", "move", "rotate", "scale", "twist", "bend", "paint"};
    const auto now = std::ranges::find(kTools, host.look().tool);
    const std::size_t next = now == kTools.end() ? 0 : static_cast<std::size_t>(now - kTools.begin()) + 1;
    host.look().tool = kTools[next % kTools.size()];
}

const char* toggled(bool now) {
    return now ? "false" : "true";
}

void take_letter(WindowHost& host, WindowMemory& memory, unsigned letter) {
    const ViewState& state = host.state();
    constexpr std::array kSides{"+x", "-x", "+y", "-y", "+z", "-z", "iso"};
    if (letter >= '1' && letter <= '7') run(host, memory, "view", json_text(std::string(kSides[letter - '1'])));
    switch (letter) {
        case '?':
            host.look().help = !host.look().help;
            break;
        case 'q':
            memory.quit = true;
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
    if (character != 0) return take_letter(host, memory, character);
    if (control) return with_control(host, memory, key);
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

void draw_help(WindowHost& host, const WindowMemory& memory) {
    ImGui::SetNextWindowPos({24 * memory.scale, 24 * memory.scale});
    ImGui::Begin("Keys", &host.look().help,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        for (const auto& [keys, effect] : kLines) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(effect);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace subvol::detail
