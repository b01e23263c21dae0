// SPDX-License-Identifier: Apache-2.0
// Hands on the control points: what dragging with the left button does while a tool is chosen. `brush` and `paint` take the
// points under the pointer; the others work on those that were selected by a rectangle (with shift).
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "panel.h"

namespace subvol::detail {

namespace {

constexpr double kTurnOfHandle_deg = 0.4;  // for each pixel of a drag

/// "3 inverted cells"; empty: there are none
std::string inverted_text(const WindowHost& host) {
    const std::size_t count = host.inverted_cells();
    if (count == 0) return {};
    return std::to_string(count) + (count == 1 ? " inverted cell" : " inverted cells");
}

std::string three_text(const Vec3& v) {
    return "[" + json_text(v.x) + ", " + json_text(v.y) + ", " + json_text(v.z) + "]";
}

void work(WindowHost& host, WindowMemory& memory, const ImVec2& by, float height) {
    const std::string& tool = host.look().tool;
    const Camera& camera = host.state().camera;
    const double right = double{by.x}, down = double{by.y};
    const Vec3 forward = glm::normalize(camera.target - camera.eye), axis = glm::normalize(camera.up);
    const Vec3 to_right = glm::normalize(glm::cross(forward, axis));
    const std::string angle = "{\"angle\": " + json_text(kTurnOfHandle_deg * right);
    if (tool == "brush" || tool == "move") {
        run(host, memory, "drag", json_text(right / double{height}, -down / double{height}));
    } else if (tool == "rotate") {
        run(host, memory, "rotate", angle + ", \"axis\": " + three_text(forward) + "}");
    } else if (tool == "scale") {
        run(host, memory, "scale", json_text(std::exp(0.005 * (right - down))));
    } else if (tool == "twist") {
        run(host, memory, "twist", angle + ", \"axis\": " + three_text(axis) + "}");
    } else if (tool == "bend") {
        run(host, memory, "bend", angle + ", \"axis\": " + three_text(axis) + ", \"toward\": " + three_text(to_right) + "}");
    }
}

void select_brush(WindowHost& host, WindowMemory& memory, const ImVec2& at, float fine) {
    run(host, memory, "select",
        "{\"brush\": [" + json_text(double{at.x * fine}) + ", " + json_text(double{at.y * fine}) + ", " +
            json_text(host.look().brush_px * double{fine}) + "]}");
}

void paint(WindowHost& host, WindowMemory& memory) {
    run(host, memory, "paint", "{\"value\": " + json_text(double{memory.paint_value}) + ", \"strength\": 0.5}");
}

}  // namespace

std::string with_inverted(const WindowHost& host) {
    const std::string inverted = inverted_text(host);
    return inverted.empty() ? inverted : ", with " + inverted;
}

bool take_tool(WindowHost& host, WindowMemory& memory, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    const std::string tool = host.look().tool;
    if (tool == "turn") return false;
    const float fine = io.DisplayFramebufferScale.x;
    const bool brushes = tool == "brush" || tool == "paint";
    if (ImGui::IsItemActivated() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        memory.rectangle = io.KeyShift && !brushes;
        memory.corner = {io.MousePos.x, io.MousePos.y};
        memory.works = !memory.rectangle;
        if (brushes) {
            select_brush(host, memory, io.MousePos, fine);
            memory.works = memory.problem.empty();
        }
        if (memory.works) run(host, memory, "grab", "true");
        if (memory.works && tool == "paint") paint(host, memory);
    }
    const bool moved = io.MouseDelta.x != 0 || io.MouseDelta.y != 0;
    if (ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left) && moved && memory.works) {
        if (tool == "paint") {
            select_brush(host, memory, io.MousePos, fine);
            if (memory.problem.empty()) paint(host, memory);
        } else {
            work(host, memory, io.MouseDelta, height);
        }
    }
    if (memory.rectangle && ImGui::IsItemActive()) {
        ImGui::GetWindowDrawList()->AddRect({memory.corner[0], memory.corner[1]}, io.MousePos,
                                            ImGui::GetColorU32(ImGuiCol_SliderGrab));
    }
    if (ImGui::IsItemDeactivated()) {
        if (memory.rectangle) {
            run(host, memory, "select",
                "{\"pixels\": [" + json_text(double{memory.corner[0] * fine}) + ", " +
                    json_text(double{memory.corner[1] * fine}) + ", " + json_text(double{io.MousePos.x * fine}) + ", " +
                    json_text(double{io.MousePos.y * fine}) + "]}");
        }
        if (memory.works) (void)host.run("{\"grab\": false}");
        memory.works = memory.rectangle = false;
    }
    return ImGui::IsMouseDown(ImGuiMouseButton_Left) || ImGui::IsMouseReleased(ImGuiMouseButton_Left);
}

