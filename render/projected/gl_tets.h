// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "gl_buffer.h"
#include "gl_program.h"
#include "pixel_tiles.h"
#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/progress.h"
#include "tet_faces.h"

namespace subvol::detail {

/// The part of the tetrahedra's data that changes from picture to picture. Places are in eye space, in units of `scale`, and
/// depths are relative to that of the volume's middle.
struct GlTetFrame {
    /// A knot of the transfer function; the same as in shaders/projected_segment.glsl.
    struct Knot {
        std::array<float, 4> rgba;  // colour, opacity
        std::array<float, 4> value{};
    };
    std::vector<std::array<float, 4>> points;  ///< position; value, in parts of the range of the knots
    std::vector<std::uint32_t> order;          ///< numbers of tetrahedra, from back to front, or of faces, from front to back
    std::vector<Knot> knots;
    double scale = 1;          ///< length in world units
    double middle_depth = 0;   ///< in units of `scale`
    double opacity_units = 1;  ///< opacity units in the scale
    double eye_value = 0;      ///< the value at the eye, in the same parts as the values of the points; only for faces

    /// Planes {normal, offset} in eye space, in the same units: the faces of a clip, then the slices. After them the depths at
    /// which the rays of pixels end, four in each; none: no ray ends.
    std::vector<std::array<float, 4>> cuts{};
    std::size_t faces = 0, slices = 0;
    bool slices_alone = false, ends_rays = false;
};

/// A part of the work, from `begin` to `begin` + `size` of the whole, for reports of progress.
struct DrawStage {
    Progress* progress = nullptr;
    double begin = 0, size = 1;

    [[nodiscard]] DrawStage part(double from, double length) const { return {progress, begin + size * from, size * length}; }
    void report(double fraction) const { report_progress(progress, "draw", begin + size * fraction); }
};

/// Draws tetrahedra or their faces on the current context. Keeps data, programs and memory from picture to picture.
///
/// Every member throws Error(MissingCapability) if the device has no room.
class GlTets {
public:
    enum class Items { Tets, Faces };

    GlTets();
    ~GlTets();
    GlTets(const GlTets&) = delete;
    GlTets& operator=(const GlTets&) = delete;

    /// tets: corners, ascending
    void set_tets(std::span<const std::array<std::uint32_t, 4>> tets);
    void set_faces(std::span<const TetFaces::Face> faces);
    [[nodiscard]] bool has(Items items) const { return buffer_of(items).bytes() > 0; }

    /// Sets what is drawn next. Frame and view are referred to.
    ///
    /// offset_px: offset of the rays from the centres of their pixels
    void set_frame(const GlTetFrame& frame, const View& view);
    void set_offset(const Vec2& offset_px) { offset_px_ = offset_px; }

    /// Blends tetrahedra over each other in their order.
    [[nodiscard]] Image draw_in_order(const DrawStage& stage);

    // For GlTetLists.
    [[nodiscard]] const View& view() const { return *view_; }
    [[nodiscard]] const GlTetFrame& frame() const { return *frame_; }
    /// A compute shader that works on lists.
    enum class ListStep { Sort, Merge, Window, Composite };
    [[nodiscard]] const GlProgram& program(Items items, ListStep step);
    void set_uniforms(const GlProgram& program, const PixelRect& rect);
    /// Draws without writing to the picture: counts the fragments of each pixel of the rectangle, or stores them too.
    void draw_into_lists(Items items, bool keep, const PixelRect& rect, const DrawStage& stage);

private:
    [[nodiscard]] const GlBuffer& buffer_of(Items items) const { return items == Items::Tets ? tets_ : faces_; }
    [[nodiscard]] std::string defines(const char* mode, int corners) const;
    /// mode: of the fragment shader, FRAGMENT_COMPOSITE or FRAGMENT_LISTS
    [[nodiscard]] const GlProgram& program(Items items, const char* mode);
    void make_target(int width, int height);
    void draw_all(Items items, const GlProgram& program, const PixelRect& rect, const DrawStage& stage);

    const GlTetFrame* frame_ = nullptr;
    const View* view_ = nullptr;
    Vec2 offset_px_{0.0};
    GLuint vertices_ = 0, framebuffer_ = 0, texture_ = 0;
    int width_ = 0, height_ = 0;
    GlBuffer points_, tets_, faces_, order_, knots_, cuts_;
    std::map<std::string, GlProgram> programs_;  // by their defines; all of them for program_knots_ knots
    std::size_t program_knots_ = 0;
};

}  // namespace subvol::detail
