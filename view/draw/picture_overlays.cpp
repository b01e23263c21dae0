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
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

constexpr double kDarkInk = 0.012, kLightInk = 0.85;  // linear

/// Makes a picture wider; the new columns at its right are transparent.
void widen(DrawnPicture& picture, int width) {
    const int columns = picture.image.width, rows = picture.image.height;
    picture.image = padded(picture.image, 0, 0, width, rows);
    if (picture.depth.empty()) return;
    std::vector<float> depth(pixel_count(width, rows), std::numeric_limits<float>::infinity());
    for (int y = 0; y < rows; ++y)
        std::copy_n(picture.depth.data() + pixel_index(columns, 0, y), columns, depth.data() + pixel_index(width, 0, y));
    picture.depth = std::move(depth);
}

}  // namespace

namespace {

int legend_columns_of(const ViewState& state, const ViewBody& body, const Optics& optics) {
    return legend_extent_px(optics.function(), legend_of(state, body), {.width = state.width}, state.height);
}

}  // namespace

Vec3 ink_on(const Vec3& background) {
    const double luminance = 0.2126 * background.x + 0.7152 * background.y + 0.0722 * background.z;
    return Vec3(luminance > 0.18 ? kDarkInk : kLightInk);
}

LegendOptions legend_of(const ViewState& state, const ViewBody& body) {
    const ValueRange range = state.look.range.value_or(body.range);
    LegendOptions legend{.title = body.field(), .min = range.min, .max = range.max, .shape = state.look.shape};
    if (state.look.colors == "categories") name_categories(legend, categories_of(body.mesh.attributes.front().values));
    return legend;
}

View seen_view(const ViewState& state, const ViewBody& body) {
    int width = state.width;
    if (state.legend) width -= legend_columns_of(state, body, optics_of(state, body));
    return {state.camera, std::max(1, width), state.height};
}

int legend_columns(const ViewState& state, const ViewBody& body, const Optics& optics) {
    if (!state.legend) return 0;
    const int columns = legend_columns_of(state, body, optics);
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
        draw_legend(picture.image, optics.function(), legend_of(state, body), {.ink = ink, .width = state.width}, state.height);
    }
}

}  // namespace subvol::detail
