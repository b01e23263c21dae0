// SPDX-License-Identifier: Apache-2.0
// The panel at the right of the window. Each frame draws it anew from the state of the session, which it does not change
// itself: a widget that is used becomes an action with a JSON value, and the next frame shows what came of it.
//
//     host.state() ─► widgets ─► {"name": value} ─► host ─► error, kept as the problem of the last action
//
// Above are the field, look, method and step; below, sections under headings, of which one is open at a time, by its heading or
// by a key; at the foot, what was picked, help, undo and redo. Tools for the mesh are put away when their section is not open.
// Numbers are written as text that is the same in every locale. Entries of lists are drawn as they are and identified by
// number, so that names from files may hold anything.
#include "panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "subvol/srgb.h"

namespace subvol::detail {

namespace {

constexpr double kMessage_s = 4;

/// As printf's %.*g, the same in every locale.
std::string text_of(double number, int digits) {
    std::array<char, 40> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, digits);
    return {text.data(), end};
}

/// A combo box of words. returns: the one that was chosen now; empty: none
std::string choose(const WindowMemory& memory, const char* label, const std::string& current,
                   const std::vector<std::string>& words) {
    std::string chosen;
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (!ImGui::BeginCombo(label, current.c_str())) return chosen;
    if (memory.close_popup) ImGui::CloseCurrentPopup();
    for (std::size_t k = 0; k < words.size(); ++k) {
        if (draw_entry(k, words[k], words[k] == current)) chosen = words[k];
    }
    ImGui::EndCombo();
    return chosen;
}

/// A part of the panel below a heading that opens and closes it; one part is open at a time. The identifiers of its widgets are
/// below its name, so that parts may use the same words.
void draw_section(WindowHost& host, WindowMemory& memory, const char* title, const char* name,
                  void (*draw)(WindowHost&, WindowMemory&)) {
    const bool open = host.look().section == name;
    if (host.look().section != "sculpt") host.look().tool = "turn";  // no tool works unseen
    ImGui::SetNextItemOpen(open, ImGuiCond_Always);
    const bool now = ImGui::CollapsingHeader(title);
    if (now != open && ImGui::IsItemToggledOpen()) host.look().section = open ? "" : name;
    if (open && memory.section != name) ImGui::SetScrollHereY(0);  // a key has opened it
    if (open) memory.section = name;
    if (!now) return;
    ImGui::PushID(name);
    draw(host, memory);
    ImGui::PopID();
}

/// The fields, and a line for what is computed of them.
void choose_field(WindowHost& host, WindowMemory& memory) {
    const std::string& now = host.state().field;
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::BeginCombo("field", now.c_str())) {
        if (memory.close_popup) ImGui::CloseCurrentPopup();
        ImGui::SetNextItemWidth(-1);
        if (input_line("##expression", "such as length(U), 2*T", memory.expression) && !memory.expression.empty()) {
            run(host, memory, "field", json_text(memory.expression));
            if (memory.problem.empty()) ImGui::CloseCurrentPopup();
        }
        const std::vector<std::string> names = host.fields();
        for (std::size_t k = 0; k < names.size(); ++k) {
            if (draw_entry(k, names[k], names[k] == now)) run(host, memory, "field", json_text(names[k]));
        }
        ImGui::EndCombo();
    }
    tip(memory, "the field that is shown, or an expression of fields", "n");
}

float part_width(int parts) {
    return (ImGui::GetContentRegionAvail().x - static_cast<float>(parts - 1) * ImGui::GetStyle().ItemSpacing.x) /
           static_cast<float>(parts);
}

