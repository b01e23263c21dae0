// SPDX-License-Identifier: Apache-2.0
// The module subvol_cairo.so: pages of PDF by cairo, which brings the libraries of fonts and of X11. A plot is drawn by its
// parts (`PdfCanvas`), with markers and lines of the width of its scale; a vector graphic shape by shape, a pixel being three
// quarters of a point.
#include <cairo-pdf.h>
#include <cairo.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "pdf_canvas.h"
#include "subvol/srgb.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

constexpr const char* kFont = "DejaVu Sans";  // has Greek, superscripts and mathematical signs; another one if it is missing
constexpr double kMarker = 3.4;

/// A file with one page.
class CairoFile {
public:
    /// size: of the page, in PostScript points
    CairoFile(const Vec2& size, const std::string& title)
        : surface_(cairo_pdf_surface_create_for_stream(&append, &bytes_, size.x, size.y)), cairo_(cairo_create(surface_)) {
        cairo_pdf_surface_restrict_to_version(surface_, CAIRO_PDF_VERSION_1_4);
        cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_TITLE, title.c_str());
        cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATE_DATE, "");  // the same bytes in every run
        cairo_select_font_face(cairo_, kFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    }
    ~CairoFile() {
        cairo_destroy(cairo_);
        cairo_surface_destroy(surface_);
    }
    CairoFile(const CairoFile&) = delete;
    CairoFile& operator=(const CairoFile&) = delete;

    [[nodiscard]] cairo_t* cairo() const { return cairo_; }

    /// Draws a text of the current font and colour. part: of its width that is before the place
    void text(const Vec2& place, double part, const std::string& words) const {
        cairo_text_extents_t extents{};
        cairo_text_extents(cairo_, words.c_str(), &extents);
        cairo_move_to(cairo_, place.x - part * extents.x_advance, place.y);
        cairo_show_text(cairo_, words.c_str());
        cairo_new_path(cairo_);  // it leaves a point, from which the next line would begin
    }

    /// As `PdfCanvas::file`.
    [[nodiscard]] std::string bytes(std::string& fault) {
        cairo_surface_finish(surface_);
        for (const cairo_status_t status : {cairo_status(cairo_), cairo_surface_status(surface_)}) {
            if (status != CAIRO_STATUS_SUCCESS && status != CAIRO_STATUS_SURFACE_FINISHED)
                fault = cairo_status_to_string(status);
        }
        return std::move(bytes_);
    }

private:
    static cairo_status_t append(void* to, const unsigned char* bytes, unsigned count) {
        for (const unsigned char byte : std::span(bytes, count)) static_cast<std::string*>(to)->push_back(char(byte));
        return CAIRO_STATUS_SUCCESS;
    }

    std::string bytes_;
    cairo_surface_t* surface_;
    cairo_t* cairo_;
};

class CairoPage : public PdfCanvas {
public:
    CairoPage(const Vec2& size, double scale, const std::string& title) : scale_(scale), file_(size, title) {}

    void grid(const Vec2& from, const Vec2& to) override {
        set_gray(0.886);
        cairo_move_to(cairo_, from.x, from.y);
        cairo_line_to(cairo_, to.x, to.y);
        cairo_stroke(cairo_);
    }

    void band(const Vec2& corner, const Vec2& size) override {
        set_gray(0.92);
        cairo_rectangle(cairo_, corner.x, corner.y, size.x, size.y);
        cairo_fill(cairo_);
    }

    void frame(const Vec2& corner, const Vec2& size) override {
        set_gray(0.467);
        cairo_rectangle(cairo_, corner.x, corner.y, size.x, size.y);
        cairo_stroke(cairo_);
    }

    void series(const Series& series) override {
        set_color(series.color);
        cairo_set_line_width(cairo_, 1.8 * scale_);
        cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
        const std::array<double, 2> dashes{5 * scale_, 3 * scale_};
        cairo_set_dash(cairo_, dashes.data(), series.dashed ? 2 : 0, 0);
        for (const auto& strand : series.strands) {
            if (strand.size() < 2) continue;
            for (const Vec2& place : strand) cairo_line_to(cairo_, place.x, place.y);
            cairo_stroke(cairo_);
        }
        cairo_set_line_width(cairo_, scale_);
        cairo_set_dash(cairo_, nullptr, 0, 0);
        for (const auto& [from, to] : series.bars) {
            const auto line = [&](const Vec2& a, const Vec2& b) {
                cairo_move_to(cairo_, a.x, a.y);
                cairo_line_to(cairo_, b.x, b.y);
            };
            line(from, to);
            for (const Vec2& place : {from, to}) line(place - Vec2(kBarEnd * scale_, 0), place + Vec2(kBarEnd * scale_, 0));
            cairo_stroke(cairo_);
        }
        for (const Vec2& place : series.markers) {
            add_marker(series.shape, place);
            cairo_fill_preserve(cairo_);
            cairo_stroke(cairo_);
        }
        for (const Vec2& place : series.hollow) {
            add_marker(series.shape, place);
            cairo_set_source_rgb(cairo_, 1, 1, 1);
            cairo_fill_preserve(cairo_);
            set_color(series.color);
            cairo_stroke(cairo_);
        }
    }

    void text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) override {
        cairo_save(cairo_);
        cairo_translate(cairo_, place.x, place.y);
        if (upward) cairo_rotate(cairo_, -std::numbers::pi / 2);
        cairo_set_source_rgb(cairo_, 0.11, 0.11, 0.11);
        cairo_set_font_size(cairo_, size);
        file_.text(Vec2(0), anchor == Anchor::Start ? 0 : anchor == Anchor::Middle ? 0.5 : 1, words);
        cairo_restore(cairo_);
    }

    std::string file(std::string& fault) override { return file_.bytes(fault); }

