// SPDX-License-Identifier: Apache-2.0
#include "picture_overlays.h"

#include <algorithm>
#include <array>
#include <limits>

#include "seen_view.h"
#include "subvol/cell.h"
#include "subvol/error.h"
#include "subvol/lines_in_volume.h"
#include "subvol/overlay.h"

namespace subvol::detail {

namespace {

constexpr double kDarkInk = 0.012, kLightInk = 0.85;  // linear

/// Makes a picture wider; the new columns at its right are transparent.
void widen(DrawnPicture& picture, int width) {
    Image wide(width, picture.image.height);
    std::vector<float> depth;
    if (!picture.depth.empty()) depth.assign(wide.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const auto from = static_cast<std::ptrdiff_t>(picture.image.width), to = static_cast<std::ptrdiff_t>(width);
    for (std::ptrdiff_t y = 0; y < picture.image.height; ++y) {
        std::copy_n(picture.image.rgba.begin() + 4 * y * from, 4 * from, wide.rgba.begin() + 4 * y * to);
        if (!depth.empty()) std::copy_n(picture.depth.begin() + y * from, from, depth.begin() + y * to);
    }
    picture.image = std::move(wide);
    picture.depth = std::move(depth);
}

}  // namespace

Vec3 ink_on(const Vec3& background) {
    const double luminance = 0.2126 * background.x + 0.7152 * background.y + 0.0722 * background.z;
    return Vec3(luminance > 0.18 ? kDarkInk : kLightInk);
}

LegendOptions legend_of(const ViewState& state, const ViewBody& body) {
    const ValueRange range = state.look.range.value_or(body.range);
    return {.title = body.field(), .min = range.min, .max = range.max, .shape = state.look.shape};
}

View seen_view(const ViewState& state, const ViewBody& body) {
    int width = state.width;
    if (state.legend) width -= legend_width_px(optics_of(state, body).function(), legend_of(state, body), state.height);
    return {state.camera, std::max(1, width), state.height};
}

int legend_columns(const ViewState& state, const ViewBody& body, const Optics& optics) {
    if (!state.legend) return 0;
    const int columns = legend_width_px(optics.function(), legend_of(state, body), state.height);
    if (state.width - columns < state.width / 3) {
        throw Error(ErrorCode::InvalidInput, "leaves no room for the picture", "legend", "a wider picture");
    }
    return columns;
}

void draw_edges_within(DrawnPicture& picture, const View& view, const ViewBody& body, const Surface& boundary,
                       const std::function<Image(const View&)>& draw_ended) {
    const ViewState& state = picture.state;
    const LineOptions style = edge_style(view, ink_on(background_of(state)));
    const SortedLines lines = sort_lines(edge_samples(view, body.mesh, style, state.clip), boundary, view, state.clip);
    std::vector<Image> ended;
    for (const LineLayer& layer : lines.within) ended.push_back(draw_ended(ended_at(layer, view)));
    draw_lines(picture.image, lines, ended, style.color);
}

void draw_inverted(DrawnPicture& picture, const View& view, const ViewBody& body) {
    if (!picture.state.inverted || !body.inverted) return;
    constexpr std::size_t kMost = 3000;  // cells: more would only cover each other, and make a drag slow
    constexpr Vec3 kRed(0.85, 0.015, 0.01);
    LineOptions style = edge_style(view, kRed);
    style.alpha = 1;
    const std::size_t step = (body.inverted->size() + kMost - 1) / kMost;
    for (std::size_t k = 0; k < body.inverted->size(); k += step) {
        std::array<Vec3, 8> corners;
        for (std::size_t c = 0; c < 8; ++c) corners[c] = view.to_eye(body.mesh.points[body.mesh.cells[(*body.inverted)[k]][c]]);
        for (const auto& [a, b] : kCellEdges) {
            if (corners[a].z > 0 && corners[b].z > 0)
                draw_line(picture.image, view.to_pixels(corners[a]), view.to_pixels(corners[b]), style);
        }
    }
}

void draw_overlays(DrawnPicture& picture, const View& view, const ViewBody& body, const Optics& optics, bool edges) {
    const ViewState& state = picture.state;
    const Vec3 ink = ink_on(background_of(state));
    if (edges) draw_edges(picture.image, picture.depth, view, body.mesh, edge_style(view, ink), state.clip);
    draw_inverted(picture, view, body);
    if (state.axes) draw_axes(picture.image, view, ink);
    if (state.legend) {
        widen(picture, state.width);
        draw_legend(picture.image, optics.function(), legend_of(state, body), ink);
    }
}

}  // namespace subvol::detail
