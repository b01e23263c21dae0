// SPDX-License-Identifier: Apache-2.0
#include <imgui.h>

#include <filesystem>

#include "panel.h"

namespace subvol::detail {

namespace {

constexpr float kLetters_px = 15;

ImVec4 color(unsigned rgb, float alpha = 1) {
    return {static_cast<float>(rgb >> 16 & 255U) / 255, static_cast<float>(rgb >> 8 & 255U) / 255,
            static_cast<float>(rgb & 255U) / 255, alpha};
}

}  // namespace

void load_letters(float scale) {
    ImFontAtlas* letters = ImGui::GetIO().Fonts;
    for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                             "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"}) {
        std::error_code ignored;
        if (!std::filesystem::exists(file, ignored)) continue;
        if (letters->AddFontFromFileTTF(file, kLetters_px * scale) != nullptr) return;
    }
    ImFontConfig larger;
    larger.SizePixels = 13 * scale;
    letters->AddFontDefault(&larger);
}

void set_style(bool dark, float scale) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    dark ? ImGui::StyleColorsDark() : ImGui::StyleColorsLight();
    style.WindowRounding = style.ChildRounding = 0;
    style.FrameRounding = style.GrabRounding = style.PopupRounding = 3;
    style.WindowBorderSize = 0;
    style.FrameBorderSize = dark ? 0 : 1;  // white frames on a light panel
    style.WindowPadding = {12, 12};
    style.FramePadding = {7, 4};
    style.ItemSpacing = {8, 7};
    ImVec4* colors = style.Colors;
    const unsigned accent = dark ? 0x4c8bd6 : 0x2f6fc0;
    colors[ImGuiCol_WindowBg] = dark ? color(0x1d2126) : color(0xf3f4f6);
    colors[ImGuiCol_Header] = dark ? color(0x2b3138) : color(0xdfe3e8);
    colors[ImGuiCol_HeaderHovered] = dark ? color(0x363d46) : color(0xd0d7df);
    colors[ImGuiCol_HeaderActive] = color(accent, 0.8F);
    colors[ImGuiCol_FrameBg] = dark ? color(0x2b3138) : color(0xffffff);
    colors[ImGuiCol_FrameBgHovered] = dark ? color(0x363d46) : color(0xe8eef6);
    colors[ImGuiCol_FrameBgActive] = dark ? color(0x3d4651) : color(0xdce6f2);
    colors[ImGuiCol_Button] = dark ? color(0x343b44) : color(0xdfe3e8);
    colors[ImGuiCol_ButtonHovered] = color(accent, 0.7F);
    colors[ImGuiCol_ButtonActive] = color(accent);
    colors[ImGuiCol_CheckMark] = colors[ImGuiCol_SliderGrab] = color(accent);
    colors[ImGuiCol_SliderGrabActive] = color(accent);
    colors[ImGuiCol_PopupBg] = dark ? color(0x24292f, 0.98F) : color(0xffffff, 0.98F);
    style.ScaleAllSizes(scale);
}

}  // namespace subvol::detail
