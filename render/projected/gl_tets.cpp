// SPDX-License-Identifier: Apache-2.0
#include "gl_tets.h"

#include <algorithm>
#include <locale>
#include <sstream>

#include "gl_context.h"
#include "gl_pace.h"
#include "pixel_tiles.h"
#include "shader_exp_log_glsl.h"
#include "shader_projected_clip_glsl.h"
#include "shader_projected_crossing_glsl.h"
#include "shader_projected_entries_glsl.h"
#include "shader_projected_face_frag.h"
#include "shader_projected_face_vert.h"
#include "shader_projected_frame_glsl.h"
#include "shader_projected_hull_glsl.h"
#include "shader_projected_kbuffer_comp.h"
#include "shader_projected_lists_glsl.h"
#include "shader_projected_merge_comp.h"
#include "shader_projected_resolve_comp.h"
#include "shader_projected_segment_glsl.h"
#include "shader_projected_sort_comp.h"
#include "shader_projected_state_glsl.h"
#include "shader_projected_tet_frag.h"
#include "shader_projected_tet_vert.h"
#include "shader_projected_window_comp.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

// The same as in the shaders.
constexpr GLuint kPointsBinding = 0, kItemsBinding = 1, kOrderBinding = 2, kCutsBinding = 9, kKnotsBinding = 10;
constexpr std::size_t kFirstDrawn = 1U << 14, kLeastDrawn = 1U << 8, kMostDrawn = 1U << 20;  // at a time

template <class T>
void fill(GlBuffer& buffer, const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    buffer.grow(bytes);
    buffer.upload(bytes, values.data());
}

std::vector<ShaderText> light_texts() {
    return {{"projected_frame.glsl", kShader_projected_frame_glsl},
            {"exp_log.glsl", kShader_exp_log_glsl},
            {"projected_segment.glsl", kShader_projected_segment_glsl},
            {"projected_clip.glsl", kShader_projected_clip_glsl}};
}

std::vector<ShaderText> drawing_texts() {
    auto texts = light_texts();
    texts.push_back({"projected_crossing.glsl", kShader_projected_crossing_glsl});
    texts.push_back({"projected_hull.glsl", kShader_projected_hull_glsl});
    return texts;
}

}  // namespace

GlTets::GlTets() {
    check_storage({.vertex = 3, .fragment = 6, .compute = 8, .bindings = 13}, GlStorage::available(), "the method tets");
    glCreateVertexArrays(1, &vertices_);  // it has no attributes, but OpenGL does not draw without one
    glCreateFramebuffers(1, &framebuffer_);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DITHER);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

GlTets::~GlTets() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
    glDeleteVertexArrays(1, &vertices_);
}

void GlTets::set_tets(std::span<const std::array<std::uint32_t, 4>> tets) {
    tets_.grow(tets.size_bytes());
    tets_.upload(tets.size_bytes(), tets.data());
}

void GlTets::set_faces(std::span<const TetFaces::Face> faces) {
    faces_.grow(faces.size_bytes());
    faces_.upload(faces.size_bytes(), faces.data());
}

void GlTets::set_frame(const GlTetFrame& frame, const View& view) {
    frame_ = &frame;
    view_ = &view;
    offset_px_ = Vec2(0.0);
    make_target(view.width(), view.height());
    fill(points_, frame.points);
    fill(order_, frame.order);
    fill(knots_, frame.knots);
    if (!frame.cuts.empty()) fill(cuts_, frame.cuts);
    if (program_knots_ != frame.knots.size()) programs_.clear();
    program_knots_ = frame.knots.size();
}

void GlTets::make_target(int width, int height) {
    if (width_ == width && height_ == height) return;
    check_picture_size(width, height, "a smaller picture, or the method tets");
    width_ = 0;  // in case an error is thrown below
    glDeleteTextures(1, &texture_);
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_RGBA32F, width, height);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
    check_gl("the picture");
    if (glCheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorCode::MissingCapability, "the GL device does not draw into floats", {}, "the method tets");
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width, height);
    width_ = width;
    height_ = height;
}

std::string GlTets::defines(const char* mode, int corners) const {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    const auto define = [&](const char* name, const auto& value) { text << "#define " << name << ' ' << value << '\n'; };
    define("PERSPECTIVE", int{view_->perspective()});
    define("FRAGMENT_COMPOSITE", 0);
    define("FRAGMENT_LISTS", 1);
    define("FRAGMENT_MODE", mode);
    define("CLIPPED", int{!frame_->cuts.empty()});
    define("RAYS_END", int{frame_->ends_rays});
    define("kCorners", corners);
    define("kKnots", frame_->knots.size());
    define("kRayCutoff", kRayCutoff);
    define("kSliceTolerance", kSliceTolerance);
    return text.str();
}

const GlProgram& GlTets::program(Items items, const char* mode) {
    const std::string text = defines(mode, items == Items::Tets ? 4 : 3);
    if (const auto found = programs_.find(text); found != programs_.end()) return found->second;
    const ShaderText vertex = items == Items::Tets ? ShaderText{"projected_tet.vert", kShader_projected_tet_vert}
                                                   : ShaderText{"projected_face.vert", kShader_projected_face_vert};
    const ShaderText fragment = items == Items::Tets ? ShaderText{"projected_tet.frag", kShader_projected_tet_frag}
                                                     : ShaderText{"projected_face.frag", kShader_projected_face_frag};
    return programs_.emplace(text, GlProgram(vertex, fragment, text, drawing_texts())).first->second;
}