void draw_what(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    choose_field(host, memory);
    if (const auto look = choose(memory, "look", std::string(name_of(state.look.look)), names_of<Look>()); !look.empty())
        run(host, memory, "look", json_text(look));
    tip(memory, "solid: opaque and lit; volume: transparent; xray: dark where there is much; isosurface: lit levels", "k");
    if (const auto method = choose(memory, "method", std::string(name_of(state.method)), host.methods()); !method.empty())
        run(host, memory, "method", json_text(method));
    tip(memory, "splat: kernels; tets, pt: tetrahedra; dense: small cells; grid: voxels", "s t p d v");
    const std::vector<double>& times = host.times();
    if (times.size() < 2) return;
    int step = static_cast<int>(state.step);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    const std::string time = std::to_string(step) + "   t = " + text_of(times[state.step], 5);
    if (ImGui::SliderInt("step", &step, 0, static_cast<int>(times.size()) - 1, time.c_str()))
        run(host, memory, "step", std::to_string(step));
    ImGui::SameLine();
    if (ImGui::SmallButton(host.look().play ? "stop" : "play")) host.look().play = !host.look().play;
    tip(memory, "step after step", "space");
}

/// A box that gives values beyond the range a colour of their own, and that colour.
void choose_beyond(WindowHost& host, WindowMemory& memory, const char* action, const std::optional<Vec3>& now) {
    bool own = now.has_value();
    if (ImGui::Checkbox(action, &own)) run(host, memory, action, own ? "[0.5, 0.5, 0.5]" : "null");
    tip(memory, "values beyond the range have a colour of their own, not that of its end");
    if (!now) return;
    std::array<float, 3> color{};
    for (int k = 0; k < 3; ++k) color[static_cast<std::size_t>(k)] = static_cast<float>(srgb_from_linear((*now)[k]));
    ImGui::SameLine();
    ImGui::PushID(action);
    if (ImGui::ColorEdit3("##color", color.data(), ImGuiColorEditFlags_NoInputs)) {
        const Vec3 chosen = linear_from_srgb(Vec3(color[0], color[1], color[2]));
        run(host, memory, action, "[" + json_text(chosen.x) + ", " + json_text(chosen.y) + ", " + json_text(chosen.z) + "]");
    }
    ImGui::PopID();
}

/// How the map is spread over the range: the scale, bands, and colours beyond the range.
void draw_color_shape(WindowHost& host, WindowMemory& memory) {
    const ColorShape& shape = host.state().look.shape;
    const bool symmetric = shape.scale.linear_within > 0;
    const ValueRange field = host.field_range();
    const double least = 0.01 * std::max(std::abs(field.min), std::abs(field.max));
    const auto scale = choose(memory, "scale",
                              shape.scale.logarithmic ? "log"
                              : symmetric             ? "symlog"
                                                      : "linear",
                              {"linear", "log", "symlog"});
    if (scale == "log") run(host, memory, "log", "true");
    if (scale == "symlog") run(host, memory, "symlog", json_text(least > 0 ? least : 1.0));
    if (scale == "linear") run(host, memory, symmetric ? "symlog" : "log", symmetric ? "null" : "false");
    tip(memory, "log: equal ratios, equal parts of the map; symlog: on both sides of 0, linear within a value");
    if (symmetric) {
        float within = static_cast<float>(shape.scale.linear_within);
        ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
        if (ImGui::DragFloat("linear within", &within, 0.01F * within, 0, 0, "%.4g") && within > 0)
            run(host, memory, "symlog", json_text(double{within}));
    }
    int bands = shape.bands;
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderInt("bands", &bands, 0, 20, bands == 0 ? "none" : "%d"))
        run(host, memory, "bands", bands > 0 ? std::to_string(bands) : "null");
    tip(memory, "so many colours; ctrl and a click types a number");
    const std::optional<Vec3> below = shape.below, above = shape.above;
    const float half = 0.5F * ImGui::GetContentRegionAvail().x;
    choose_beyond(host, memory, "below", below);
    ImGui::SameLine(half);
    choose_beyond(host, memory, "above", above);
}

