// SPDX-License-Identifier: Apache-2.0
#include "picture_notes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/detail/coverage.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/overlay.h"
#include "subvol/raster.h"
#include "subvol/shell_scene.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kDarkInk = 0.012, kLightInk = 0.85;  // linear

/// Puts a picture into a larger one, which is transparent around it. top: the rows above it
Picture extended(const Picture& from, int top, int width, int height) {
    Picture to{padded(from.image, 0, top, width, height), {}};
    if (from.depth.empty()) return to;
    to.depth.assign(to.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    for (int y = 0; y < from.image.height; ++y) {
        std::copy_n(from.depth.data() + pixel_index(from.image.width, 0, y), from.image.width,
                    to.depth.data() + pixel_index(width, 0, top + y));
    }
    return to;
}

double caption_letter(int width, int height) {
    return std::clamp(std::min(width, height) / 30.0, 9.0, 140.0);
}

double caption_base(std::size_t line, double letter) {
    return (1.5 + 1.4 * static_cast<double>(line)) * letter;
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
        const double size = std::clamp(std::min(picture.image.width, picture.image.height) / 34.0, 9.0, 100.0);
        draw_mark(picture.image, place, mark.text, size, ink, paper, is_hidden(picture, at.z, place));
    }
    if (!axes && !scale_at) return;
    draw(picture.image, [&](Image& image) {
        if (axes) draw_axes(image, view, ink);
        if (scale_at) {
            // Both at the lower edge need room side by side: the bar has a quarter of the width, and its letters.
            const Vec2 corner = axes_extent_px(image.width, image.height);
            const bool above = axes && corner.x > 0.65 * image.width;
            draw_scale_bar(image, view, *scale_at, ink, above ? corner.y : 0);
        }
    });
}

void PictureNotes::name_view(Picture& picture, const std::string& name) const {
    const double letter = std::clamp(std::min(picture.image.width, picture.image.height) / 24.0, 9.0, 70.0);
    draw(picture.image, [&](Image& image) {
        draw_text(image, {0.7 * letter, 1.4 * letter}, name, {.size_px = letter, .color = ink});
    });
}

void PictureNotes::add_margins(Picture& picture) const {
    const int width = picture.image.width, height = picture.image.height;
    const bool right = legend_style.side == LegendSide::Right;
    const int columns = legend && right ? legend_px : 0, rows = legend && !right ? legend_px : 0;
    if (!caption.empty() || legend) picture = extended(picture, caption_px, width + columns, caption_px + height + rows);
    const double letter = caption_letter(picture.image.width, picture.image.height);
    draw(picture.image, [&](Image& image) {
        for (std::size_t line = 0; line < caption.size(); ++line) {
            draw_text(image, {0.9 * letter, caption_base(line, letter)}, cut_text(caption[line], letter, width - 1.8 * letter),
                      {.size_px = letter, .color = ink});
        }
    });
    if (!legend) return;
    LegendStyle style = legend_style;
    style.ink = ink;
    draw(picture.image, [&](Image& image) { draw_legend(image, function, *legend, style, legend_height); });
}

void warn_of_boxes(std::span<const std::string> texts, Facts& facts) {
    std::vector<std::string> missing = missing_letters(texts);
    if (missing.empty()) return;
    constexpr std::size_t kMost = 20;
    const std::size_t more = missing.size() > kMost ? missing.size() - kMost : 0;
    missing.resize(missing.size() - more);
    std::string list;
    for (const std::string& letter : missing) list += (list.empty() ? "" : " ") + detail::printable(letter);
    if (more > 0) list += text(" and ", more, " more");
    facts.warn("boxes stand for letters that pictures have no outlines of: " + list +
               " (Latin, Greek and Cyrillic letters and the signs of physics are there)");
}

PictureNotes make_notes(PictureArguments& arguments, const ShownColors& colors, const HexMesh* mesh, Facts& facts) {
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
    std::vector<std::string> texts = notes.caption;
    const auto [whole_width, whole_height] = arguments.eye.size;
    if (!notes.caption.empty()) {
        const double letter = caption_letter(whole_width, whole_height);
        const int parts = std::max(1, arguments.sheet_rows());
        notes.caption_px = static_cast<int>(std::ceil(caption_base(notes.caption.size() - 1, letter) + 0.5 * letter));
        notes.caption_px += (whole_height - notes.caption_px) % parts;  // each of the parts gets as many rows
    }
    if (arguments.legend_inside()) {
        notes.legend = legend;
        notes.legend_style = arguments.legend_style;
        notes.legend_style.width = whole_width;
        notes.legend_height = whole_height;
        notes.legend_px = legend_extent_px(notes.function, legend, notes.legend_style, whole_height);
        const bool right = arguments.legend_style.side == LegendSide::Right;
        const int parts = right ? std::max(1, arguments.sheet_columns()) : std::max(1, arguments.sheet_rows());
        const int whole = right ? whole_width : whole_height - notes.caption_px;
        notes.legend_px += (whole - notes.legend_px) % parts;
        if (whole - notes.legend_px < whole / 3) {
            throw Error(ErrorCode::InvalidInput, "leaves no room for the picture", "--legend",
                        "a larger --size, or --legend FILE.svg");
        }
        arguments.legend_px = notes.legend_px;
        texts.insert(texts.end(), {legend.title, legend.opacity_title, legend.note});
        texts.insert(texts.end(), legend.names.begin(), legend.names.end());
    }
    arguments.caption_px = notes.caption_px;
    if (whole_height - notes.caption_px < whole_height / 3)
        throw Error(ErrorCode::InvalidInput, "leaves no room for the picture",
                    arguments.title.empty() ? "--time-label" : "--title", "a larger --size");
    warn_of_boxes(texts, facts);
    return notes;
}

}  // namespace subvol::cli