const GlProgram& GlTets::program(Items items, ListStep step) {
    const bool sorting = step == ListStep::Sort || step == ListStep::Merge, faces = items == Items::Faces;
    const ShaderText source = step == ListStep::Sort     ? ShaderText{"projected_sort.comp", kShader_projected_sort_comp}
                              : step == ListStep::Merge  ? ShaderText{"projected_merge.comp", kShader_projected_merge_comp}
                              : step == ListStep::Window ? ShaderText{"projected_window.comp", kShader_projected_window_comp}
                              : faces                    ? ShaderText{"projected_kbuffer.comp", kShader_projected_kbuffer_comp}
                                                         : ShaderText{"projected_resolve.comp", kShader_projected_resolve_comp};
    const std::string text = defines("FRAGMENT_LISTS", faces ? 3 : 4) + "#define FACES " + (faces ? "1\n" : "0\n");
    const std::string key = source.file + text;
    if (const auto found = programs_.find(key); found != programs_.end()) return found->second;
    std::vector<ShaderText> texts{{"projected_frame.glsl", kShader_projected_frame_glsl}};
    if (step == ListStep::Composite) texts = light_texts();
    texts.push_back({"projected_lists.glsl", kShader_projected_lists_glsl});
    if (sorting)
        texts.push_back({"projected_entries.glsl", kShader_projected_entries_glsl});
    else if (faces)
        texts.push_back({"projected_state.glsl", kShader_projected_state_glsl});
    return programs_.emplace(key, GlProgram(source.file, source.text, text, texts)).first->second;
}

void GlTets::set_uniforms(const GlProgram& program, const PixelRect& rect) {
    const GLuint id = program.id();
    // In an orthographic view the size of a pixel is a length.
    const double pixel = view_->perspective() ? view_->pixel() : view_->pixel() / frame_->scale;
    const Vec2 middle = 0.5 * Vec2(width_, height_) - offset_px_;
    glProgramUniform2f(id, program.uniform("middle_px"), static_cast<float>(middle.x), static_cast<float>(middle.y));
    glProgramUniform2f(id, program.uniform("size_px"), static_cast<float>(width_), static_cast<float>(height_));
    glProgramUniform1f(id, program.uniform("pixel"), static_cast<float>(pixel));
    glProgramUniform1f(id, program.uniform("middle_depth"), static_cast<float>(frame_->middle_depth));
    glProgramUniform1f(id, program.uniform("per_unit"), static_cast<float>(frame_->opacity_units));
    glProgramUniform4i(id, program.uniform("rectangle"), rect.x0, rect.y0, rect.x1, rect.y1);
    if (frame_->cuts.empty()) return;
    cuts_.bind(kCutsBinding);
    glProgramUniform2i(id, program.uniform("plane_counts"), static_cast<GLint>(frame_->faces),
                       static_cast<GLint>(frame_->slices));
    glProgramUniform1i(id, program.uniform("slices_alone"), frame_->slices_alone);
}

void GlTets::draw_all(Items items, const GlProgram& program, const PixelRect& rect, const DrawStage& stage) {
    set_uniforms(program, rect);
    glProgramUniform1ui(program.id(), program.uniform("last_rank"), static_cast<GLuint>(frame_->order.size() - 1));
    points_.bind(kPointsBinding);
    (items == Items::Tets ? tets_ : faces_).bind(kItemsBinding);
    order_.bind(kOrderBinding);
    knots_.bind(kKnotsBinding);
    glBindVertexArray(vertices_);
    glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
    program.use();
    const std::size_t count = frame_->order.size(), corners = items == Items::Tets ? 6 : 3;
    GlPace pace(kFirstDrawn, kLeastDrawn, kMostDrawn);
    Stopwatch watch;
    for (std::size_t first = 0; first < count;) {
        const std::size_t end = std::min(count, first + pace.amount());
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(corners * first), static_cast<GLsizei>(corners * (end - first)));
        glFinish();  // otherwise all of it would be queued at once
        pace.took(watch.restart());
        stage.report(static_cast<double>(end) / static_cast<double>(count));
        first = end;
    }
    check_gl("projected tetrahedra");
}

void GlTets::draw_into_lists(Items items, bool keep, const PixelRect& rect, const DrawStage& stage) {
    // One program counts and keeps: two of them may be compiled to different instructions, and disagree about a pixel.
    const GlProgram& used = program(items, "FRAGMENT_LISTS");
    glProgramUniform1i(used.id(), used.uniform("keep"), keep);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_all(items, used, rect, stage);
}

Image GlTets::draw_in_order(const DrawStage& stage) {
    constexpr std::array<GLfloat, 4> kNothing{};
    const PixelRect whole{0, 0, width_, height_};
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glScissor(0, 0, width_, height_);
    glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, kNothing.data());
    draw_all(Items::Tets, program(Items::Tets, "FRAGMENT_COMPOSITE"), whole, stage);
    Image image(width_, height_);
    glGetTextureImage(texture_, 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(image.rgba.size() * sizeof(float)),
                      image.rgba.data());
    check_gl("reading the picture");
    return image;
}

}  // namespace subvol::detail