void draw_colours(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    const std::string now = state.look.colors.empty() ? "(of the look)" : state.look.colors;
    const auto map = choose(memory, "map", now, host.maps());
    if (!map.empty()) run(host, memory, "tf", json_text(map));
    draw_opacity_editor(host, memory);
    const ValueRange range = host.shown_range(), field = host.field_range();
    float low = static_cast<float>(range.min), high = static_cast<float>(range.max);
    const float speed = std::max(1e-6F, static_cast<float>(field.max - field.min) / 300);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::DragFloatRange2("range", &low, &high, speed, 0, 0, "%.4g", "%.4g") && low < high)
        run(host, memory, "range", json_text(double{low}, double{high}));
    draw_color_shape(host, memory);
    ImGui::Checkbox("log counts", &host.look().log_counts);
    ImGui::SameLine(0.5F * ImGui::GetContentRegionAvail().x);
    ImGui::Checkbox("log opacity", &host.look().log_opacity);
    if (ImGui::Button("whole range", {part_width(2), 0})) run(host, memory, "range", "\"field\"");
    ImGui::SameLine();
    if (ImGui::Button("map's own", {ImGui::GetContentRegionAvail().x, 0})) run(host, memory, "opacity", "[]");
    tip(memory, "the opacities of the colour map");
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    ImGui::InputTextWithHint("##map_file", "ParaView's map.json", memory.map_file, sizeof memory.map_file);
    ImGui::SameLine();
    const std::string file = memory.map_file;
    if (ImGui::Button("load##map", {part_width(2), 0})) run(host, memory, "tf", json_text(file));
    ImGui::SameLine();
    if (ImGui::Button("save##map", {ImGui::GetContentRegionAvail().x, 0}))
        run_and_tell(host, memory, "save_tf", json_text(file), "wrote " + file);
}

void draw_camera(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    constexpr std::array kSides{"+x", "-x", "+y", "-y", "+z", "-z"};
    const float width = part_width(6);
    for (std::size_t k = 0; k < kSides.size(); ++k) {
        if (k > 0) ImGui::SameLine();
        if (ImGui::Button(kSides[k], {width, 0})) run(host, memory, "view", json_text(std::string(kSides[k])));
    }
    if (ImGui::Button("iso", {part_width(2), 0})) run(host, memory, "view", "\"iso\"");
    ImGui::SameLine();
    if (ImGui::Button("fit", {ImGui::GetContentRegionAvail().x, 0})) run(host, memory, "fit", "true");
    tip(memory, "all of the body in the picture", "f, Enter");
    const auto box = [&](const char* label, const char* key, const char* action, bool value) {
        if (ImGui::Checkbox(label, &value)) run(host, memory, action, value ? "true" : "false");
        tip(memory, label, key);
    };
    const float half = 0.56F * ImGui::GetContentRegionAvail().x;
    box("orthographic", "o", "ortho", state.camera.ortho_height > 0);
    ImGui::SameLine(half);
    box("axes", "a", "axes", state.axes);
    box("control mesh", "m", "edges", state.edges);
    ImGui::SameLine(half);
    box("legend", "l", "legend", state.legend);
    bool dark = host.look().dark;
    if (ImGui::Checkbox("dark panels", &dark)) host.look().dark = dark;
    tip(memory, "dark or light panels", "b");
}

void draw_compare(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    const std::string now(state.compare ? name_of(*state.compare) : "nothing");
    std::vector<std::string> others = host.methods();
    others.insert(others.begin(), "nothing");
    const auto with = choose(memory, "beside it", now, others);
    if (!with.empty()) run(host, memory, "compare", with == "nothing" ? "null" : json_text(with));
    tip(memory, "a second picture by another method, right of a border that can be dragged in the picture", "r");
    float slider = static_cast<float>(state.slider);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderFloat("border", &slider, 0, 1, "%.2f")) run(host, memory, "slider", json_text(double{slider}));
    bool difference = state.difference;
    if (ImGui::Checkbox("difference, 8 times", &difference)) run(host, memory, "difference", difference ? "true" : "false");
    tip(memory, "the largest difference of each pixel's colours, eight times as bright", "x");
}

