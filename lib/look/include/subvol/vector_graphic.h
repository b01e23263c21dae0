// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "subvol/overlay.h"
#include "subvol/vec.h"

namespace subvol {

/// The shapes of a vector graphic. Places are in pixels from its top left corner; colours are in linear light.

/// A line through places, with round ends and corners.
struct LineShape {
    std::vector<Vec2> places{};
    LineOptions options{};
};

/// A filled polygon.
struct AreaShape {
    std::vector<Vec2> corners{};
    Vec3 color{0.0};
    double alpha = 1;  ///< 0..1
};

/// A line of text, as of `draw_text`.
struct TextShape {
    Vec2 place{0.0};
    std::string text{};
    TextOptions options{};
};

/// The pixels of a picture, as the bytes of a .png.
struct PictureShape {
    Vec2 corner{0.0};  ///< the top left one
    Vec2 size{0.0};
    std::string png{};
};

/// A picture whose lines, areas and texts stay shapes, which `.svg` and `.pdf` show sharp at any size: later ones are over
/// earlier ones.
struct VectorGraphic {
    int width = 0;  ///< in pixels of 1/96 inch
    int height = 0;
    Vec3 background{1.0};
    std::vector<std::variant<LineShape, AreaShape, TextShape, PictureShape>> shapes{};
};

/// A self-contained SVG document in sRGB, with a title. Texts stay texts, in DejaVu Sans or another font without serifs.
[[nodiscard]] std::string vector_graphic_svg(const VectorGraphic& graphic, const std::string& title = {});

/// What is drawn on: the pixels of a picture, or a vector graphic that keeps the shapes.
class DrawTarget {
public:
    explicit DrawTarget(Image& image) : image_(&image) {}
    explicit DrawTarget(VectorGraphic& graphic) : graphic_(&graphic) {}

    [[nodiscard]] int width() const { return image_ != nullptr ? image_->width : graphic_->width; }
    [[nodiscard]] int height() const { return image_ != nullptr ? image_->height : graphic_->height; }
    [[nodiscard]] Image* image() const { return image_; }              ///< null: it is a graphic
    [[nodiscard]] VectorGraphic* graphic() const { return graphic_; }  ///< null: it is a picture

private:
    Image* image_ = nullptr;
    VectorGraphic* graphic_ = nullptr;
};

/// Draws a line through places. In pixels what is half transparent is darker at the places between.
void draw_polyline(const DrawTarget& target, std::span<const Vec2> places, const LineOptions& options = {});

/// Fills a polygon.
void draw_area(const DrawTarget& target, std::span<const Vec2> corners, const Vec3& color);

/// Fills a box: in a picture that of the pixels from the floor of `low` to before the floor of `high`.
void draw_box(const DrawTarget& target, const Vec2& low, const Vec2& high, const Vec3& color, double alpha = 1);

/// What overlay.h draws on pictures, on either.
void draw_text(const DrawTarget& target, const Vec2& place, const std::string& text, const TextOptions& options = {});
void draw_line(const DrawTarget& target, const Vec2& from, const Vec2& to, const LineOptions& options = {});
void draw_label(const DrawTarget& target, const Vec2& place, const std::string& text, const TextOptions& options,
                const Vec3& paper);
void draw_mark(const DrawTarget& target, const Vec2& place, const std::string& text, double size_px, const Vec3& ink,
               const Vec3& paper, bool hidden = false);
void draw_scales(const DrawTarget& target, const PlotFrame& frame, const PictureScale& across, const PictureScale& up,
                 const Vec3& ink);
void draw_legend(const DrawTarget& target, const TransferFunction& function, const LegendOptions& options,
                 const LegendStyle& style, int height);

}  // namespace subvol
