// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/legend.h"
#include "subvol/names.h"
#include "subvol/shells.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// What is drawn over finished pictures. Places are in pixels from the top left corner of the picture, whose pixel (0,0) has
/// its centre at (.5,.5); what lies outside the picture is cut off. Colours are in linear light.

enum class TextAnchor { Start, Middle, End };

struct TextOptions {
    double size_px = 14;  ///< size of an em; capitals are about .73 of it high
    Vec3 color{0.0};
    TextAnchor anchor = TextAnchor::Start;
};

/// Draws one line of text, with the start of its base line at `place`, or its middle or end.
///
/// text: UTF-8; letters of the built-in font (Latin, Greek and Cyrillic letters, digits, raised and lowered too, and the signs
///       of physics); a box for all others, as `missing_letters` names them
void draw_text(Image& image, const Vec2& place, const std::string& text, const TextOptions& options = {});

/// The width of a text in pixels.
[[nodiscard]] double text_width_px(const std::string& text, double size_px);

/// Returns a text that is at most room_px wide: the text itself, or its beginning with "…".
[[nodiscard]] std::string cut_text(std::string text, double size_px, double room_px);

/// Returns the letters (or bytes that are not UTF-8) of the texts that the built-in font lacks, each once.
[[nodiscard]] std::vector<std::string> missing_letters(std::span<const std::string> texts);

struct LineOptions {
    double width_px = 1;
    Vec3 color{0.0};
    double alpha = 1;  ///< 0..1
};

/// The width and strength of the edges of cells in a picture.
[[nodiscard]] LineOptions edge_style(const View& view, const Vec3& ink);

void draw_line(Image& image, const Vec2& from, const Vec2& to, const LineOptions& options = {});

/// Draws a text on a plate of `paper`, which is half transparent, moved as far as the picture's edges need.
void draw_label(Image& image, const Vec2& place, const std::string& text, const TextOptions& options, const Vec3& paper);

/// Marks a place by a cross with a label beside it; a place outside the picture has no mark.
///
/// size_px: of the text; hidden: something is before the place: the cross is faint
void draw_mark(Image& image, const Vec2& place, const std::string& text, double size_px, const Vec3& ink, const Vec3& paper,
               bool hidden = false);

/// The coordinate along a side of a plot.
struct PictureScale {
    std::string title{};
    double first = 0;  ///< coordinate at the left or lower end
    double last = 1;   ///< coordinate at the other end
};

/// Where a plot stands in a picture, in pixels.
struct PlotFrame {
    int left = 0, top = 0, width = 0, height = 0;
};

/// The pixels about a plot that its scales need.
struct PlotMargins {
    int left = 0, right = 0, top = 0, bottom = 0;
};

/// height: of the plot, which decides the size of the letters; up: the scale at the left
[[nodiscard]] PlotMargins plot_margins_px(int height, const PictureScale& up);

/// Draws a frame about a plot, with ticks at round values and titles below and at the left.
void draw_scales(Image& image, const PlotFrame& frame, const PictureScale& across, const PictureScale& up, const Vec3& ink);

/// Draws the edges of a mesh's cells where the picture shows them: on its boundary, and where the clip's planes, box and slices
/// cut the cells. What is behind the surface that the picture shows is seen through it only as far
/// as that is transparent; a tenth of an edge's length counts as on the surface, for limits are not where their edges are.
///
/// depth:  of the picture as of `SplatResult`
/// clip:   that of the picture: what it takes away has no edges, nor has the boundary where slices are drawn alone
/// throws: Error(InvalidInput) if the sizes of picture, depth and view differ, or as `build_topology`
void draw_edges(Image& image, std::span<const float> depth, const View& view, const HexMesh& mesh,
                const LineOptions& options = {}, const Clip& clip = {});

/// Draws the edges of shells and the lines of beams in the same way.
void draw_edges(Image& image, std::span<const float> depth, const View& view, const Shells& shells,
                const LineOptions& options = {}, const Clip& clip = {});