private:
    void set_gray(double gray) {
        cairo_set_source_rgb(cairo_, gray, gray, gray);
        cairo_set_line_width(cairo_, scale_);
    }
    // "#0072b2"
    void set_color(const std::string& color) {
        const auto part = [&](std::size_t k) { return std::stoi(color.substr(1 + 2 * k, 2), nullptr, 16) / 255.0; };
        cairo_set_source_rgb(cairo_, part(0), part(1), part(2));
    }

    void add_marker(std::size_t shape, const Vec2& place) {
        const auto polygon = [&](std::initializer_list<Vec2> corners) {
            for (const Vec2& corner : corners) cairo_line_to(cairo_, place.x + scale_ * corner.x, place.y + scale_ * corner.y);
            cairo_close_path(cairo_);
        };
        if (shape % 4 == 0) {
            cairo_arc(cairo_, place.x, place.y, kMarker * scale_, 0, 2 * std::numbers::pi);
            cairo_close_path(cairo_);
        }
        if (shape % 4 == 1) polygon({{-3.2, -3.2}, {3.2, -3.2}, {3.2, 3.2}, {-3.2, 3.2}});
        if (shape % 4 == 2) polygon({{0, -4.2}, {4, 2.8}, {-4, 2.8}});
        if (shape % 4 == 3) polygon({{0, -4.4}, {4.2, 0}, {0, 4.4}, {-4.2, 0}});
    }

    double scale_;
    CairoFile file_;
    cairo_t* cairo_ = file_.cairo();
};

/// Draws the shapes of a vector graphic.
class GraphicShapes {
public:
    /// fault: why a picture cannot be drawn
    GraphicShapes(CairoFile& file, std::string& fault) : file_(file), cairo_(file.cairo()), fault_(fault) {}

    void operator()(const LineShape& line) const {
        if (line.places.size() < 2) return;
        set_color(line.options.color, line.options.alpha);
        cairo_set_line_width(cairo_, line.options.width_px);
        add_path(line.places);
        cairo_stroke(cairo_);
    }

    void operator()(const AreaShape& area) const {
        set_color(area.color, area.alpha);
        add_path(area.corners);
        cairo_close_path(cairo_);
        cairo_fill(cairo_);
    }

    void operator()(const TextShape& shape) const {
        const TextAnchor anchor = shape.options.anchor;
        set_color(shape.options.color, 1);
        cairo_set_font_size(cairo_, shape.options.size_px);
        file_.text(shape.place, anchor == TextAnchor::Start ? 0 : anchor == TextAnchor::Middle ? 0.5 : 1, shape.text);
    }

    void operator()(const PictureShape& picture) const {
        std::string_view rest = picture.png;
        cairo_surface_t* const pixels = cairo_image_surface_create_from_png_stream(&take, &rest);
        if (const cairo_status_t status = cairo_surface_status(pixels); status != CAIRO_STATUS_SUCCESS) {
            fault_ = cairo_status_to_string(status);
        } else {
            cairo_save(cairo_);
            cairo_translate(cairo_, picture.corner.x, picture.corner.y);
            cairo_scale(cairo_, picture.size.x / cairo_image_surface_get_width(pixels),
                        picture.size.y / cairo_image_surface_get_height(pixels));
            cairo_set_source_surface(cairo_, pixels, 0, 0);
            cairo_paint(cairo_);
            cairo_restore(cairo_);
        }
        cairo_surface_destroy(pixels);
    }

private:
    static cairo_status_t take(void* from, unsigned char* bytes, unsigned count) {
        auto& rest = *static_cast<std::string_view*>(from);
        if (rest.size() < count) return CAIRO_STATUS_READ_ERROR;
        std::memcpy(bytes, rest.data(), count);
        rest.remove_prefix(count);
        return CAIRO_STATUS_SUCCESS;
    }

    void set_color(const Vec3& linear, double alpha) const {
        const auto coded = [&](int k) { return srgb_from_linear(std::clamp(linear[k], 0.0, 1.0)); };
        cairo_set_source_rgba(cairo_, coded(0), coded(1), coded(2), alpha);
    }

    void add_path(std::span<const Vec2> places) const {
        for (const Vec2& place : places) cairo_line_to(cairo_, place.x, place.y);
    }

    CairoFile& file_;
    cairo_t* cairo_;
    std::string& fault_;
};

std::string graphic_file(const VectorGraphic& graphic, const std::string& title, std::string& fault) {
    constexpr double kPointsPerPixel = 0.75;  // 72 and 96 an inch
    CairoFile file(kPointsPerPixel * Vec2(graphic.width, graphic.height), title);
    cairo_scale(file.cairo(), kPointsPerPixel, kPointsPerPixel);
    cairo_set_line_cap(file.cairo(), CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(file.cairo(), CAIRO_LINE_JOIN_ROUND);
    const GraphicShapes shapes(file, fault);
    const Vec2 end(graphic.width, graphic.height);
    shapes(AreaShape{{{0, 0}, {end.x, 0}, end, {0, end.y}}, graphic.background});
    for (const auto& shape : graphic.shapes) std::visit(shapes, shape);
    return file.bytes(fault);
}

}  // namespace

}  // namespace subvol::detail

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::CairoFunctions* subvol_cairo() {
    using namespace subvol::detail;
    static constexpr CairoFunctions kFunctions{
        [](const subvol::Vec2& size, double scale, const std::string& title) -> std::unique_ptr<PdfCanvas> {
            return std::make_unique<CairoPage>(size, scale, title);
        },
        &graphic_file};
    return &kFunctions;
}
}
