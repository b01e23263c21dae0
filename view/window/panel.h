// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "window_host.h"

namespace subvol::detail {

/// The dialog that opens files.
struct FileDialog {
    struct Entry {
        std::string name{};
        bool folder = false;
    };
    bool open = false, all_files = false, read = false;
    std::filesystem::path folder{};
    std::vector<Entry> entries{};  ///< the entries of the folder, folders first
    std::string name{};
};

/// What the window remembers from frame to frame, besides the state of the session.
struct WindowMemory {
    float scale = 1;        ///< scale of letters and distances: that of the screen
    std::string problem{};  ///< the last action's error; empty: none
    std::string message{};  ///< what the last action did, for a while
    double message_until = 0;
    int held_knot = -1;
    double next_step_at = 0;
    char picture_file[256] = "picture.png";
    char state_file[256] = "state.json";
    char map_file[256] = "map.json", mesh_file[256] = "edited.vtu";
    float paint_value = 0;
    bool works = false, rectangle = false;  ///< what a drag with a tool is
    std::array<float, 2> corner{};          ///< where the drag began
    bool quit = false;
    std::uintptr_t asked_about = 0;  ///< edits that the next attempt drops
    std::string section{};           ///< the section that was open in the last frame
    bool holds_border = false;       ///< the border between the pictures that are compared is dragged
    bool asks_menu = false;          ///< the menu of the picture is to open
    bool close_popup = false;        ///< menus and lists close in the next frame
    bool shows_notes = false;
    std::string tip{};         ///< the tooltip that is about to show
    double tip_since = 0;      ///< since when the tooltip is about to show
    std::string expression{};  ///< the expression typed for the field
    std::string only{}, warp{};
    bool options_known = false;  ///< `only` and `warp` are those of the file
    FileDialog dialog{};
    bool holds_cut = false, turns_cut = false;  ///< a handle of a plane is dragged, at its foot or at its tip
    CutHandle held_cut{};
};

/// Runs an action and keeps its error.
void run(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value);
/// The same, and a message if there is no error.
void run_and_tell(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value,
                  const std::string& message);

/// A tooltip of the last item, once the pointer rests on it. key: that does the same; null: none
void tip(WindowMemory& memory, const char* text, const char* key = nullptr);

/// Whether what is shown may go. Of edits that are in no file the first attempt says so, and the second drops them.
[[nodiscard]] bool may_drop_edits(const WindowHost& host, WindowMemory& memory);

/// Leaves what is open or chosen, the topmost first: a dialog, a list, a tool, what plays, what is at work.
void leave(WindowHost& host, WindowMemory& memory);

/// Opens a file, or the state of a session (.json).
void open_path(WindowHost& host, WindowMemory& memory, const std::string& path);
/// The page of a window without a file. width, height: in units of the screen
void draw_start_page(WindowHost& host, WindowMemory& memory, float width, float height);
/// The dialog that opens files, while it is open.
void draw_file_dialog(WindowHost& host, WindowMemory& memory);
/// The menu of the picture.
void draw_menu(WindowHost& host, WindowMemory& memory);
/// The warnings of the file, while they are shown.
void draw_notes(WindowHost& host, WindowMemory& memory);
/// Saves the state, and the edits of the mesh beside it.
void save_state(WindowHost& host, WindowMemory& memory);
/// Copies the command that draws the picture.
void copy_command(WindowHost& host, WindowMemory& memory);

/// An entry of a list. Its text may be anything: a name of a file or a field has no part in the identifier, in which Dear ImGui
/// reads "##" and "###" as marks.
///
/// number:  of the entry in its list
/// flags:   ImGuiSelectableFlags
/// returns: whether it was clicked
[[nodiscard]] bool draw_entry(std::size_t number, const std::string& text, bool chosen, int flags = 0);

/// Lines of text that are typed. returns: whether Enter was pressed
bool input_line(const char* label, const char* hint, std::string& text);

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

/// What is said where an edited mesh is saved: ", with 3 inverted cells"; empty: it has none.
[[nodiscard]] std::string with_inverted(const WindowHost& host);
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
