// SPDX-License-Identifier: Apache-2.0
#include "slice_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "picture_notes.h"
#include "subvol/detail/number_text.h"
#include "subvol/image_io.h"
#include "subvol/plot.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// The colours of the places of a slice; those outside are transparent.
Image colored(const LimitSlice& slice, const TransferFunction& function) {
    Image image(slice.width, slice.height);
    for (std::size_t p = 0; p < slice.cells.size(); ++p) {
        if (slice.cells[p] == kNone) continue;
        const Vec3 rgb = color_at(function, slice.values[p]);
        for (std::size_t k = 0; k < 3; ++k) image.rgba[4 * p + k] = static_cast<float>(rgb[static_cast<int>(k)]);
        image.rgba[4 * p + 3] = 1;
    }
    return image;
}

bool is_dark(const Vec3& linear) {
    return glm::dot(linear, Vec3(.2126, .7152, .0722)) < 0.18;
}

/// The coordinate along a side of the picture. step: from a place to the next; first: the outer edge of the first place
PictureScale scale_of(const Vec3& step, const Vec3& first, int count, const Vec3& point, const char* name) {
    constexpr double kParallel = 1e-9;
    const double length = glm::length(step);
    const Vec3 along = step / length;
    for (int k = 0; k < 3; ++k) {
        if (std::abs(std::abs(along[k]) - 1) > kParallel) continue;
        return {std::string(1, static_cast<char>('x' + k)), first[k], first[k] + count * step[k]};
    }
    const double from = glm::dot(along, first - point);
    return {name, from, from + count * length};
}

/// Writes the value of each line at its middle, where the line is long enough and no label is near.
void label_lines(const DrawTarget& target, const std::vector<ContourLine>& lines, const Vec2& middle, double letter) {
    std::vector<Vec2> taken;
    for (const ContourLine& line : lines) {
        const std::string label = detail::number_text(line.value, 4);
        const double room = text_width_px(label, letter) + letter;
        double length = 0;
        for (std::size_t i = 1; i < line.places.size(); ++i) length += glm::length(line.places[i] - line.places[i - 1]);
        if (length < 3 * room) continue;
        double walked = 0;
        for (std::size_t i = 1; i < line.places.size(); ++i) {
            walked += glm::length(line.places[i] - line.places[i - 1]);
            const Vec2 place = line.places[i] + middle;
            if (walked < 0.5 * length) continue;
            const bool free = std::ranges::none_of(taken, [&](const Vec2& other) {
                return std::abs(other.x - place.x) < room && std::abs(other.y - place.y) < 1.6 * letter;
            });
            if (!free) continue;
            taken.push_back(place);
            draw_label(target, place + Vec2(0, 0.35 * letter), label,
                       {.size_px = letter, .color = Vec3(0.0), .anchor = TextAnchor::Middle}, Vec3(1.0));
            break;
        }
    }
}

void mark_extremes(const DrawTarget& target, const LimitSlice& slice, const Vec2& middle, double letter, Report& report) {
    const double step = glm::dot(slice.right, slice.right);
    Json said;
    for (const auto& [name, value, at] : {std::tuple{"min", slice.min, slice.min_at}, {"max", slice.max, slice.max_at}}) {
        const Vec3 from = at - slice.origin;
        const Vec2 place(glm::dot(from, slice.right) / step, glm::dot(from, slice.down) / step);
        draw_mark(target, place + middle, text(name, " ", detail::number_text(value, 4)), letter, Vec3(0.0), Vec3(1.0));
        said[text(name, "_at")] = {at.x, at.y, at.z};
    }
    report["extremes"] = std::move(said);
}

}  // namespace

bool is_vector_graphic(const std::string& path) {
    return path.ends_with(".svg") || path.ends_with(".pdf");
}

void write_slice_picture(const std::string& path, const LimitSlice& slice, const std::vector<ContourLine>& lines,
                         const SlicePicture& picture, Report& report) {
    constexpr int kLeastLegend_px = 200;
    const TransferFunction& function = picture.function;
    const Vec3 ink(is_dark(picture.background) ? 1.0 : 0.0);
    const PictureScale across = scale_of(slice.right, slice.place(-0.5, 0), slice.width, picture.point, "s");
    const PictureScale up = scale_of(-slice.down, slice.place(0, slice.height - 0.5), slice.height, picture.point, "t");
    const PlotMargins margins_of_axes = picture.axes ? plot_margins_px(slice.height, up) : PlotMargins{};
    PlotMargins margins = margins_of_axes;
    const double letter = std::clamp(slice.height / 40.0, 9.0, 60.0), title_letter = 1.4 * letter;
    if (!picture.title.empty()) margins.top += static_cast<int>(std::ceil(1.8 * title_letter));
    const int width = margins.left + slice.width + margins.right;
    int height = slice.height + margins.top + margins.bottom, legend_px = 0;
    if (picture.legend) {
        height = std::max(height, kLeastLegend_px);
        legend_px = legend_extent_px(function, *picture.legend, {.width = width}, height);
    }
    Facts facts;
    warn_of_boxes(std::array{picture.legend ? picture.legend->title : std::string(), picture.title}, facts);
    report.merge(facts);
    const int left = margins.left, top = margins.top + (height - slice.height - margins.top - margins.bottom) / 2;

    Image image = colored(slice, function);
    VectorGraphic graphic{.width = width, .height = height, .background = picture.background};
    const bool vector = is_vector_graphic(path);
    if (vector) {
        graphic.shapes.emplace_back(PictureShape{Vec2(left, top), Vec2(slice.width, slice.height), png_bytes(image, {})});
    } else {
        image = padded(image, left, top, width, height);
    }
    const DrawTarget target = vector ? DrawTarget(graphic) : DrawTarget(image);
    const Vec2 middle(0.5 + left, 0.5 + top);  // of the first place
    for (const ContourLine& line : lines) {
        std::vector<Vec2> places;
        for (const Vec2& place : line.places) places.push_back(place + middle);
        draw_polyline(target, places,
                      {.width_px = 1.25, .color = Vec3(is_dark(color_at(function, line.value)) ? 1.0 : 0.0), .alpha = 0.75});
    }
    if (!picture.title.empty()) {
        draw_text(target, {left + 0.2 * title_letter, top - margins_of_axes.top - 0.6 * title_letter},
                  cut_text(picture.title, title_letter, slice.width + margins.right), {.size_px = title_letter, .color = ink});
    }
    if (picture.contour_labels) label_lines(target, lines, middle, letter);
    if (picture.axes) draw_scales(target, {left, top, slice.width, slice.height}, across, up, ink);
    if (picture.extremes) mark_extremes(target, slice, middle, letter, report);
    if (picture.legend) {
        if (vector) {
            graphic.width += legend_px;
        } else {
            image = padded(image, 0, 0, width + legend_px, height);
        }
        draw_legend(target, function, *picture.legend, {.ink = ink, .width = width}, height);
    }
    report.timed("write", [&] {
        if (vector) {
            write_vector_graphic(path, graphic, picture.title.empty() ? slice.field : picture.title);
        } else {
            write_image(path, image, picture.background);
        }
    });
}

}  // namespace subvol::cli
