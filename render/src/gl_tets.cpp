#include "gl_tets.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "gl_context.h"
#include "gl_dispatch.h"
#include "list_parts.h"
#include "shader_exp_log_glsl.h"
#include "shader_pt_frame_glsl.h"
#include "shader_pt_resolve_comp.h"
#include "shader_pt_segment_glsl.h"
#include "shader_pt_tet_frag.h"
#include "shader_pt_tet_vert.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

// As the shaders have them.
constexpr GLuint kCountsBinding = 3, kOffsetsBinding = 4, kLightsBinding = 5, kPlacesBinding = 6, kKnotsBinding = 10,
                 kViolationsBinding = 11;
constexpr std::size_t kLight_bytes = 16;        // of a fragment, and as many of its place
constexpr double kCounting = 0.2;               // part of the work with lists, roughly
constexpr std::size_t kDrawnAtOnce = 1U << 16;  // tetrahedra, between two looks at the progress

template <class T>
void fill(GlBuffer& buffer, GLuint binding, const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    buffer.grow(bytes);
    buffer.upload(bytes, values.data());
    buffer.bind(binding);
}

void check_size(const View& view) {
    GLint most = 0;
    std::array<GLint, 2> viewport{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
    most = std::min({most, viewport[0], viewport[1]});
    const int longest = std::max(view.width(), view.height());
    if (longest <= most) return;
    throw Error(
        ErrorCode::MissingCapability,
        "the GL device draws up to " + std::to_string(most) + " pixels in a row or column, not " + std::to_string(longest), {},
        "a smaller picture, or the method tets");
}

}  // namespace

GlTets::GlTets(const GlTetScene& scene, const View& view) : scene_(scene), view_(view) {
    check_size(view);
    fill(points_, 0, scene.points);
    fill(tets_, 1, scene.tets);
    fill(order_, 2, scene.order);
    fill(knots_, kKnotsBinding, scene.knots);
    glCreateVertexArrays(1, &vertices_);  // without any attribute: nothing is drawn without one
    make_target();
}

GlTets::~GlTets() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
    glDeleteVertexArrays(1, &vertices_);
}

void GlTets::make_target() {
    glCreateFramebuffers(1, &framebuffer_);
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_RGBA32F, view_.width(), view_.height());
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
    check_gl("the picture");
    if (glCheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorCode::MissingCapability, "the GL device does not draw into floats", {}, "the method tets");
    constexpr std::array<GLfloat, 4> kNothing{};
    glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, kNothing.data());
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, view_.width(), view_.height());
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DITHER);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

GlProgram GlTets::make_program(const char* mode) const {
    std::ostringstream text;
    const auto define = [&](const char* name, const auto& value) { text << "#define " << name << ' ' << value << '\n'; };
    define("PERSPECTIVE", int{view_.perspective()});
    define("PT_COMPOSITE", 0);
    define("PT_COUNT", 1);
    define("PT_KEEP", 2);
    define("PT_MODE", mode);
    define("kKnots", scene_.knots.size());
    return {ShaderText{"pt_tet.vert", kShader_pt_tet_vert},
            ShaderText{"pt_tet.frag", kShader_pt_tet_frag},
            text.str(),
            {{"pt_frame.glsl", kShader_pt_frame_glsl},
             {"exp_log.glsl", kShader_exp_log_glsl},
             {"pt_segment.glsl", kShader_pt_segment_glsl}}};
}

void GlTets::set_frame(const GlProgram& program, const PixelRect& rect) const {
    const GLuint id = program.id();
    const auto width = static_cast<float>(view_.width()), height = static_cast<float>(view_.height());
    // In an orthographic view a pixel is a length.
    const double pixel = view_.perspective() ? view_.pixel() : view_.pixel() / scene_.scale;
    glProgramUniform2f(id, program.uniform("middle_px"), 0.5f * width, 0.5f * height);
    glProgramUniform2f(id, program.uniform("size_px"), width, height);
    glProgramUniform1f(id, program.uniform("pixel"), static_cast<float>(pixel));
    glProgramUniform1f(id, program.uniform("middle_depth"), static_cast<float>(scene_.middle_depth));
    glProgramUniform1f(id, program.uniform("per_unit"), static_cast<float>(scene_.opacity_units));
    glProgramUniform4i(id, program.uniform("rectangle"), rect.x0, rect.y0, rect.x1, rect.y1);
}

