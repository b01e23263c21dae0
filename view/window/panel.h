// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "window_host.h"

namespace subvol::detail {

/// What the window remembers from frame to frame, besides the state of the session.
///
/// scale:    of letters and distances: of the screen
/// problem:  the last action's error; empty: none
/// message:  what the last action did, for a while
struct WindowMemory {
    float scale = 1;
    std::string problem{}, message{};
    double message_until = 0;
    int held_knot = -1;
    double next_step_at = 0;
    char picture_file[256] = "picture.png";
    char state_file[256] = "state.json";
    char map_file[256] = "map.json", mesh_file[256] = "edited.vtu";
    float paint_value = 0;
    bool works = false, rectangle = false;  // what a drag with a tool is
    std::array<float, 2> corner{};          // where it began
    bool quit = false;
    bool holds_cut = false, turns_cut = false;  // a handle of a plane is dragged, at its foot or at its tip
    CutHandle held_cut{};
};

/// Runs an action and keeps its error.
void run(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value);
/// The same, and a message if there is no error.
void run_and_tell(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value,
                  const std::string& message);

/// JSON texts.
[[nodiscard]] std::string json_text(double number);
[[nodiscard]] std::string json_text(const std::string& word);
[[nodiscard]] std::string json_text(double a, double b);

/// The panel at the right, all of it. left, width, height: in units of the screen
void draw_panel(WindowHost& host, WindowMemory& memory, float left, float width, float height);

/// The editor of opacities over the histogram.
void draw_opacity_editor(WindowHost& host, WindowMemory& memory);

/// The mouse on the picture while a tool for control points is chosen. returns: whether the tool took it
[[nodiscard]] bool take_tool(WindowHost& host, WindowMemory& memory, float height);
/// The selected control points, and the brush.
void draw_selection(WindowHost& host, const WindowMemory& memory);
/// The mouse on the handle of a plane that cuts. returns: whether the handle took it
[[nodiscard]] bool take_cut(WindowHost& host, WindowMemory& memory);
/// The handles of the planes that cut; only while their part of the panel is open.
void draw_cut_handles(WindowHost& host, const WindowMemory& memory);
/// The planes, in the panel.
void draw_cuts(WindowHost& host, WindowMemory& memory);

/// The tools, in the panel.
void draw_sculpt(WindowHost& host, WindowMemory& memory);

/// The list of keys.
void draw_help(WindowHost& host, const WindowMemory& memory);

/// A key of the keyboard. character: what it writes; key: GLFW's number; one of both is 0
void take_key(WindowHost& host, WindowMemory& memory, unsigned character, int key, bool control, bool shift);

/// Letters, colours and distances of the window.
void set_style(bool dark, float scale);
void load_letters(float scale);

}  // namespace subvol::detail
