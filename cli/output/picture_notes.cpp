// SPDX-License-Identifier: Apache-2.0
#include "picture_notes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/detail/coverage.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/overlay.h"
#include "subvol/shell_scene.h"

namespace subvol::cli {
namespace {

constexpr double kDarkInk = 0.012, kLightInk = 0.85;  // linear

/// Copies a picture into a larger one, transparent at its right and below.
Picture extended(const Picture& from, int width, int height) {
    Picture to{Image(width, height), {}};
    if (!from.depth.empty()) to.depth.assign(to.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const auto columns = static_cast<std::size_t>(from.image.width);
    for (int y = 0; y < from.image.height; ++y) {
        const auto row = static_cast<std::size_t>(y), to_row = row * static_cast<std::size_t>(width);
        std::copy_n(from.image.rgba.data() + 4 * row * columns, 4 * columns, to.image.rgba.data() + 4 * to_row);
        if (from.depth.empty()) continue;
        std::copy_n(from.depth.data() + row * columns, columns, to.depth.data() + to_row);
    }
    return to;
}

/// Whether the picture shows something before a place; without depths nobody knows.
bool is_hidden(const Picture& picture, double z, const Vec2& place) {
    constexpr double kOnSurface = 0.01;  // of a depth
    const int x = static_cast<int>(place.x), y = static_cast<int>(place.y);
    if (picture.depth.empty() || x < 0 || y < 0 || x >= picture.image.width || y >= picture.image.height) return false;
    const float seen =
        picture
            .depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.image.width) + static_cast<std::size_t>(x)];
    return z > (1 + kOnSurface) * double{seen};
}

/// Puts a rim of a colour around all that a picture shows.
void add_rim(Image& image, double width_px, const Vec3& color) {
    const int reach = static_cast<int>(std::ceil(width_px));
    std::vector<float> cover(image.rgba.size() / 4, 0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float alpha = image.pixel(x, y)[3];
            if (alpha == 0) continue;
            for (int v = std::max(0, y - reach); v <= std::min(image.height - 1, y + reach); ++v) {
                for (int u = std::max(0, x - reach); u <= std::min(image.width - 1, x + reach); ++u) {
                    const double part = std::clamp(width_px + 0.5 - std::hypot(u - x, v - y), 0.0, 1.0);
                    float& most = cover[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                                        static_cast<std::size_t>(u)];
                    most = std::max(most, alpha * static_cast<float>(part));
                }
            }
        }
    }
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
            detail::put_under(image, x, y, color, cover[at]);
        }
    }
}

}  // namespace

void PictureNotes::draw(Image& image, const std::function<void(Image&)>& notes) const {
    if (!rim) return notes(image);
    Image layer(image.width, image.height);
    notes(layer);
    add_rim(layer, std::clamp(image.height / 300.0, 1.2, 8.0), paper);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const float behind = 1 - layer.rgba[i + 3];
        for (std::size_t c = 0; c < 4; ++c) image.rgba[i + c] = layer.rgba[i + c] + behind * image.rgba[i + c];
    }
}

View PictureNotes::view_of_volume(const View& view) const {
    const View ended = flow ? ended_at(*flow, view) : view;
    return shells && shells->ended ? ended_at(*shells, ended) : ended;
}

void PictureNotes::draw_shells(Picture& picture, const View& view) const {
    if (flow) flow->draw_into(picture.image, picture.depth, shells && shells->ended ? ended_at(*shells, view) : view);
    if (shells) shells->draw_into(picture.image, picture.depth, flow ? ended_at(*flow, view) : view);
}

DrawnLines PictureNotes::draw_within(const View& view, const DrawPicture& draw, Progress* progress) const {
    DrawnLines drawn;
    if (edges == nullptr || boundary == nullptr) return drawn;
    const LineOptions style = edge_style(view, ink);
    std::vector<LineSample> samples = edge_samples(view, *edges, style, clip);
    if (shells) {
        const std::vector<LineSample> more = edge_samples(view, shells->control, style, clip);
        samples.insert(samples.end(), more.begin(), more.end());
    }
    drawn.lines = sort_lines(samples, *boundary, view_of_volume(view), clip);
    for (const LineLayer& layer : drawn.lines.within) drawn.ended.push_back(draw(ended_at(layer, view), progress).image);
    return drawn;
}

