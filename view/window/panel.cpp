// SPDX-License-Identifier: Apache-2.0
#include "panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>

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
std::string choose(const char* label, const std::string& current, const std::vector<std::string>& words) {
    std::string chosen;
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (!ImGui::BeginCombo(label, current.c_str())) return chosen;
    for (const std::string& word : words) {
        if (ImGui::Selectable(word.c_str(), word == current)) chosen = word;
    }
    ImGui::EndCombo();
    return chosen;
}

/// A heading that opens and closes its part of the panel; one part is open at a time.
bool section(WindowHost& host, const char* title, const char* name) {
    const bool open = host.look().section == name;
    ImGui::SetNextItemOpen(open, ImGuiCond_Always);
    const bool now = ImGui::CollapsingHeader(title);
    if (now != open && ImGui::IsItemToggledOpen()) host.look().section = open ? "" : name;
    return now;
}

float part_width(int parts) {
    return (ImGui::GetContentRegionAvail().x - static_cast<float>(parts - 1) * ImGui::GetStyle().ItemSpacing.x) /
           static_cast<float>(parts);
}

void draw_what(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    if (const auto field = choose("field", state.field, host.fields()); !field.empty())
        run(host, memory, "field", json_text(field));
    if (const auto look = choose("look", std::string(name_of(state.look.look)), names_of<Look>()); !look.empty())
        run(host, memory, "look", json_text(look));
    if (const auto method = choose("method", std::string(name_of(state.method)), host.methods()); !method.empty())
        run(host, memory, "method", json_text(method));
    const std::vector<double>& times = host.times();
    if (times.size() < 2) return;
    int step = static_cast<int>(state.step);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    const std::string time = std::to_string(step) + "   t = " + text_of(times[state.step], 5);
    if (ImGui::SliderInt("step", &step, 0, static_cast<int>(times.size()) - 1, time.c_str()))
        run(host, memory, "step", std::to_string(step));
    ImGui::SameLine();
    if (ImGui::SmallButton(host.look().play ? "stop" : "play")) host.look().play = !host.look().play;
}

void draw_colours(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    const std::string now = state.look.colors.empty() ? "(of the look)" : state.look.colors;
    const auto map = choose(
        "map", now,
        {"viridis", "plasma", "inferno", "cividis", "turbo", "coolwarm", "grey", "bone", "xray", "isosurface", "surface"});
    if (!map.empty()) run(host, memory, "tf", json_text(map));
    draw_opacity_editor(host, memory);
    const ValueRange range = host.shown_range(), field = host.field_range();
    float low = static_cast<float>(range.min), high = static_cast<float>(range.max);
    const float speed = std::max(1e-6F, static_cast<float>(field.max - field.min) / 300);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::DragFloatRange2("range", &low, &high, speed, 0, 0, "%.4g", "%.4g") && low < high)
        run(host, memory, "range", json_text(double{low}, double{high}));
    ImGui::Checkbox("log counts", &host.look().log_counts);
    ImGui::SameLine(0.5F * ImGui::GetContentRegionAvail().x);
    ImGui::Checkbox("log opacity", &host.look().log_opacity);
    if (ImGui::Button("whole range", {part_width(2), 0})) run(host, memory, "range", "\"field\"");
    ImGui::SameLine();
    if (ImGui::Button("map's opacities", {ImGui::GetContentRegionAvail().x, 0})) run(host, memory, "opacity", "[]");
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
    const auto box = [&](const char* label, const char* action, bool value) {
        if (ImGui::Checkbox(label, &value)) run(host, memory, action, value ? "true" : "false");
    };
    const float half = 0.5F * ImGui::GetContentRegionAvail().x;
    box("parallel rays", "ortho", state.camera.ortho_height > 0);
    ImGui::SameLine(half);
    box("axes", "axes", state.axes);
    box("control mesh", "edges", state.edges);
    ImGui::SameLine(half);
    box("legend", "legend", state.legend);
    bool dark = host.look().dark;
    if (ImGui::Checkbox("dark panels", &dark)) host.look().dark = dark;
}

void draw_compare(WindowHost& host, WindowMemory& memory) {
    const ViewState& state = host.state();
    const std::string now(state.compare ? name_of(*state.compare) : "nothing");
    std::vector<std::string> others = host.methods();
    others.insert(others.begin(), "nothing");
    const auto with = choose("beside it", now, others);
    if (!with.empty()) run(host, memory, "compare", with == "nothing" ? "null" : json_text(with));
    float slider = static_cast<float>(state.slider);
    ImGui::SetNextItemWidth(-0.34F * ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderFloat("border", &slider, 0, 1, "%.2f")) run(host, memory, "slider", json_text(double{slider}));
    bool difference = state.difference;
    if (ImGui::Checkbox("difference, 8 times", &difference)) run(host, memory, "difference", difference ? "true" : "false");
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
    if (ImGui::Button("save", {part_width(2), 0})) run_and_tell(host, memory, "save_state", json_text(state), "wrote " + state);
    ImGui::SameLine();
    if (ImGui::Button("load##state", {ImGui::GetContentRegionAvail().x, 0}))
        run_and_tell(host, memory, "load_state", json_text(state), "read " + state);
    if (ImGui::Button("copy as render command", {-1, 0})) {
        ImGui::SetClipboardText(host.render_command().c_str());
        memory.message = "copied";
        memory.message_until = ImGui::GetTime() + kMessage_s;
    }
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
    draw_what(host, memory);
    if (section(host, "Colours and opacity", "colours")) draw_colours(host, memory);
    if (section(host, "Camera and overlays", "camera")) draw_camera(host, memory);
    if (section(host, "Cuts and slices", "cuts")) draw_cuts(host, memory);
    if (section(host, "Compare with a reference", "compare")) draw_compare(host, memory);
    if (section(host, "Sculpting", "sculpt")) draw_sculpt(host, memory);
    if (section(host, "Picture, state, command", "files")) draw_files(host, memory);
    ImGui::Separator();
    const auto picked = host.picked();
    if (picked.empty()) ImGui::TextDisabled("click on the body: its value there");
    for (const std::string& line : picked) ImGui::TextUnformatted(line.c_str());
    const std::string hint = "?  all keys";
    ImGui::SetCursorPosY(height - ImGui::GetStyle().WindowPadding.y - ImGui::GetTextLineHeight());
    ImGui::TextDisabled("%s", hint.c_str());
    ImGui::End();
}

}  // namespace subvol::detail
