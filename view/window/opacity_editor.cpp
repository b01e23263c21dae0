// SPDX-License-Identifier: Apache-2.0
// Opacities over the histogram of the field: the knots of the curve are dragged, a click between them adds one, a click with
// the right button takes one away. Below it are the colours; dragging them moves the range.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "panel.h"

namespace subvol::detail {

namespace {

constexpr double kLeastAlpha = 1e-3;  // of the logarithmic scale
constexpr std::size_t kBins = 100, kColors = 160;

struct Canvas {
    ImVec2 at;
    float width, height;
    ValueRange range;
    bool log;

    [[nodiscard]] float x(double value) const {
        return at.x + width * static_cast<float>((value - range.min) / (range.max - range.min));
    }
    [[nodiscard]] float y(double alpha) const {
        const double part = log ? 1 - std::log10(std::max(alpha, kLeastAlpha)) / std::log10(kLeastAlpha) : alpha;
        return at.y + height * static_cast<float>(1 - part);
    }
    [[nodiscard]] double value(float px) const {
        return range.min + (range.max - range.min) * std::clamp(double{px - at.x} / double{width}, 0.0, 1.0);
    }
    [[nodiscard]] double alpha(float py) const {
        const double part = std::clamp(1 - double{py - at.y} / double{height}, 0.0, 1.0);
        if (!log) return part;
        return part == 0 ? 0 : std::pow(kLeastAlpha, 1 - part);
    }
};

void set_opacity(WindowHost& host, WindowMemory& memory, const std::vector<TransferFunction::OpacityKnot>& knots) {
    std::string text = "[";
    for (const auto& knot : knots) text += (text.size() > 1 ? ", " : "") + json_text(knot.value, knot.alpha);
    if (host.state().look.look == Look::Solid) run(host, memory, "look", "\"volume\"");
    run(host, memory, "opacity", text + "]");
}

void draw_histogram(WindowHost& host, const Canvas& canvas, ImU32 color) {
    const std::vector<double> counts = host.histogram(canvas.range, kBins);
    const double most = std::max(1.0, *std::ranges::max_element(counts));
    const bool log = host.look().log_counts;
    const float step = canvas.width / static_cast<float>(kBins);
    for (std::size_t k = 0; k < kBins; ++k) {
        const double part = log ? std::log1p(counts[k]) / std::log1p(most) : counts[k] / most;
        const float left = canvas.at.x + static_cast<float>(k) * step;
        ImGui::GetWindowDrawList()->AddRectFilled({left, canvas.at.y + canvas.height * static_cast<float>(1 - part)},
                                                  {left + step, canvas.at.y + canvas.height}, color);
    }
}

using Knots = std::vector<TransferFunction::OpacityKnot>;

/// Marks the knots that a curve needs between two of them, so that straight lines stay near it.
void mark_needed(const Knots& knots, std::size_t from, std::size_t to, std::vector<bool>& needed) {
    constexpr double kNear = 0.005;  // of an opacity
    std::size_t farthest = from;
    double most = kNear;
    for (std::size_t k = from + 1; k < to; ++k) {
        const double part = (knots[k].value - knots[from].value) / (knots[to].value - knots[from].value);
        const double off = std::abs(knots[k].alpha - (knots[from].alpha + part * (knots[to].alpha - knots[from].alpha)));
        if (off <= most) continue;
        most = off;
        farthest = k;
    }
    if (farthest == from) return;
    needed[farthest] = true;
    mark_needed(knots, from, farthest, needed);
    mark_needed(knots, farthest, to, needed);
}

/// The knots of the curve that is shown. A scale that is not linear has hundreds, of which those stay that are needed.
Knots knots_of(const WindowHost& host) {
    constexpr std::size_t kMany = 32;
    const Knots all = host.opacity();
    if (all.size() <= kMany) return all;
    std::vector<bool> needed(all.size());
    needed.front() = needed.back() = true;
    mark_needed(all, 0, all.size() - 1, needed);
    Knots few;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (needed[k]) few.push_back(all[k]);
    }
    return few;
}

/// The knot within reach of the pointer; -1: none.
int knot_at(const Canvas& canvas, const std::vector<TransferFunction::OpacityKnot>& knots, const ImVec2& pointer, float reach) {
    int nearest = -1;
    float least = reach * reach;
    for (std::size_t k = 0; k < knots.size(); ++k) {
        const float dx = canvas.x(knots[k].value) - pointer.x, dy = canvas.y(knots[k].alpha) - pointer.y;
        if (dx * dx + dy * dy >= least) continue;
        least = dx * dx + dy * dy;
        nearest = static_cast<int>(k);
    }
    return nearest;
}

void edit_knots(WindowHost& host, WindowMemory& memory, const Canvas& canvas) {
    Knots knots = knots_of(host);
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    const int near = knot_at(canvas, knots, pointer, 10 * memory.scale);
    if (ImGui::IsItemClicked(ImGuiMouseButton_Left)) {
        memory.held_knot = near;
        if (near < 0) {
            const double value = canvas.value(pointer.x);
            const auto after = std::ranges::find_if(knots, [&](const auto& knot) { return knot.value > value; });
            memory.held_knot = static_cast<int>(after - knots.begin());
            knots.insert(after, {value, canvas.alpha(pointer.y)});
            set_opacity(host, memory, knots);
        }
        return;
    }
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right) && near >= 0 && knots.size() > 2) {
        knots.erase(knots.begin() + near);
        set_opacity(host, memory, knots);
        return;
    }
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) memory.held_knot = -1;
    const bool moved = ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0;
    if (memory.held_knot < 0 || !moved || static_cast<std::size_t>(memory.held_knot) >= knots.size()) return;
    const auto held = static_cast<std::size_t>(memory.held_knot);
    const double apart = 1e-4 * (canvas.range.max - canvas.range.min);
    double value = canvas.value(pointer.x);
    if (held > 0) value = std::max(value, knots[held - 1].value + apart);
    if (held + 1 < knots.size()) value = std::min(value, knots[held + 1].value - apart);
    knots[held] = {value, canvas.alpha(pointer.y)};
    set_opacity(host, memory, knots);
}