/// What a line covers of a pixel.
struct LineSample {
    std::uint32_t pixel = 0;  ///< number of the pixel, rows from the top
    bool faces_eye = true;    ///< whether the side of the hull or of a cut on which the line lies is turned to the eye
    float depth = 0;          ///< the eye depth of the line there
    float slack = 0;          ///< how far the limit may be from the line, along the ray
    float cover = 0;          ///< 0..1, with the alpha of the line
};

/// The pixels of the edges that `draw_edges` draws, for `sort_lines`.
///
/// throws: Error(InvalidInput) as `build_topology`
[[nodiscard]] std::vector<LineSample> edge_samples(const View& view, const HexMesh& mesh, const LineOptions& options = {},
                                                   const Clip& clip = {});
[[nodiscard]] std::vector<LineSample> edge_samples(const View& view, const Shells& shells, const LineOptions& options = {},
                                                   const Clip& clip = {});

/// Draws the directions of the axes x, y, z in the lower left corner, red, green and blue, with their names.
///
/// ink: of the names
void draw_axes(Image& image, const View& view, const Vec3& ink);

/// Returns the columns and rows that `draw_axes` may need in the corner of a picture of this size.
[[nodiscard]] Vec2 axes_extent_px(int width, int height);

/// Draws a bar of a round length in the lower right corner, at most a quarter of the picture wide, with the length above it.
///
/// at:       the point at whose depth lengths are those of the bar; of an orthographic view it does not matter
/// ink:      of bar and text
/// above_px: the height above the lower edge at which the corner begins; 0 if it is left out
void draw_scale_bar(Image& image, const View& view, const Vec3& at, const Vec3& ink);
void draw_scale_bar(Image& image, const View& view, const Vec3& at, const Vec3& ink, double above_px);

/// Where a legend stands: at the right edge of the picture, upright, or along its lower edge.
enum class LegendSide { Right, Bottom };

template <>
struct NameTable<LegendSide> {
    static constexpr Name<LegendSide> rows[] = {{LegendSide::Right, "right"}, {LegendSide::Bottom, "bottom"}};
};

struct LegendStyle {
    LegendSide side = LegendSide::Right;  ///< where it stands
    double size = 1;                      ///< size of the letters and the bar, 1 as they are by default
    Vec3 ink{0.0};                        ///< colour of text and lines, in linear light
    int width = 0;  ///< width of the whole picture in pixels: letters follow the shorter of its sides; 0: its height alone
};

/// The pixels that `draw_legend` needs in a picture of this height: columns at its right, or rows below.
[[nodiscard]] int legend_extent_px(const TransferFunction& function, const LegendOptions& options, const LegendStyle& style,
                                   int height);

/// Draws a colour bar with ticks at round values, its title, and the curve of the opacities where they differ (not along the
/// lower edge); of categories a swatch and a name for each, as many as there is room for.
///
/// height: of the picture, which decides the size of the letters with `style.width`; they are at least 8 pixels high
/// throws: Error(InvalidInput) as `legend_svg`
void draw_legend(Image& image, const TransferFunction& function, const LegendOptions& options, const LegendStyle& style,
                 int height);

/// The same at the right edge, in the usual size.
[[nodiscard]] inline int legend_width_px(const TransferFunction& function, const LegendOptions& options, int height) {
    return legend_extent_px(function, options, {}, height);
}
inline void draw_legend(Image& image, const TransferFunction& function, const LegendOptions& options, const Vec3& ink) {
    draw_legend(image, function, options, {.ink = ink}, image.height);
}

/// Returns a larger picture with the given one in it; the new pixels are transparent.
///
/// left, top: where it lies in the new one
[[nodiscard]] Image padded(const Image& image, int left, int top, int width, int height);

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

/// What is drawn on pictures, on either.
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