void draw_files(WindowHost& host, WindowMemory& memory) {
    const float label = -0.34F * ImGui::GetContentRegionAvail().x;
    ImGui::SetNextItemWidth(label);
    ImGui::InputText("##picture_file", memory.picture_file, sizeof memory.picture_file);
    ImGui::SameLine();
    const std::string picture = memory.picture_file, state = memory.state_file;
    if (ImGui::Button("picture", {ImGui::GetContentRegionAvail().x, 0}))
        run_and_tell(host, memory, "screenshot", json_text(picture), "wrote " + picture);
    ImGui::SetNextItemWidth(label);
    ImGui::InputText("##state_file", memory.state_file, sizeof memory.state_file);
    ImGui::SameLine();
    if (ImGui::Button("save", {part_width(2), 0})) save_state(host, memory);
    ImGui::SameLine();
    if (ImGui::Button("load##state", {ImGui::GetContentRegionAvail().x, 0}))
        run_and_tell(host, memory, "load_state", json_text(state), "read " + state);
    if (ImGui::Button("copy as render command", {-1, 0})) copy_command(host, memory);
    tip(memory, "the command that draws this picture", "ctrl + c");
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : "; ") + word;
    return text;
}

/// The file: another one, or the same with a region or a displacement.
void draw_input(WindowHost& host, WindowMemory& memory) {
    const OpenedFile& now = host.opened();
    if (ImGui::Button("open a file ...", {-1, 0})) memory.dialog.open = true;
    tip(memory, "a mesh, points, or a .vdb grid; files can be dropped on the window, too", "ctrl + o");
    if (!memory.options_known) {
        memory.only = joined(now.only);
        memory.warp = now.warp.value_or("");
        memory.options_known = true;
    }
    const float label = -0.34F * ImGui::GetContentRegionAvail().x;
    ImGui::SetNextItemWidth(label);
    bool again = input_line("only", "where:T>500; box:...", memory.only);
    tip(memory,
        "a region as of --only: box:, sphere:, half:, where:, set:, fold:; several with ; between; Enter reads the file again");
    ImGui::SetNextItemWidth(label);
    again |= input_line("warp", "DISPL*20", memory.warp);
    tip(memory, "a displacement as of --warp; Enter reads the file again");
    if (!again || !may_drop_edits(host, memory)) return;
    OpenedFile next{.name = now.name};
    for (std::size_t from = 0; from < memory.only.size();) {
        const std::size_t to = std::min(memory.only.find(';', from), memory.only.size());
        const std::size_t first = memory.only.find_first_not_of(' ', from);
        if (first < to) next.only.push_back(memory.only.substr(first, to - first));
        from = to + 1;
    }
    if (!memory.warp.empty()) next.warp = memory.warp;
    memory.options_known = false;
    memory.problem.clear();
    host.open(next);
}

float foot_height(const WindowHost& host) {
    const float between = ImGui::GetStyle().ItemSpacing.y, wrap = ImGui::GetContentRegionAvail().x;
    float height = ImGui::GetTextLineHeight() + 3 * between;  // of the buttons
    const auto picked = host.picked();
    if (picked.empty()) height += ImGui::GetTextLineHeight() + between;
    for (const std::string& line : picked) height += ImGui::CalcTextSize(line.c_str(), nullptr, false, wrap).y + between;
    return height;
}

/// At the foot of the panel: what was clicked, and where the keys are.
void draw_foot(WindowHost& host, WindowMemory& memory) {
    ImGui::Separator();
    const auto picked = host.picked();
    if (picked.empty()) ImGui::TextDisabled("click on the body: its value there");
    for (const std::string& line : picked) ImGui::TextWrapped("%s", line.c_str());
    if (ImGui::SmallButton("?")) host.look().help = !host.look().help;
    tip(memory, "all keys", "?");
    ImGui::SameLine();
    ImGui::TextDisabled("keys");
    ImGui::SameLine();
    if (ImGui::SmallButton("undo")) run(host, memory, "undo", "true");
    tip(memory, "takes back the last change, whatever it was", "ctrl + z");
    ImGui::SameLine();
    if (ImGui::SmallButton("redo")) run(host, memory, "redo", "true");
    tip(memory, "does it again", "ctrl + y");
}

}  // namespace