void draw_curve(WindowHost& host, const WindowMemory& memory, const Canvas& canvas, ImU32 ink, ImU32 fill) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const Knots knots = knots_of(host);
    std::vector<ImVec2> line{{canvas.at.x, canvas.y(knots.front().alpha)}};
    for (const auto& knot : knots) line.emplace_back(canvas.x(knot.value), canvas.y(knot.alpha));
    line.emplace_back(canvas.at.x + canvas.width, canvas.y(knots.back().alpha));
    list->PushClipRect(canvas.at, {canvas.at.x + canvas.width, canvas.at.y + canvas.height}, true);
    list->AddPolyline(line.data(), static_cast<int>(line.size()), ink, 0, 1.6F * memory.scale);
    list->PopClipRect();
    for (std::size_t k = 0; k < knots.size(); ++k) {
        if (knots[k].value < canvas.range.min || knots[k].value > canvas.range.max) continue;
        const ImVec2 place{canvas.x(knots[k].value), canvas.y(knots[k].alpha)};
        list->AddCircleFilled(place, 4.5F * memory.scale, fill);
        list->AddCircle(place, 4.5F * memory.scale, ink, 0, 1.6F * memory.scale);
    }
}

void draw_colors(WindowHost& host, WindowMemory& memory, const Canvas& canvas) {
    const float height = 16 * memory.scale;
    ImGui::SetCursorScreenPos({canvas.at.x, ImGui::GetCursorScreenPos().y});
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("colours", {canvas.width, height});
    const auto colors = host.curve(canvas.range, kColors);
    const float step = canvas.width / static_cast<float>(kColors);
    for (std::size_t k = 0; k < kColors; ++k) {
        const float left = at.x + static_cast<float>(k) * step;
        ImGui::GetWindowDrawList()->AddRectFilled(
            {left, at.y}, {left + step + 0.5F, at.y + height},
            ImGui::GetColorU32(ImVec4(colors[k].red, colors[k].green, colors[k].blue, 1)));
    }
    const ImVec2 moved = ImGui::GetIO().MouseDelta;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("drag: left and right moves the range, up and down widens it");
    if (!ImGui::IsItemActive() || (moved.x == 0 && moved.y == 0)) return;
    const double width = canvas.range.max - canvas.range.min, shift = double{moved.x} / double{canvas.width} * width;
    const double wider = width * (std::exp(-0.01 * double{moved.y} / double{memory.scale}) - 1) / 2;
    run(host, memory, "range", json_text(canvas.range.min + shift - wider, canvas.range.max + shift + wider));
}

}  // namespace

void draw_opacity_editor(WindowHost& host, WindowMemory& memory) {
    ValueRange range = host.shown_range();
    if (!(range.min < range.max)) range = {range.min - 0.5, range.max + 0.5};
    const float width = ImGui::GetContentRegionAvail().x, height = 130 * memory.scale;
    const float inset = 5 * memory.scale;  // knots at the ends are whole
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const Canvas canvas{{corner.x + inset, corner.y}, width - 2 * inset, height, range, host.look().log_opacity};
    ImGui::InvisibleButton("opacity", {width, height}, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    edit_knots(host, memory, canvas);
    ImGui::GetWindowDrawList()->AddRectFilled(corner, {corner.x + width, corner.y + height},
                                              ImGui::GetColorU32(ImGuiCol_FrameBg), 3 * memory.scale);
    draw_histogram(host, canvas, ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.45F));
    draw_curve(host, memory, canvas, ImGui::GetColorU32(ImGuiCol_Text), ImGui::GetColorU32(ImGuiCol_SliderGrab));
    draw_colors(host, memory, canvas);
}

}  // namespace subvol::detail
