#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gl_buffer.h"
#include "gl_program.h"
#include "sheet_lists.h"
#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// Tetrahedra as the device takes them: places in eye space in parts of `scale`, depths relative to that of the middle.
///
/// points: place, value in parts of the range of the knots
/// tets:   corners by ascending number
/// order:  numbers of tetrahedra, from back to front
struct GlTetScene {
    /// Of the transfer function: shaders/pt_segment.glsl has the same.
    struct Knot {
        std::array<float, 4> look;  // colour, opacity
        std::array<float, 4> value{};
    };
    std::vector<std::array<float, 4>> points;
    std::vector<std::array<std::uint32_t, 4>> tets;
    std::vector<std::uint32_t> order;
    std::vector<Knot> knots;
    double scale = 1;          // world length
    double middle_depth = 0;   // in parts of it, as the points
    double opacity_units = 1;  // in the scale
};

/// Draws tetrahedra on the current context, for one picture.
class GlTets {
public:
    /// throws: Error(MissingCapability) if the device has no room
    GlTets(const GlTetScene& scene, const View& view);
    ~GlTets();
    GlTets(const GlTets&) = delete;
    GlTets& operator=(const GlTets&) = delete;

    /// Blended over each other in their order.
    [[nodiscard]] Image draw_in_order(Progress* progress);

    struct Lists {
        Image image;
        std::size_t fragments = 0, parts = 0;
        std::size_t violations = 0;  // pixels where the order is wrong
    };
    /// Kept in lists, one a pixel, which are sorted.
    ///
    /// most_fragments: that lists hold at a time; the picture is drawn in parts for it
    [[nodiscard]] Lists draw_in_lists(std::size_t most_fragments, Progress* progress);

private:
    [[nodiscard]] GlProgram make_program(const char* mode) const;
    void make_target();
    void set_frame(const GlProgram& program, const PixelRect& rect) const;
    [[nodiscard]] std::vector<std::uint32_t> count_fragments(Progress* progress);
    void draw_part(const GlProgram& keep, const PixelRect& part, const std::vector<std::uint32_t>& counts, Image& image,
                   Progress* progress, double done, double share);
    void resolve_part(const PixelRect& part, Image& image);
    void draw_all(const GlProgram& program, const PixelRect& rect, Progress* progress, double done, double part);

    const GlTetScene& scene_;
    const View& view_;
    GLuint vertices_ = 0, framebuffer_ = 0, texture_ = 0;
    GlBuffer points_, tets_, order_, knots_;
    GlBuffer counts_, offsets_, lights_, places_, picture_, violations_;  // of lists
};

}  // namespace subvol::detail
