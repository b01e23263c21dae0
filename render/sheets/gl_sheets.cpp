// SPDX-License-Identifier: Apache-2.0
// The splatter of the EuroVis 2007 paper [mnmq2007]: image-aligned sheet buffers [westover1990, mc1998] on the GPU.
//
//             1    2    3    4     Sheets are planes of constant eye depth; this kernel is cut by 2 and 3. For each sheet:
//     eye ->  |  .-|----|-.  |       draw       a rectangle around the section of each kernel; blending adds w and w·v to a
//             | (  |    |  ) |                  buffer of floats (sheet_kernel.vert, .frag)
//             |  '-|----|-'  |       composite  each pixel takes the mean x = Σ w·v / Σ w; a table of integrals of the transfer
//                                               function gives the light between x on the last sheet and on this one, which
//                                               is blended under the light before (sheet_composite.comp)
//
// The CPU lists the kernels of some sheets at a time (sheet_target.cpp), so that memory does not grow with the number of
// sheets. Only the rectangle that the kernels of this sheet and of the last one touch is drawn and composited. This is slower
// than splat_gl/, which keeps the sums in registers, and serves for comparison (docs/adr/0011).
#include "gl_sheets.h"

#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

#include "gl_context.h"
#include "shader_exp_log_glsl.h"
#include "shader_sheet_composite_comp.h"
#include "shader_sheet_frame_glsl.h"
#include "shader_sheet_kernel_frag.h"
#include "shader_sheet_kernel_vert.h"
#include "shader_sheet_splats_glsl.h"
#include "shader_sheet_walk_glsl.h"
#include "shader_splat_absorb_glsl.h"
#include "shader_splat_classify_glsl.h"
#include "shader_splat_light_glsl.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

/// The number of sheets whose kernels are listed at a time: the lists take no more memory than the kernels, of 16 words each.
constexpr int kListed = 16;
/// A draw has about so many fragments and at most so many kernels, so that no draw takes long.
constexpr std::size_t kMostFragments = std::size_t{1} << 26, kMostDrawn = std::size_t{1} << 20;
constexpr GLuint kListBinding = 6;
constexpr GLuint kTableBinding = 7;  // the same as in splat_classify.glsl; then those of sheet_composite.comp

std::string defines(const SplatFrame& frame) {
    const SplatScene& scene = *frame.scene;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::scientific;
    text.precision(9);
    const auto define = [&](const char* name, auto value) { text << "#define " << name << ' ' << value << '\n'; };
    define("KERNEL_FORM", static_cast<int>(scene.form));
    define("KERNEL_STEPS", scene.kernel_table.empty() ? 1 : scene.kernel_table.size() - 1);
    define("BENT", int{scene.bent});
    define("SHADED", int{scene.shading.has_value()});
    define("SHADOWED", 0);
    define("COLORED", int{scene.color_channel.has_value()});
    define("NORMALIZED", int{scene.normalized});
    define("BOUNDED", int{scene.half_weight == 0});
    define("INTERVALS", int{!frame.intervals.offsets.empty()});
    define("PERSPECTIVE", int{frame.view->perspective()});
    define("kCells", PreintegratedTable::kCells);
    define("kNearValues", kNearValues);
    define("kLeastWeight", kLeastWeight);
    define("kSplatCutoff", kSplatCutoff);
    define("kFarCells", kFarCells);
    define("kThickDepth", kThickDepth);
    define("kAimedDepth", kAimedDepth);
    define("kOpaqueDepth", kOpaqueDepth);
    define("kSkin_px", kSkin_px);
    return text.str();
}

/// Sets a program's uniforms by name; those that the compiler has removed are ignored.
class Uniforms {
public:
    explicit Uniforms(const GlProgram& program) : program_(program) {}

