// SPDX-License-Identifier: Apache-2.0
// The module subvol_cairo.so: pages of PDF by cairo, which brings the libraries of fonts and of X11.
#include <cairo-pdf.h>
#include <cairo.h>

#include <array>
#include <numbers>
#include <span>

#include "pdf_canvas.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

constexpr const char* kFont = "DejaVu Sans";  // has Greek, superscripts and mathematical signs; another one if it is missing
constexpr double kMarker = 3.4;

class CairoPage : public PdfCanvas {
public:
    CairoPage(const Vec2& size, double scale, const std::string& title)
        : scale_(scale),
          surface_(cairo_pdf_surface_create_for_stream(&append, &bytes_, size.x, size.y)),
          cairo_(cairo_create(surface_)) {
        cairo_pdf_surface_restrict_to_version(surface_, CAIRO_PDF_VERSION_1_4);
        cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_TITLE, title.c_str());
        cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATE_DATE, "");  // the same bytes in every run
        cairo_select_font_face(cairo_, kFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    }
    ~CairoPage() override {
        cairo_destroy(cairo_);
        cairo_surface_destroy(surface_);
    }
    CairoPage(const CairoPage&) = delete;
    CairoPage& operator=(const CairoPage&) = delete;

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
        cairo_text_extents_t extents{};
        cairo_text_extents(cairo_, words.c_str(), &extents);
        const double part = anchor == Anchor::Start ? 0 : anchor == Anchor::Middle ? 0.5 : 1;
        cairo_move_to(cairo_, -part * extents.x_advance, 0);
        cairo_show_text(cairo_, words.c_str());
        cairo_new_path(cairo_);  // it leaves a point, from which the next line would begin
        cairo_restore(cairo_);
    }

    std::string file(std::string& fault) override {
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
    std::string bytes_;
    cairo_surface_t* surface_;
    cairo_t* cairo_;
};

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
        }};
    return &kFunctions;
}
}
