// SPDX-License-Identifier: Apache-2.0
// Opening files: the page of a window that shows none, and the dialog.
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <system_error>

#include "panel.h"

namespace subvol::detail {

namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool can_open(const WindowHost& host, const std::string& name) {
    const std::string small = lower(name);
    if (small.ends_with(".json")) return host.has_session();
    return std::ranges::any_of(host.extensions(), [&](const std::string& ending) { return small.ends_with(ending); });
}

/// Goes to a folder; one that cannot be read is left as it was.
void go_to(FileDialog& dialog, const fs::path& folder) {
    std::error_code failed;
    std::vector<FileDialog::Entry> entries;
    for (fs::directory_iterator entry(folder, fs::directory_options::skip_permission_denied, failed), end;
         !failed && entry != end; entry.increment(failed)) {
        const std::string name = entry->path().filename().string();
        std::error_code ignored;
        if (!name.starts_with('.')) entries.push_back({name, entry->is_directory(ignored)});
    }
    if (failed) return;
    std::ranges::sort(
        entries, [](const auto& a, const auto& b) { return a.folder != b.folder ? a.folder : lower(a.name) < lower(b.name); });
    const fs::path whole = fs::absolute(folder, failed).lexically_normal();
    dialog.folder = whole.has_filename() ? whole : whole.parent_path();
    dialog.entries = std::move(entries);
    dialog.name.clear();
    dialog.read = true;
}

/// Opens a file or goes to a folder.
void take(WindowHost& host, WindowMemory& memory, const std::string& name) {
    FileDialog& dialog = memory.dialog;
    if (name.empty()) return;
    const fs::path path = dialog.folder / name;
    std::error_code ignored;
    if (fs::is_directory(path, ignored) && path.extension() != ".bricks") return go_to(dialog, path);
    dialog.open = false;
    open_path(host, memory, name.starts_with("model:") ? name : path.string());
}

void draw_entries(WindowHost& host, WindowMemory& memory) {
    FileDialog& dialog = memory.dialog;
    constexpr int kTwice = ImGuiSelectableFlags_AllowDoubleClick;
    std::string chosen;
    std::size_t number = 0;
    if (draw_entry(number, "..", false, kTwice) && ImGui::IsMouseDoubleClicked(0)) chosen = "..";
    for (const auto& [name, folder] : dialog.entries) {
        ++number;
        if (!folder && !dialog.all_files && !can_open(host, name)) continue;
        if (!draw_entry(number, folder ? name + "/" : name, dialog.name == name, kTwice)) continue;
        dialog.name = name;
        if (ImGui::IsMouseDoubleClicked(0)) chosen = name;
    }
    take(host, memory, chosen);
}

}  // namespace

void open_path(WindowHost& host, WindowMemory& memory, const std::string& path) {
    memory.problem.clear();
    if (!may_drop_edits(host, memory)) return;
    if (lower(path).ends_with(".json")) {
        run_and_tell(host, memory, "load_state", json_text(path), "read " + path);
    } else {
        host.open({.name = path});
    }
}

void draw_file_dialog(WindowHost& host, WindowMemory& memory) {
    FileDialog& dialog = memory.dialog;
    if (!dialog.open) return;
    if (!dialog.read) go_to(dialog, fs::current_path());
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float edge = 16 * memory.scale;
    const ImVec2 size{std::min(660 * memory.scale, screen.x - 2 * edge), std::min(480 * memory.scale, screen.y - 2 * edge)};
    ImGui::SetNextWindowPos({(screen.x - size.x) / 2, (screen.y - size.y) / 2});
    ImGui::SetNextWindowSize(size);
    ImGui::SetNextWindowFocus();
    ImGui::Begin(
        "Open a file", &dialog.open,
        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    ImGui::TextUnformatted(dialog.folder.string().c_str());
    const float below = 2 * ImGui::GetFrameHeightWithSpacing();
    ImGui::BeginChild("entries", {0, -below}, true);
    draw_entries(host, memory);
    ImGui::EndChild();
    ImGui::SetNextItemWidth(-1);
    if (input_line("##name", "file, folder, or model:pawn", dialog.name)) take(host, memory, std::string(dialog.name));
    if (ImGui::Button("Open", {90 * memory.scale, 0})) take(host, memory, std::string(dialog.name));
    ImGui::SameLine();
    if (ImGui::Button("Cancel", {90 * memory.scale, 0})) dialog.open = false;
    ImGui::SameLine();
    ImGui::Checkbox("all files", &dialog.all_files);
    ImGui::End();
    if (!dialog.open) dialog.read = false;  // the folder may change until the next time
}

void draw_start_page(WindowHost& host, WindowMemory& memory, float width, float height) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::Begin("start", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    const float column = std::min(520 * memory.scale, width - 32 * memory.scale);
    ImGui::SetCursorPos({(width - column) / 2, std::max(16 * memory.scale, 0.14F * height)});
    ImGui::BeginChild("column", {column, 0});
    ImGui::SetWindowFontScale(1.6F);
    ImGui::TextUnformatted("Subdivision volumes");
    ImGui::SetWindowFontScale(1);
    ImGui::TextWrapped("Drop a file here, or open one: a mesh with fields, points, or a .vdb grid.");
    if (ImGui::Button("Open a file ...", {180 * memory.scale, 0})) memory.dialog.open = true;
    ImGui::SameLine();
    ImGui::TextDisabled("ctrl + o");
    const auto names = [&](const char* title, const std::vector<std::string>& list) {
        if (list.empty()) return;
        ImGui::Dummy({0, 6 * memory.scale});
        ImGui::TextDisabled("%s", title);
        ImGui::PushID(title);
        for (std::size_t k = 0; k < list.size(); ++k) {
            const std::string& name = list[k];
            const auto slash = name.rfind('/');
            if (draw_entry(k, name.substr(slash == std::string::npos ? 0 : slash + 1), false)) open_path(host, memory, name);
            if (slash != std::string::npos && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", name.c_str());
        }
        ImGui::PopID();
    };
    names("Recent files", host.recent());
    names("Built-in models", host.models());
    ImGui::EndChild();
    ImGui::End();
}

}  // namespace subvol::detail