void GlTets::draw_all(const GlProgram& program, const PixelRect& rect, Progress* progress, double done, double part) {
    set_frame(program, rect);
    glBindVertexArray(vertices_);
    glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
    program.use();
    const std::size_t count = scene_.order.size();
    for (std::size_t first = 0; first < count; first += kDrawnAtOnce) {
        const std::size_t end = std::min(count, first + kDrawnAtOnce);
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(6 * first), static_cast<GLsizei>(6 * (end - first)));
        if (progress) glFinish();  // else all would be under way at once
        report_progress(progress, "draw", done + part * static_cast<double>(end) / static_cast<double>(count));
    }
    check_gl("projected tetrahedra");
}

Image GlTets::draw_in_order(Progress* progress) {
    draw_all(make_program("PT_COMPOSITE"), {0, 0, view_.width(), view_.height()}, progress, 0, 1);
    Image image(view_.width(), view_.height());
    glGetTextureImage(texture_, 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(image.rgba.size() * sizeof(float)),
                      image.rgba.data());
    check_gl("reading the picture");
    return image;
}

GlTets::Lists GlTets::draw_in_lists(std::size_t most_fragments, Progress* progress) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    violations_ = GlBuffer(kViolationsBinding, sizeof(std::uint32_t), nullptr);
    violations_.clear();
    const auto counts = count_fragments(progress);
    const auto parts = split_into_parts(counts, view_.width(), view_.height(), most_fragments);
    Lists lists{Image(view_.width(), view_.height()), std::accumulate(counts.begin(), counts.end(), std::size_t{0}),
                parts.size()};
    const GlProgram keep = make_program("PT_KEEP");
    const double share = (1 - kCounting) / static_cast<double>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        draw_part(keep, parts[i], counts, lists.image, progress, kCounting + share * static_cast<double>(i), share);
    }
    std::uint32_t violations = 0;
    violations_.read(sizeof violations, &violations);
    lists.violations = violations;
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    return lists;
}

std::vector<std::uint32_t> GlTets::count_fragments(Progress* progress) {
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(view_.width()) * static_cast<std::size_t>(view_.height()));
    const std::size_t bytes = counts.size() * sizeof(std::uint32_t);
    counts_.grow(bytes);
    counts_.clear();
    counts_.bind(kCountsBinding);
    draw_all(make_program("PT_COUNT"), {0, 0, view_.width(), view_.height()}, progress, 0, kCounting);
    counts_.read(bytes, counts.data());
    return counts;
}

void GlTets::draw_part(const GlProgram& keep, const PixelRect& part, const std::vector<std::uint32_t>& counts, Image& image,
                       Progress* progress, double done, double share) {
    std::vector<std::uint32_t> offsets{0};
    for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width()) + static_cast<std::size_t>(x);
            offsets.push_back(offsets.back() + counts[pixel]);
        }
    }
    if (offsets.back() == 0) return;
    counts_.clear();
    counts_.bind(kCountsBinding);
    fill(offsets_, kOffsetsBinding, offsets);
    lights_.grow(offsets.back() * kLight_bytes);
    lights_.bind(kLightsBinding);
    places_.grow(offsets.back() * kLight_bytes);
    places_.bind(kPlacesBinding);
    draw_all(keep, part, progress, done, share);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    resolve_part(part, image);
}

void GlTets::resolve_part(const PixelRect& part, Image& image) {
    constexpr std::uint32_t kGroup = 64;
    const auto width = static_cast<std::size_t>(part.x1 - part.x0), height = static_cast<std::size_t>(part.y1 - part.y0);
    const auto pixels = static_cast<std::uint32_t>(width * height);
    const GlProgram resolve("pt_resolve.comp", kShader_pt_resolve_comp, {});
    picture_.grow(pixels * kLight_bytes);
    picture_.bind(kCountsBinding);
    glProgramUniform1ui(resolve.id(), resolve.uniform("pixels"), pixels);
    resolve.use();
    dispatch((pixels + kGroup - 1) / kGroup);
    std::vector<std::array<float, 4>> colors(pixels);
    picture_.read(pixels * kLight_bytes, colors.data());
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t x = static_cast<std::size_t>(part.x0) + i % width, y = static_cast<std::size_t>(part.y0) + i / width;
        std::copy(colors[i].begin(), colors[i].end(),
                  image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * (y * static_cast<std::size_t>(view_.width()) + x)));
    }
}

}  // namespace subvol::detail
