// SPDX-License-Identifier: Apache-2.0
// Planes that cut: a handle in the picture for each, whose foot moves the plane along its normal and whose tip turns it, and
// their list in the panel.
#include <imgui.h>

#include <array>
#include <cmath>
#include <string>

#include "panel.h"

namespace subvol::detail {

namespace {

constexpr float kTurnOfCut_deg = 0.5F;  // for each pixel of a drag

std::string named(const CutHandle& handle) {
    return std::string(handle.slice ? "\"slice\": " : "\"clip\": ") + std::to_string(handle.index);
}

/// A place of the picture on the screen.
ImVec2 on_screen(const Vec2& pixels) {
    const ImVec2 fine = ImGui::GetIO().DisplayFramebufferScale;
    return {static_cast<float>(pixels.x) / fine.x, static_cast<float>(pixels.y) / fine.y};
}

bool is_near(const ImVec2& place, float reach) {
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    return std::hypot(place.x - pointer.x, place.y - pointer.y) < reach;
}

void add_button(WindowHost& host, WindowMemory& memory, const char* kind, const char* axis, const char* normal, float width) {
    const std::string label = std::string(axis) + "##" + kind;
    if (ImGui::Button(label.c_str(), {width, 0}))
        run(host, memory, "add_cut", "{\"" + std::string(kind) + "\": " + normal + "}");
}

/// The point and the normal of a plane, which can be typed.
void type_plane(WindowHost& host, WindowMemory& memory, const CutPlane& plane, const std::string& which) {
    CutPlane typed = plane;
    ImGui::PushID(which.c_str());
    const float label = -0.24F * ImGui::GetContentRegionAvail().x;
    ImGui::SetNextItemWidth(label);
    bool changed = ImGui::InputScalarN("point", ImGuiDataType_Double, &typed.point.x, 3, nullptr, nullptr, "%.4g",
                                       ImGuiInputTextFlags_EnterReturnsTrue);
    tip(memory, "a point of the plane: x, y, z; Enter sets it");
    ImGui::SetNextItemWidth(label);
    changed |= ImGui::InputScalarN("normal", ImGuiDataType_Double, &typed.normal.x, 3, nullptr, nullptr, "%.4g",
                                   ImGuiInputTextFlags_EnterReturnsTrue);
    tip(memory, "the normal of the plane: x, y, z; Enter sets it");
    ImGui::PopID();
    if (!changed) return;
    const Vec3 &p = typed.point, &n = typed.normal;
    std::string numbers;
    for (const double number : {p.x, p.y, p.z, n.x, n.y, n.z}) numbers += (numbers.empty() ? "" : ", ") + json_text(number);
    run(host, memory, "set_cut", which + ", \"plane\": [" + numbers + "]}");
}

}  // namespace

bool take_cut(WindowHost& host, WindowMemory& memory) {
    if (host.look().section != "cuts") return false;
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemActivated() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        const float reach = 9 * memory.scale;
        for (const CutHandle& handle : host.cut_handles()) {
            const bool tip = is_near(on_screen(handle.tip), reach);
            if (!tip && !is_near(on_screen(handle.at), reach)) continue;
            memory.holds_cut = true;
            memory.turns_cut = tip;
            memory.held_cut = handle;
            break;
        }
    }
    if (!memory.holds_cut) return false;
    const ImVec2 by = io.MouseDelta, fine = io.DisplayFramebufferScale;
    if (ImGui::IsItemActive() && (by.x != 0 || by.y != 0)) {
        if (memory.turns_cut) {
            run(host, memory, "turn_cut",
                "{" + named(memory.held_cut) +
                    ", \"by\": " + json_text(double{kTurnOfCut_deg * by.x}, double{-kTurnOfCut_deg * by.y}) + "}");
        } else {
            run(host, memory, "move_cut",
                "{" + named(memory.held_cut) + ", \"drag\": " + json_text(double{by.x * fine.x}, double{by.y * fine.y}) + "}");
        }
    }
    if (ImGui::IsItemDeactivated()) memory.holds_cut = false;
    return true;
}

void draw_cut_handles(WindowHost& host, const WindowMemory& memory) {
    if (host.look().section != "cuts") return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float size = 5 * memory.scale;
    for (const CutHandle& handle : host.cut_handles()) {
        const ImVec2 at = on_screen(handle.at), tip = on_screen(handle.tip);
        const ImU32 fill = handle.slice ? IM_COL32(70, 160, 230, 255) : IM_COL32(232, 120, 30, 255);
        const ImU32 rim = IM_COL32(255, 255, 255, 230);
        list->AddLine(at, tip, rim, 4 * memory.scale);
        list->AddLine(at, tip, fill, 2 * memory.scale);
        list->AddCircleFilled(at, size + 1.5F * memory.scale, rim);
        list->AddCircleFilled(at, size, fill);
        list->AddCircleFilled(tip, size, rim);
        list->AddCircleFilled(tip, size - 1.5F * memory.scale, fill);
    }
}

void draw_cuts(WindowHost& host, WindowMemory& memory) {
    const float spacing = ImGui::GetStyle().ItemSpacing.x;
    const float label = 0.34F * ImGui::GetContentRegionAvail().x;
    const float width = (ImGui::GetContentRegionAvail().x - label - 2 * spacing) / 3;
    constexpr std::array kAxes{"+ x", "+ y", "+ z"};
    constexpr std::array kNormals{"[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"};
    for (const char* kind : {"clip", "slice"}) {
        for (std::size_t k = 0; k < kAxes.size(); ++k) {
            if (k > 0) ImGui::SameLine();
            add_button(host, memory, kind, kAxes[k], kNormals[k], width);
        }
        ImGui::SameLine();
        ImGui::TextUnformatted(kind);
    }
    const auto list = [&](const std::vector<CutPlane>& planes, const char* kind) {
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const std::string which = "{\"" + std::string(kind) + "\": " + std::to_string(k);
            ImGui::AlignTextToFramePadding();
            ImGui::Text("%s %zu", kind, k);
            ImGui::SameLine(ImGui::GetContentRegionMax().x - 1.9F * width);
            const std::string turn = "flip##" + std::string(kind) + std::to_string(k), drop = "remove##" + turn;
            if (ImGui::Button(turn.c_str(), {0.8F * width, 0})) run(host, memory, "turn_cut", which + ", \"flip\": true}");
            ImGui::SameLine();
            if (ImGui::Button(drop.c_str(), {ImGui::GetContentRegionAvail().x, 0}))
                run(host, memory, "remove_cut", which + "}");
            type_plane(host, memory, planes[k], which);
        }
    };
    const Clip clip = host.state().clip;  // the buttons change it
    list(clip.planes, "clip");
    list(clip.slices, "slice");
    bool around = clip.around_slices;
    if (!clip.slices.empty() && ImGui::Checkbox("the volume around slices", &around))
        run(host, memory, "around", around ? "true" : "false");
    ImGui::TextDisabled("drag a handle: its foot moves,\nits tip turns the plane");
}

}  // namespace subvol::detail
