#include "gl_splatter.h"

#include <algorithm>
#include <charconv>

#include "gl_context.h"
#include "gl_splat_bins.h"
#include "shader_gl_groups_glsl.h"
#include "shader_splat_classify_glsl.h"
#include "shader_splat_draw_comp.h"
#include "shader_splat_frame_glsl.h"
#include "shader_splat_light_glsl.h"
#include "shader_splat_sums_glsl.h"
#include "shader_splat_walk_glsl.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kState_bytes = 64;  // of a pixel, between passes
constexpr int kStaged = 512;              // cuts of kernels in shared memory
constexpr int kMostChunk = 64;            // kernels there

std::string decimal(float value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific).ptr;
    return {text, end};
}

std::string common_defines(const SplatScene& scene, const GlTuning& tuning) {
    const auto line = [](const char* name, const std::string& value) { return "#define " + (name + (" " + value)) + "\n"; };
    return gl_scene_defines(scene) + line("kTile", std::to_string(tuning.tile_px)) +
           line("kBatch", std::to_string(tuning.batch)) +
           line("kChunk", std::to_string(std::min(kMostChunk, kStaged / tuning.batch))) +
           line("kCells", std::to_string(PreintegratedTable::kCells)) + line("kLeastWeight", decimal(kLeastWeight)) +
           line("kNearValues", decimal(kNearValues)) + line("kOpaque", decimal(kOpaque)) +
           line("kFarCells", decimal(kFarCells));
}

template <class T>
void upload(GlBuffer& buffer, const std::vector<T>& values) {
    buffer.grow(values.size() * sizeof(T));
    buffer.upload(values.size() * sizeof(T), values.data());
}

/// What kernel i has of eye depth, from that of the middle.
struct DepthRange {
    float front, back;
};

}  // namespace

class GlSplatter::State {
public:
    State(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning)
        : context_(device),
          scene_(scene),
          tuning_(tuning),
          bins_(common_defines(scene, tuning), GlExtras(scene).count),
          draw_("splat_draw.comp", kShader_splat_draw_comp, common_defines(scene, tuning),
                {{"gl_groups.glsl", kShader_gl_groups_glsl},
                 {"splat_frame.glsl", kShader_splat_frame_glsl},
                 {"splat_sums.glsl", kShader_splat_sums_glsl},
                 {"splat_classify.glsl", kShader_splat_classify_glsl},
                 {"splat_light.glsl", kShader_splat_light_glsl},
                 {"splat_walk.glsl", kShader_splat_walk_glsl}}) {
        GLint64 most = 0;
        glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
        most_bytes_ = std::min(tuning.most_buffer_bytes, static_cast<std::size_t>(std::max<GLint64>(most, 0)));
        upload(kernel_table_, scene.kernel_table);
        bins_.upload(pack_kernels(scene, {}));
    }

    Drawn draw(const View& view, const Classification& look, int sheets, Progress* progress);

    GlContext context_;
    GlSplatReport report_;

private:
    void prepare(const View& view, const Classification& look, const SheetStack& sheets);
    void set_pass(int first, int end);
    void draw_pass(std::uint32_t most);
    [[nodiscard]] Drawn read(const View& view);

    const SplatScene& scene_;
    GlTuning tuning_;
    std::size_t most_bytes_ = 0, room_ = 0;  // entries that there is room for
    GlSplatFrame frame_;
    GlSplatBins bins_;
    GlProgram draw_;
    GlStages stages_;
    GlBuffer frame_buffer_, kernel_table_, rows_, visible_, color_rows_, interval_offsets_, intervals_, picture_, depths_,
        states_;
};