void PictureNotes::draw_over(Picture& picture, const View& view, const DrawnLines& lines) const {
    if (edges != nullptr && within) {
        draw_lines(picture.image, lines.lines, lines.ended, ink);
    } else if (edges != nullptr) {
        const LineOptions style = edge_style(view, ink);
        if (!edges->cells.empty()) draw_edges(picture.image, picture.depth, view, *edges, style, clip);
        if (shells) draw_edges(picture.image, picture.depth, view, shells->control, style, clip);
    }
    for (const PictureMark& mark : marks) {
        const Vec3 at = view.to_eye(mark.place);
        if (view.perspective() && !(at.z > 0)) continue;
        const Vec2 place = view.to_pixels(at);
        const double size = std::clamp(picture.image.height / 34.0, 9.0, 100.0);
        draw_mark(picture.image, place, mark.text, size, ink, paper, is_hidden(picture, at.z, place));
    }
    if (!axes && !scale_at) return;
    draw(picture.image, [&](Image& image) {
        if (axes) draw_axes(image, view, ink);
        if (scale_at) draw_scale_bar(image, view, *scale_at, ink);
    });
}

void PictureNotes::name_view(Picture& picture, const std::string& name) const {
    const double letter = std::clamp(picture.image.height / 24.0, 9.0, 70.0);
    draw(picture.image, [&](Image& image) {
        draw_text(image, {0.7 * letter, 1.4 * letter}, name, {.size_px = letter, .color = ink});
    });
}

void PictureNotes::add_legend(Picture& picture) const {
    const double letter = std::clamp(picture.image.height / 30.0, 9.0, 140.0);
    draw(picture.image, [&](Image& image) {
        for (std::size_t line = 0; line < caption.size(); ++line) {
            draw_text(image, {0.9 * letter, (1.5 + 1.4 * static_cast<double>(line)) * letter}, caption[line],
                      {.size_px = letter, .color = ink});
        }
    });
    if (!legend) return;
    const bool right = legend_style.side == LegendSide::Right;
    picture = extended(picture, picture.image.width + (right ? legend_px : 0), picture.image.height + (right ? 0 : legend_px));
    LegendStyle style = legend_style;
    style.ink = ink;
    draw(picture.image, [&](Image& image) { draw_legend(image, function, *legend, style, legend_height); });
}

PictureNotes make_notes(PictureArguments& arguments, const ShownColors& colors, const HexMesh* mesh) {
    const LegendOptions& legend = colors.legend;
    const Vec3 behind = arguments.background_color();
    PictureNotes notes{.axes = arguments.axes, .function = colors.optics.function()};
    const bool light = 0.2126 * behind.x + 0.7152 * behind.y + 0.0722 * behind.z > 0.18;
    notes.ink = Vec3(light ? kDarkInk : kLightInk);
    notes.paper = Vec3(light ? 1.0 : 0.0);
    notes.rim = arguments.transparent();
    if (arguments.edges) {
        if (mesh == nullptr) throw Error(ErrorCode::InvalidInput, "needs a mesh; this input has no cells", "--edges");
        notes.edges = mesh;
    }
    if (!arguments.title.empty()) notes.caption.push_back(arguments.title);
    if (arguments.time_label) {
        if (mesh == nullptr || !mesh->time)
            throw Error(ErrorCode::InvalidInput, "the input has no steps with times", "--time-label", "--title");
        notes.caption.push_back("t = " + detail::number_text(*mesh->time, 4));
    }
    if (arguments.legend_inside()) {
        notes.legend = legend;
        const auto [width, height] = arguments.eye.size;
        notes.legend_style = arguments.legend_style;
        notes.legend_height = height;
        notes.legend_px = legend_extent_px(notes.function, legend, arguments.legend_style, height);
        const bool right = arguments.legend_style.side == LegendSide::Right;
        const int parts = right ? std::max(1, arguments.sheet_columns()) : std::max(1, arguments.sheet_rows());
        const int whole = right ? width : height;  // each of the parts gets as many columns or rows
        notes.legend_px += (whole - notes.legend_px) % parts;
        if (whole - notes.legend_px < whole / 3) {
            throw Error(ErrorCode::InvalidInput, "leaves no room for the picture", "--legend",
                        "a larger --size, or --legend FILE.svg");
        }
        arguments.legend_px = notes.legend_px;
    }
    return notes;
}

}  // namespace subvol::cli