    void set(const char* name, int v) const { glProgramUniform1i(program_.id(), at(name), v); }
    void set(const char* name, float v) const { glProgramUniform1f(program_.id(), at(name), v); }
    void set(const char* name, float x, float y) const { glProgramUniform2f(program_.id(), at(name), x, y); }
    void set(const char* name, const std::array<float, 4>& v) const {
        glProgramUniform4fv(program_.id(), at(name), 1, v.data());
    }
    void set_integers(const char* name, int x, int y) const { glProgramUniform2i(program_.id(), at(name), x, y); }
    void set(const char* name, const PixelRect& r) const {
        glProgramUniform4i(program_.id(), at(name), r.x0, r.y0, r.x1, r.y1);
    }

private:
    [[nodiscard]] GLint at(const char* name) const { return program_.uniform(name); }

    const GlProgram& program_;
};

/// Sets the uniforms that are the same for all sheets.
void set_frame(const SplatFrame& frame, const GlProgram& kernels, const GlProgram& composite) {
    const SplatScene& scene = *frame.scene;
    const View& view = *frame.view;
    for (const GlProgram* program : {&kernels, &composite}) {
        const Uniforms u(*program);
        u.set("middle_px", 0.5f * static_cast<float>(view.width()), 0.5f * static_cast<float>(view.height()));
        u.set("pixel", static_cast<float>(view.pixel()));
    }
    Uniforms(kernels).set("size_px", static_cast<float>(view.width()), static_cast<float>(view.height()));
    const Uniforms u(composite);
    u.set_integers("size_px", view.width(), view.height());
    u.set("near", frame.sheets.near);
    u.set("middle_z", frame.sheets.middle);
    u.set("offsets", value_offset(scene, *frame.classification),
          scene.color_channel ? color_offset(scene, *frame.classification) : 0.0f);
    u.set("unit", frame.classification->table.unit);
    u.set("half_weight", scene.half_weight);
    u.set("least_gradient", kLeastChange * PreintegratedTable::kCells / static_cast<float>(scene.diagonal));
    if (!scene.shading) return;
    const Shading& s = *scene.shading;
    u.set("material", std::array{static_cast<float>(s.ambient), static_cast<float>(s.diffuse), static_cast<float>(s.specular),
                                 static_cast<float>(s.shininess)});
    const Vec3 key = glm::normalize(s.key);
    u.set("key", std::array{static_cast<float>(key.x), static_cast<float>(key.y), static_cast<float>(key.z),
                            static_cast<float>(s.head)});
}

template <class T>
void fill(GlBuffer& buffer, GLuint binding, const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    buffer.grow(bytes);
    buffer.upload(bytes, values.data());
    buffer.bind(binding);
}

/// Sets a buffer to zero and binds it.
void start(GlBuffer& buffer, GLuint binding, std::size_t bytes) {
    buffer.grow(bytes);
    buffer.clear();
    buffer.bind(binding);
}

/// The state of a pixel between two sheets; the same as in shaders/sheet_composite.comp.
struct Last {
    float value, weight, depth;
    std::uint32_t interval;
};

std::size_t pixels(const View& view) {
    return pixel_count(view.width(), view.height());
}

std::size_t pixels_to_do(const SplatFrame& frame) {
    const auto& offsets = frame.intervals.offsets;
    if (offsets.empty()) return pixels(*frame.view);
    std::size_t count = 0;
    for (std::size_t id = 0; id + 1 < offsets.size(); ++id) count += offsets[id] != offsets[id + 1] ? 1 : 0;
    return count;
}

/// For each sheet the rectangle of the pixels whose intervals begin or end between the sheet before and this one.
std::vector<PixelRect> rects_of_ends(const SplatFrame& frame) {
    const SheetStack& sheets = frame.sheets;
    std::vector<PixelRect> rects(static_cast<std::size_t>(sheets.count));
    const int width = frame.view->width();
    for (std::size_t id = 0; id + 1 < frame.intervals.offsets.size(); ++id) {
        const int x = static_cast<int>(id) % width, y = static_cast<int>(id) / width;
        for (std::size_t i = 2 * std::size_t{frame.intervals.offsets[id]}; i < 2 * std::size_t{frame.intervals.offsets[id + 1]};
             ++i) {
            const float behind = std::ceil((frame.intervals.depths[i] - sheets.first) / sheets.distance);
            const auto sheet = static_cast<std::size_t>(std::clamp(behind, 0.0f, static_cast<float>(sheets.count - 1)));
            rects[sheet] = rects[sheet].with({x, y, x + 1, y + 1});
            if (sheet > 0) rects[sheet - 1] = rects[sheet - 1].with({x, y, x + 1, y + 1});  // in case of rounding
        }
    }
    return rects;
}

}  // namespace