void GlSplatter::State::prepare(const View& view, const Classification& look, const SheetStack& sheets) {
    stages_.clear();
    frame_ = gl_splat_frame(scene_, view, look, sheets, tuning_.tile_px, tuning_.batch);
    frame_.kernels = bins_.kernels();
    upload(rows_, look.table.rows);
    upload(visible_, look.table.visible);
    upload(color_rows_, look.colors.rows);
    const std::size_t pixels = static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height());
    picture_.grow(pixels * 4 * sizeof(float));
    depths_.grow(pixels * sizeof(float));
    if (scene_.half_weight > 0) return;
    const double near = static_cast<double>(sheets.near) + static_cast<double>(sheets.middle);
    const auto intervals = boundary_intervals(scene_.volume->boundary, view, near, static_cast<double>(sheets.middle));
    upload(interval_offsets_, intervals.offsets);
    upload(intervals_, intervals.depths);
    report_.boundary_hits = intervals.hits;
}

void GlSplatter::State::set_pass(int first, int end) {
    frame_.first_batch = first;
    frame_.end_batch = end;
    frame_.most_entries = static_cast<std::uint32_t>(room_);
    frame_buffer_.grow(sizeof frame_);
    frame_buffer_.upload(sizeof frame_, &frame_);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer_.id());
}

void GlSplatter::State::draw_pass(std::uint32_t most) {
    bins_.list(frame_, most, stages_);
    stages_.begin("draw");
    draw_.use();
    bins_.bind();
    interval_offsets_.bind(5);
    intervals_.bind(6);
    rows_.bind(7);
    visible_.bind(8);
    color_rows_.bind(9);
    kernel_table_.bind(10);
    picture_.bind(11);
    depths_.bind(12);
    states_.bind(13);
    dispatch(frame_.tiles());
    stages_.begin("");
    check_gl("splat");
}

Drawn GlSplatter::State::draw(const View& view, const Classification& look, int sheets, Progress* progress) {
    report_progress(progress, "splat", 0);
    report_ = {};
    prepare(view, look, make_sheets(scene_, view, sheets));
    // As much room as the last picture took is mostly enough: the device is asked only at the end.
    for (;;) {
        set_pass(0, frame_.batches);
        bins_.count(stages_);
        if (room_ > 0) draw_pass(static_cast<std::uint32_t>(room_));
        report_.bin_entries = bins_.entries();
        if (room_ > 0 && report_.bin_entries <= room_) break;
        room_ = report_.bin_entries + report_.bin_entries / 8 + 1;
    }
    report_.passes = 1;
    Drawn drawn = read(view);
    report_.stages = stages_.times();
    report_progress(progress, "splat", 1);
    return drawn;
}

Drawn GlSplatter::State::read(const View& view) {
    Drawn drawn{Image(view.width(), view.height()), {}};
    picture_.read(drawn.image.rgba.size() * sizeof(float), drawn.image.rgba.data());
    drawn.depth.resize(drawn.image.rgba.size() / 4);
    depths_.read(drawn.depth.size() * sizeof(float), drawn.depth.data());
    return drawn;
}

GlSplatter::GlSplatter(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning)
    : state_(std::make_unique<State>(scene, device, tuning)) {
    state_->context_.release();
}

GlSplatter::~GlSplatter() {
    if (!state_) return;
    try {
        const GlScope scope(state_->context_);  // what is on the device goes with it
        state_.reset();
    } catch (const Error&) {
        (void)state_.release();  // a device that is in use elsewhere keeps it
    }
}

GlSplatter::GlSplatter(GlSplatter&&) noexcept = default;
GlSplatter& GlSplatter::operator=(GlSplatter&& other) noexcept {
    state_.swap(other.state_);
    return *this;
}

Drawn GlSplatter::draw(const View& view, const Classification& look, int sheets, Progress* progress) {
    const GlScope scope(state_->context_);
    return state_->draw(view, look, sheets, progress);
}

const std::string& GlSplatter::renderer() const {
    return state_->context_.renderer();
}

const GlSplatReport& GlSplatter::report() const {
    return state_->report_;
}

}  // namespace subvol::detail