void run(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value) {
    memory.problem = host.run("{\"" + name + "\": " + value + "}");
}

void run_and_tell(WindowHost& host, WindowMemory& memory, const std::string& name, const std::string& value,
                  const std::string& message) {
    run(host, memory, name, value);
    if (!memory.problem.empty()) return;
    memory.message = message;
    memory.message_until = ImGui::GetTime() + kMessage_s;
}

void save_state(WindowHost& host, WindowMemory& memory) {
    const std::string file = memory.state_file;
    const bool edited = host.unsaved_edits() != 0;  // they are saved beside it
    run_and_tell(host, memory, "save_state", json_text(file), "wrote " + file + (edited ? with_inverted(host) : ""));
}

void copy_command(WindowHost& host, WindowMemory& memory) {
    const std::string command = host.render_command();
    ImGui::SetClipboardText(command.c_str());
    const auto comment = command.find("  # ");  // what the command leaves out
    memory.message = comment == std::string::npos ? "copied the command" : "copied, but" + command.substr(comment + 3);
    memory.message_until = ImGui::GetTime() + kMessage_s;
}

bool draw_entry(std::size_t number, const std::string& text, bool chosen, int flags) {
    ImGui::PushID(static_cast<int>(number));
    const bool clicked = ImGui::Selectable("##entry", chosen, flags);
    ImGui::PopID();
    ImGui::SameLine(0, 0);
    ImGui::TextUnformatted(text.c_str());
    return clicked;
}

bool input_line(const char* label, const char* hint, std::string& text) {
    std::array<char, 512> typed{};
    text.copy(typed.data(), typed.size() - 1);
    const bool entered =
        ImGui::InputTextWithHint(label, hint, typed.data(), typed.size(), ImGuiInputTextFlags_EnterReturnsTrue);
    text = typed.data();
    return entered;
}

std::string json_text(double number) {
    return text_of(number, 10);
}

std::string json_text(double a, double b) {
    return "[" + json_text(a) + ", " + json_text(b) + "]";
}

std::string json_text(const std::string& word) {
    std::string text = "\"";
    for (const char c : word) {
        if (c == '"' || c == '\\') text += '\\';
        text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return text + "\"";
}

void draw_panel(WindowHost& host, WindowMemory& memory, float left, float width, float height) {
    ImGui::SetNextWindowPos({left, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::BeginChild("content", {0, -foot_height(host)});
    if (const auto notes = host.notes(); !notes.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_PlotHistogram));
        ImGui::PushStyleColor(ImGuiCol_Text, {0, 0, 0, 1});
        const std::string text =
            notes.size() == 1 ? "1 warning of the file" : std::to_string(notes.size()) + " warnings of the file";
        if (ImGui::Button(text.c_str(), {-1, 0})) memory.shows_notes = !memory.shows_notes;
        ImGui::PopStyleColor(2);
    }
    draw_what(host, memory);
    draw_section(host, memory, "Colours and opacity", "colours", draw_colours);
    draw_section(host, memory, "Camera and overlays", "camera", draw_camera);
    draw_section(host, memory, "Cuts and slices", "cuts", draw_cuts);
    draw_section(host, memory, "Comparison", "compare", draw_compare);
    draw_section(host, memory, "Sculpting", "sculpt", draw_sculpt);
    draw_section(host, memory, "Saving and copying", "files", draw_files);
    draw_section(host, memory, "File and region", "input", draw_input);
    ImGui::EndChild();
    draw_foot(host, memory);
    ImGui::End();
}

}  // namespace subvol::detail