GlSheets::GlSheets() {
    check_storage({.vertex = 7, .fragment = 6, .compute = 10, .bindings = 16}, GlStorage::available(), "the method splat");
    glCreateVertexArrays(1, &vertices_);  // it has no attributes, but OpenGL does not draw without one
    check_gl("sheet buffers");
}

GlSheets::~GlSheets() {
    glDeleteVertexArrays(1, &vertices_);
}

Drawn GlSheets::draw(const SplatFrame& frame, Progress* progress) {
    const SplatScene& scene = *frame.scene;
    report_progress(progress, "splat", 0);
    check_for_gl(frame.intervals);
    const Programs& used = programs(frame);
    upload(frame);
    start_beams(frame);
    set_frame(frame, used.kernels, used.composite);
    target_.begin(frame.view->width(), frame.view->height(), scene.shading || scene.color_channel);
    glBindVertexArray(vertices_);

    const PixelRect window = seen_pixels(frame);
    const std::size_t to_do = pixels_to_do(frame);
    const std::vector<PixelRect> ends = rects_of_ends(frame);
    PixelRect last;  // where the last sheet has kernels
    for (int first = 0; first < frame.sheets.count && !window.empty(); first += kListed) {
        const int end = std::min(first + kListed, frame.sheets.count);
        const SheetLists lists = list_sheets(frame, window, first, end);
        ids_ = GlBuffer(kListBinding, lists.splats.size() * sizeof(std::uint32_t), lists.splats.data());
        for (int sheet = first; sheet < end; ++sheet) {
            const auto k = static_cast<std::size_t>(sheet - first);
            // Where neither this sheet nor the last one has kernels, there is no value, unless an empty sum counts as 0, or a
            // thin body lies between them.
            const PixelRect kernels = scene.normalized ? lists.rects[k].with(last) : window;
            const PixelRect rect = kernels.with(ends[static_cast<std::size_t>(sheet)]);
            last = lists.rects[k];
            if (rect.empty()) continue;
            target_.clear(rect);
            draw_kernels(frame, used.kernels, sheet, lists, k);
            composite(frame, used.composite, sheet, rect);
            report_progress(progress, "splat", static_cast<double>(sheet + 1) / frame.sheets.count);
        }
        if (done_pixels() == to_do) break;
    }
    check_gl("splat");
    return read(frame);
}

const GlSheets::Programs& GlSheets::programs(const SplatFrame& frame) {
    const std::string features = defines(frame);
    if (const auto found = programs_.find(features); found != programs_.end()) return found->second;
    GlProgram kernels(ShaderText{"sheet_kernel.vert", kShader_sheet_kernel_vert},
                      ShaderText{"sheet_kernel.frag", kShader_sheet_kernel_frag}, features,
                      {{"sheet_splats.glsl", kShader_sheet_splats_glsl}});
    GlProgram composite("sheet_composite.comp", kShader_sheet_composite_comp, features,
                        {{"sheet_frame.glsl", kShader_sheet_frame_glsl},
                         {"exp_log.glsl", kShader_exp_log_glsl},
                         {"splat_classify.glsl", kShader_splat_classify_glsl},
                         {"splat_light.glsl", kShader_splat_light_glsl},
                         {"splat_absorb.glsl", kShader_splat_absorb_glsl},
                         {"sheet_walk.glsl", kShader_sheet_walk_glsl}});
    return programs_.emplace(features, Programs{std::move(kernels), std::move(composite)}).first->second;
}