void draw_selection(WindowHost& host, const WindowMemory& memory) {
    const ImGuiIO& io = ImGui::GetIO();
    const std::string& tool = host.look().tool;
    if (tool == "turn") return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (const Vec3& point : host.selected_pixels()) {  // z: the share
        const ImVec2 at{static_cast<float>(point.x) / io.DisplayFramebufferScale.x,
                        static_cast<float>(point.y) / io.DisplayFramebufferScale.y};
        const int share = static_cast<int>(80 + 175 * point.z);
        list->AddCircleFilled(at, 2.6F * memory.scale, IM_COL32(255, 255, 255, share));
        list->AddCircleFilled(at, 1.8F * memory.scale, IM_COL32(232, 120, 30, share));
    }
    if ((tool == "brush" || tool == "paint") && ImGui::IsItemHovered())
        list->AddCircle(io.MousePos, static_cast<float>(host.look().brush_px), ImGui::GetColorU32(ImGuiCol_SliderGrab), 48,
                        1.5F);
}

void draw_sculpt(WindowHost& host, WindowMemory& memory) {
    constexpr std::array kTools{"turn", "brush", "move", "rotate", "scale", "twist", "bend", "paint"};
    const float all = ImGui::GetContentRegionAvail().x, between = ImGui::GetStyle().ItemSpacing.x;
    const std::size_t columns = all > 280 * memory.scale ? 4 : 3;
    const float width = (all - static_cast<float>(columns - 1) * between) / static_cast<float>(columns);
    for (std::size_t k = 0; k < kTools.size(); ++k) {
        if (k % columns != 0) ImGui::SameLine();
        const bool now = host.look().tool == kTools[k];
        if (now) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        if (ImGui::Button(kTools[k], {width, 0})) host.look().tool = kTools[k];
        if (now) ImGui::PopStyleColor();
    }
    const float label = -0.34F * ImGui::GetContentRegionAvail().x;
    auto radius = static_cast<float>(host.look().brush_px);
    ImGui::SetNextItemWidth(label);
    if (ImGui::SliderFloat("size", &radius, 5, 300, "%.0f px")) host.look().brush_px = double{radius};
    ImGui::SetNextItemWidth(label);
    ImGui::DragFloat("paints", &memory.paint_value, 0.01F, 0, 0, "%.4g");
    int level = host.edit_level();
    ImGui::SetNextItemWidth(label);
    if (ImGui::InputInt("level", &level)) run(host, memory, "edit_level", std::to_string(std::clamp(level, 0, 10)));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("0: the control points; 1 and more: those of coarser levels; details follow");
    const float half = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) / 2;
    const auto button = [&](const char* text, const char* action, const char* value) {
        if (ImGui::Button(text, {half, 0})) run(host, memory, action, value);
    };
    button("select all", "select", "\"all\"");
    ImGui::SameLine();
    button("select none", "select", "null");
    const std::string inverted = inverted_text(host);
    ImGui::AlignTextToFramePadding();
    if (inverted.empty())
        ImGui::TextDisabled("no inverted cells");
    else
        ImGui::TextColored({0.92F, 0.36F, 0.28F, 1}, "%s", inverted.c_str());
    tip(memory,
        "cells with a corner at which the edges are left-handed, as `subvol info` counts them; those of an edited mesh are "
        "marked");
    bool marks = host.state().inverted;
    ImGui::SameLine(half + 2 * ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Checkbox("marked", &marks)) run(host, memory, "inverted", marks ? "true" : "false");
    ImGui::SetNextItemWidth(label);
    ImGui::InputText("##mesh_file", memory.mesh_file, sizeof memory.mesh_file);
    ImGui::SameLine();
    const std::string file = memory.mesh_file;
    if (ImGui::Button("save mesh", {ImGui::GetContentRegionAvail().x, 0}))
        run_and_tell(host, memory, "save_mesh", json_text(file), "wrote " + file + with_inverted(host));
    ImGui::TextDisabled("shift and drag: select a rectangle");
}

}  // namespace subvol::detail