void GlSheets::upload(const SplatFrame& frame) {
    const EyeSplats& kernels = frame.kernels;
    fill(splats_, 0, kernels.splats);
    fill(bends_, 1, kernels.bends);
    fill(colors_, 2, kernels.colors);
    fill(color_bends_, 3, kernels.color_bends);
    fill(axes_, 4, kernels.axes);
    fill(kernel_table_, 5, frame.scene->kernel_table);
    fill(table_, kTableBinding, frame.classification->table.rows);
    fill(visible_, kTableBinding + 1, frame.classification->table.visible);
    fill(color_table_, kTableBinding + 2, frame.classification->colors.rows);
    fill(interval_offsets_, kTableBinding + 3, frame.intervals.offsets);
    fill(intervals_, kTableBinding + 4, frame.intervals.depths);
    ends_.grow(frame.ends.size() * sizeof(IntervalEnd));
    ends_.upload(frame.ends.size() * sizeof(IntervalEnd), frame.ends.data());
}

void GlSheets::start_beams(const SplatFrame& frame) {
    const std::size_t count = pixels(*frame.view);
    start(beams_, kTableBinding + 5, count * 4 * sizeof(float));
    start(lasts_, kTableBinding + 6, count * sizeof(Last));
    if (frame.scene->shading || frame.scene->color_channel) looks_.grow(count * 4 * sizeof(float));
    looks_.bind(kTableBinding + 7);
    start(done_, kTableBinding + 8, sizeof(std::uint32_t));
}

void GlSheets::draw_kernels(const SplatFrame& frame, const GlProgram& program, int sheet, const SheetLists& lists,
                            std::size_t at) {
    const std::size_t begin = lists.offsets[at], count = lists.offsets[at + 1] - begin;
    if (count == 0) return;
    const float z = frame.sheets.depth(sheet), across = frame.view->perspective() ? frame.sheets.middle + z : 1.0f;
    const Uniforms u(program);
    u.set("sheet_z", z);
    u.set("across", across);
    u.set("to_pixels", 1.0f / (across * static_cast<float>(frame.view->pixel())));
    program.use();
    ids_.bind(kListBinding);
    // Triangles instead of instances: hardware does not fill its units with four vertices; for software it is the same.
    const std::size_t draws = std::clamp<std::size_t>(lists.fragments[at] / kMostFragments + 1, count / kMostDrawn + 1, count);
    for (std::size_t i = 0; i < draws; ++i) {
        const std::size_t first = begin + count * i / draws, end = begin + count * (i + 1) / draws;
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(6 * first), static_cast<GLsizei>(6 * (end - first)));
        if (draws > 1) glFlush();
    }
}

void GlSheets::composite(const SplatFrame& frame, const GlProgram& program, int sheet, const PixelRect& rect) {
    constexpr int kGroup = 8;
    const auto groups = [](int from, int to) { return static_cast<GLuint>((to - from + kGroup - 1) / kGroup); };
    const float back = frame.sheets.depth(sheet);
    const Uniforms u(program);
    u.set("rectangle", rect);
    u.set("front_z", sheet > 0 ? frame.sheets.depth(sheet - 1) : back - frame.sheets.distance);
    u.set("back_z", back);
    u.set("first", int{sheet == 0});
    program.use();
    ends_.bind(kListBinding);  // the place of the list, which is not used here
    target_.detach();
    glDispatchCompute(groups(rect.x0, rect.x1), groups(rect.y0, rect.y1), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

// Waits for the device: sheets that nobody sees need not be listed.
std::uint32_t GlSheets::done_pixels() const {
    std::uint32_t count = 0;
    done_.read(sizeof count, &count);
    return count;
}

Drawn GlSheets::read(const SplatFrame& frame) const {
    const View& view = *frame.view;
    Drawn drawn{Image(view.width(), view.height()), {}};
    auto& rgba = drawn.image.rgba;
    beams_.read(rgba.size() * sizeof(float), rgba.data());
    std::vector<Last> lasts(pixels(view));
    lasts_.read(lasts.size() * sizeof(Last), lasts.data());
    drawn.depth.assign(lasts.size(), std::numeric_limits<float>::infinity());
    for (std::size_t id = 0; id < lasts.size(); ++id) {
        const float opacity = rgba[4 * id + 3];
        if (opacity > 0) drawn.depth[id] = frame.sheets.middle + lasts[id].depth / opacity;
    }
    return drawn;
}

}  // namespace subvol::detail
