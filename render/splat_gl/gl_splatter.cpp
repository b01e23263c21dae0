// SPDX-License-Identifier: Apache-2.0
// The splatter on the GPU: the method of splat_cpu/splat_tile-inl.h (sums of kernels on sheets, then pre-integrated compositing
// [mnmq2007, rke2000]) as compute shaders.
//
//     splat_eye     each kernel: to eye space, and how many bins (tile, batch of sheets) it meets
//     scan, emit    an entry (bin, kernel) for each of them; a prefix sum of the counts gives the places
//     sort, ranges  entries sorted by bin, and where each bin begins; within a bin kernels stay in ascending order
//     boundary      the intervals of each pixel inside the volume (gl_boundary.cpp)
//     splat_draw    a work group for each tile, a thread for each pixel: batches front to back, sums in registers
//
// The sort is stable and no float is added atomically, so each sum has one order and pictures are bitwise reproducible. The
// number of entries is not known before they are counted, and waiting for it would stall the device: the room of the last
// picture is used, and only at the end is the count compared with it (draw_at_once). If kernels or entries exceed the room of
// a buffer, the batches are halved until each range fits (split), and the state of the pixels is kept between the passes. A
// pass draws some tiles at a time, and repeats a dispatch until all of them are done (draw_tiles): no thread goes through more
// than a limited number of iterations in one dispatch, whatever the scene.
#include "gl_splatter.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "boundary_light.h"
#include "clip_intervals.h"
#include "gl_boundary.h"
#include "gl_context.h"
#include "gl_pace.h"
#include "gl_splat_bins.h"
#include "kernel_axes.h"
#include "shader_exp_log_glsl.h"
#include "shader_gl_groups_glsl.h"
#include "shader_splat_absorb_glsl.h"
#include "shader_splat_classify_glsl.h"
#include "shader_splat_draw_comp.h"
#include "shader_splat_frame_glsl.h"
#include "shader_splat_light_glsl.h"
#include "shader_splat_shadow_glsl.h"
#include "shader_splat_sums_glsl.h"
#include "shader_splat_walk_glsl.h"
#include "splat_frame.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPixel_bytes = 16;                     // for each pixel of the picture
constexpr std::size_t kState_bytes = 64;                     // for each pixel, between dispatches
constexpr std::size_t kEnds_bytes = 32;                      // for each interval
constexpr std::size_t kKept_bytes = std::size_t{1} << 26;    // for sums that have to be continued, about
constexpr std::size_t kFirstTiles = 1024, kLeastTiles = 16;  // of a dispatch
constexpr std::size_t kFirstSteps = std::size_t{1} << 14;    // of its threads; Mesa's software ends loops after 2^16

std::string decimal(float value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific).ptr;
    return {text, end};
}

std::string common_defines(const SplatScene& scene, const GlTuning& tuning) {
    const auto line = [](const char* name, const std::string& value) { return "#define " + (name + (" " + value)) + "\n"; };
    return gl_scene_defines(scene) + line("kTile", std::to_string(tuning.tile_px)) +
           line("kBatch", std::to_string(tuning.batch)) + line("kChunk", tuning.batch <= 8 ? "64" : "32") +
           line("kCells", std::to_string(PreintegratedTable::kCells)) +
           line("kLeastWeight", decimal(static_cast<float>(kLeastWeight))) + line("kNearValues", decimal(kNearValues)) +
           line("kSplatCutoff", decimal(kSplatCutoff)) + line("kFarCells", decimal(kFarCells)) +
           line("kMostOfKernel", decimal(kMostOfKernel)) + line("kThickDepth", decimal(kThickDepth)) +
           line("kAimedDepth", decimal(kAimedDepth)) + line("kOpaqueDepth", decimal(kOpaqueDepth)) +
           line("kSkin_px", decimal(kSkin_px)) + line("kFinerSide", std::to_string(FinerSheets::kSide_px)) +
           line("kFinerSheets", std::to_string(FinerSheets::kSheets));
}

template <class T>
void upload(GlBuffer& buffer, const std::vector<T>& values) {
    buffer.grow(values.size() * sizeof(T));
    buffer.upload(values.size() * sizeof(T), values.data());
}

GlProgram drawing_program(const std::string& defines) {
    return {"splat_draw.comp",
            kShader_splat_draw_comp,
            defines,
            {{"gl_groups.glsl", kShader_gl_groups_glsl},
             {"splat_frame.glsl", kShader_splat_frame_glsl},
             {"splat_sums.glsl", kShader_splat_sums_glsl},
             {"exp_log.glsl", kShader_exp_log_glsl},
             {"splat_classify.glsl", kShader_splat_classify_glsl},
             {"splat_light.glsl", kShader_splat_light_glsl},
             {"splat_shadow.glsl", kShader_splat_shadow_glsl},
             {"splat_absorb.glsl", kShader_splat_absorb_glsl},
             {"splat_walk.glsl", kShader_splat_walk_glsl}}};
}

/// The tuning with sizes for the device where it leaves them open.
GlTuning tuned(GlTuning tuning, bool hardware) {
    if (tuning.tile_px == 0) tuning.tile_px = hardware ? 8 : 16;
    if (tuning.batch == 0) tuning.batch = hardware ? 4 : kBatch;
    return tuning;
}

/// throws: Error(MissingCapability) if the current context cannot run the shaders of a scene
const SplatScene& checked(const SplatScene& scene) {
    check_storage({.compute = scene.shadowed() ? 16 : 15, .bindings = 16}, GlStorage::available(), "use the CPU backend");
    return scene;
}

/// Counts of visible rows, and levels behind them, four in a word.
std::vector<std::int32_t> with_levels(std::vector<std::int32_t> visible, const FinerSheets& finer) {
    const std::size_t first = visible.size();
    visible.resize(first + (finer.levels.size() + 3) / 4, 0);
    for (std::size_t i = 0; i < finer.levels.size(); ++i) {
        visible[first + i / 4] |= static_cast<std::int32_t>(std::uint32_t{finer.levels[i]} << (i % 4 * 8));
    }
    return visible;
}

/// The kernels that may meet some sheets, with a sheet more on each side, so that rounding does not lose one.
std::vector<std::uint32_t> kernels_between(const SplatScene& scene, const View& view, const SheetStack& sheets, int first_sheet,
                                           int end_sheet) {
    const double middle = view.to_eye(scene.middle).z, distance = static_cast<double>(sheets.distance);
    const double front = static_cast<double>(sheets.depth(first_sheet)) - distance;
    const double back = static_cast<double>(sheets.depth(end_sheet - 1)) + distance;
    const double widening = scene.form == KernelForm::Separable ? 3 : 1;
    std::vector<char> wanted(scene.volume->size());
    tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
        const Vec3& forward = view.axes()[2];
        const double z = view.to_eye(scene.volume->centers[i]).z - middle;
        const double szz = glm::dot(forward, matrix(scene.volume->frames[i]) * forward);
        const double reach = std::sqrt(std::max(0.0, widening * szz)) * (1 + 1e-5);
        wanted[i] = z + reach >= front && z - reach <= back;
    });
    std::vector<std::uint32_t> ids;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i]) ids.push_back(static_cast<std::uint32_t>(i));
    }
    return ids;
}

}  // namespace

class GlSplatter::State {
public:
    State(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning)
        : context(device),
          scene_(checked(scene)),
          tuning_(tuned(tuning, context.hardware())),
          bins_(common_defines(scene, tuning_), GlExtras(scene).count),
          boundary_(context.hardware() || tuning.boundary_on_device),
          draw_(drawing_program(common_defines(scene, tuning_) + "#define CLIPPED 0\n")) {
        GLint64 most = 0;
        glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
        const std::size_t bytes = std::min(tuning.most_buffer_bytes, static_cast<std::size_t>(std::max<GLint64>(most, 0)));
        const std::size_t memory = tuning.memory_bytes > 0 ? tuning.memory_bytes : memory_budget(context.hardware());
        const std::uint32_t extras = GlExtras(scene).count;
        most_kernels_ =
            std::min(bytes / GlSplatBins::kernel_bytes(extras) - 1, memory / 2 / GlSplatBins::bytes_of_kernel(extras));
        most_entries_ = std::min({tuning.most_entries, bytes / sizeof(std::uint32_t) - 1, std::size_t{kMostGlItems},
                                  memory / 2 / GlSplatBins::kEntry_bytes});
        most_bins_ = std::min(bytes / sizeof(std::uint32_t) - 1, std::size_t{kMostGlItems});
        most_tiles_ = static_cast<std::uint32_t>(
            std::clamp<std::size_t>(kKept_bytes / (tile_pixels() * sums_bytes()), 1, tuning.most_tiles));
        tiles_at_once_ = {kFirstTiles, std::min<std::size_t>(kLeastTiles, most_tiles_), most_tiles_};
        const std::size_t least = std::min<std::size_t>(kFirstSteps, tuning.most_steps);
        steps_at_once_ = {least, least, context.hardware() ? tuning.most_steps : least};
        upload(kernel_table_, scene.kernel_table);
        upload_kernels();
    }

    void upload_kernels() {
        resident_ = scene_.volume->size() <= most_kernels_;
        if (resident_) bins_.upload(pack_kernels(scene_));
    }

    Drawn draw(const View& view, const Classification& classification, int sheets, Progress* progress);

    /// Does some work, and remembers if the device fails.
    auto attempt(const auto& work) {
        try {
            return work();
        } catch (const Error& error) {
            failed = failed || error.code() == ErrorCode::MissingCapability;
            throw;
        }
    }

    GlContext context;
    GlSplatReport report;
    bool failed = false;

private:
    /// by_tolerance: whether nobody has chosen the number of sheets
    void prepare(const View& view, const Classification& classification, bool by_tolerance);
    [[nodiscard]] FinerSheets finer_sheets(const View& view, const Classification& classification);
    void find_intervals(const View& view);
    [[nodiscard]] bool draw_at_once(Progress* progress);
    [[nodiscard]] bool fits_bins(int first, int end) const;
    void draw_in_passes(const View& view, int first, int end, Progress* progress);
    void split(const View& view, int first, int end, Progress* progress);
    void set_pass(int first, int end);
    void draw_pass(Progress* progress);
    void draw_tiles(std::uint32_t first, std::uint32_t end, bool whole, Progress* progress);
    [[nodiscard]] std::size_t tile_pixels() const { return static_cast<std::size_t>(tuning_.tile_px * tuning_.tile_px); }
    /// The bytes of a pixel's sums on the sheets of a batch.
    [[nodiscard]] std::size_t sums_bytes() const {
        const std::size_t sums = 2 + (scene_.color_channel ? 1 : 0) + (scene_.shading ? 3 : 0);
        return sums * static_cast<std::size_t>(tuning_.batch) * sizeof(float);
    }
    [[nodiscard]] const GlProgram& program();
    /// Whether rays have intervals: there is a boundary, or rays are cut.
    [[nodiscard]] bool has_intervals() const { return scene_.half_weight == 0 || cuts_; }
    void read(Drawn& drawn);

    const SplatScene& scene_;
    GlTuning tuning_;
    std::size_t most_kernels_ = 0, most_entries_ = 0, most_bins_ = 0;
    std::uint32_t most_tiles_ = 1;
    GlPace tiles_at_once_{1, 1, 1}, steps_at_once_{1, 1, 1};  // of a dispatch; kept from picture to picture
    bool resident_ = false;                                   // whether all kernels are on the device
    std::size_t room_ = 0;                                    // for so many entries
    bool cuts_ = false;                                       // of the picture, as has_cuts
    SheetStack sheets_;
    GlSplatFrame frame_;
    SplatFrame host_;  // its kernels, as far as the host needs them
    GlSplatBins bins_;
    GlBoundary boundary_;
    GlProgram draw_;
    std::optional<GlProgram> draw_clipped_;  // a volume without a boundary; made when its rays are cut for the first time
    GlStages stages_;
    GlBuffer frame_buffer_, kernel_table_, rows_, visible_, color_rows_, picture_, kept_, states_, ends_, light_;
};

void GlSplatter::State::prepare(const View& view, const Classification& classification, bool by_tolerance) {
    stages_.clear();
    frame_ = gl_splat_frame(scene_, view, classification, sheets_, tuning_.tile_px, tuning_.batch);
    upload(rows_, classification.table.rows);
    const bool may_be_finer = by_tolerance && may_be_thin(scene_, sheets_);
    const FinerSheets finer = may_be_finer ? finer_sheets(view, classification) : FinerSheets{};
    frame_.finer = finer.any();
    report.sheets_finest = finer.sheets_finest(sheets_.count);
    upload(visible_, with_levels(classification.table.visible, finer));
    upload(color_rows_, classification.colors.rows);
    if (scene_.light) upload(light_, scene_.light->nodes);
    const std::size_t pixels = pixel_count(view.width(), view.height());
    picture_.grow(pixels * kPixel_bytes);
    find_intervals(view);
}

/// On the host, which thereby chooses as for its own pictures.
FinerSheets GlSplatter::State::finer_sheets(const View& view, const Classification& classification) {
    host_.scene = &scene_;
    host_.view = &view;
    host_.classification = &classification;
    host_.sheets = sheets_;
    eye_splats(host_.kernels, scene_, view, classification);
    return detail::finer_sheets(host_);
}

void GlSplatter::State::find_intervals(const View& view) {
    cuts_ = has_cuts(scene_, view);
    if (!has_intervals()) return;
    const double middle = view.to_eye(scene_.middle).z, near = static_cast<double>(sheets_.near) + middle;
    const Surface& surface = scene_.volume->boundary;
    if (scene_.shading || cuts_) {  // the device neither finds the triangles that are seen nor clips
        const PixelIntervals intervals = scene_intervals(scene_, view, sheets_);
        boundary_.set(intervals, view);
        std::vector<std::array<float, 4>> ends(intervals.depths.size(), {kUnknownValue, 0, 1, 0});
        if (scene_.shading) {
            const std::vector<SurfaceLight> lights = entry_lights(intervals, scene_, view);
            for (std::size_t i = 0; i < ends.size(); ++i) {
                ends[i] = {kUnknownValue, 0, lights[i / 2].diffuse, lights[i / 2].specular};
            }
        }
        upload(ends_, ends);
    } else {
        boundary_.find(surface, view, near, middle, stages_);
        ends_.grow(boundary_.room() * kEnds_bytes);
    }
}

void GlSplatter::State::set_pass(int first, int end) {
    frame_.first_batch = first;
    frame_.end_batch = end;
    frame_.kernels = bins_.kernels();
    frame_.most_entries = static_cast<std::uint32_t>(room_);
    frame_buffer_.grow(sizeof frame_);
    frame_buffer_.upload(sizeof frame_, &frame_);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer_.id());
}

const GlProgram& GlSplatter::State::program() {
    if (scene_.half_weight == 0 || !cuts_) return draw_;
    if (!draw_clipped_) draw_clipped_.emplace(drawing_program(common_defines(scene_, tuning_) + "#define CLIPPED 1\n"));
    return *draw_clipped_;
}

void GlSplatter::State::draw_pass(Progress* progress) {
    report.lists += bins_.list(frame_, stages_) ? 1 : 0;
    stages_.begin("draw");
    program().use();
    bins_.bind();
    boundary_.bind(5, 6);
    rows_.bind(7);
    visible_.bind(8);
    color_rows_.bind(9);
    kernel_table_.bind(10);
    picture_.bind(11);
    const std::uint32_t tiles = frame_.tiles(), room = std::min(tiles, most_tiles_);
    const bool whole = frame_.end_batch - frame_.first_batch == frame_.batches;  // no pass needs the states of another
    const auto pixels = pixel_count(frame_.width, frame_.height);
    kept_.grow(sizeof(std::uint32_t) + pixels * sizeof(float) + room * tile_pixels() * sums_bytes());
    kept_.bind(12);
    states_.grow((whole ? room : tiles) * tile_pixels() * kState_bytes);
    states_.bind(13);
    ends_.bind(14);
    if (scene_.light) light_.bind(15);
    for (std::uint32_t first = 0; first < tiles;) {
        const std::uint32_t end = std::min(first + static_cast<std::uint32_t>(tiles_at_once_.amount()), tiles);
        draw_tiles(first, end, whole, progress);
        first = end;
    }
    stages_.begin("");
    check_gl("splat");
}

/// Draws some tiles of a pass: repeats the dispatch until none has batches left.
void GlSplatter::State::draw_tiles(std::uint32_t first, std::uint32_t end, bool whole, Progress* progress) {
    const GlProgram& used = program();
    glProgramUniform2ui(used.id(), used.uniform("tile_range"), first, end);
    glProgramUniform1ui(used.id(), used.uniform("first_state"), whole ? first : 0);
    const double batches = frame_.end_batch - frame_.first_batch, of_pass = batches * frame_.tiles();
    constexpr std::uint32_t kNone = 0;
    std::uint32_t left = 0;
    Stopwatch watch;
    for (bool resumed = false; !resumed || left > 0; resumed = true) {
        glProgramUniform1i(used.id(), used.uniform("resumed"), resumed);
        glProgramUniform1ui(used.id(), used.uniform("most_steps"), static_cast<GLuint>(steps_at_once_.amount()));
        kept_.upload(sizeof kNone, &kNone);
        dispatch(end - first);
        ++report.dispatches;
        report.tiles += end - first;
        kept_.read(sizeof left, &left);
        // What ended the dispatch is adapted: its steps, or else its tiles.
        const double seconds = watch.restart();
        if (left == 0 || !steps_at_once_.took(seconds)) tiles_at_once_.took(seconds);
        const double done = (batches * end - left) / of_pass;
        report_progress(progress, "splat", (frame_.first_batch + batches * done) / frame_.batches);
    }
}

Drawn GlSplatter::State::draw(const View& view, const Classification& classification, int sheets, Progress* progress) {
    report_progress(progress, "splat", 0);
    report = {};
    sheets_ = make_sheets(scene_, view, sheets);
    Drawn drawn;
    tbb::task_group making;  // while the device draws: to set so much memory to zero takes longer than to fill it
    making.run([&] {
        drawn.image = Image(view.width(), view.height());
        drawn.depth.resize(pixel_count(view.width(), view.height()));
    });
    report.sheets = sheets_.count;
    prepare(view, classification, sheets == 0);
    if (!draw_at_once(progress)) draw_in_passes(view, 0, frame_.batches, progress);
    // Likewise for the boundary's hits.
    if (has_intervals() && !boundary_.found_all()) {
        report = {.sheets = sheets_.count, .sheets_finest = report.sheets_finest, .stages = {}};
        find_intervals(view);
        draw_in_passes(view, 0, frame_.batches, progress);
    }
    report.boundary_hits = has_intervals() ? boundary_.hits() : 0;
    making.wait();
    read(drawn);
    report.stages = stages_.times();
    report_progress(progress, "splat", 1);
    return drawn;
}

/// Draws all batches in one pass with the room that the last picture needed, and reads back the number of entries only at the
/// end. Returns whether there was enough room.
bool GlSplatter::State::draw_at_once(Progress* progress) {
    if (room_ == 0 || !resident_ || !fits_bins(0, frame_.batches)) return false;
    set_pass(0, frame_.batches);
    bins_.count(stages_);
    draw_pass(progress);
    const std::size_t entries = bins_.entries();
    if (entries > room_) return false;
    report.bin_entries = entries;
    report.passes = 1;
    return true;
}

void GlSplatter::State::draw_in_passes(const View& view, int first, int end, Progress* progress) {
    if (!fits_bins(first, end)) return split(view, first, end, progress);
    if (!resident_) {
        const auto ids =
            kernels_between(scene_, view, sheets_, first * tuning_.batch, std::min(end * tuning_.batch, sheets_.count));
        if (ids.size() > most_kernels_) return split(view, first, end, progress);
        bins_.upload(pack_kernels(scene_, ids));
    }
    set_pass(first, end);
    bins_.count(stages_);
    const std::size_t entries = bins_.entries();
    if (entries > most_entries_) return split(view, first, end, progress);
    if (entries > room_ || room_ == 0) room_ = std::min(entries + entries / 8 + 1, most_entries_);
    set_pass(first, end);
    draw_pass(progress);
    report.bin_entries += entries;
    ++report.passes;
}

void GlSplatter::State::split(const View& view, int first, int end, Progress* progress) {
    if (end - first == 1) {
        throw Error(ErrorCode::MissingCapability, "the kernels of a few sheets need more room than the GL device has", {},
                    "more sheets, a smaller picture or the CPU backend");
    }
    const int middle = first + (end - first) / 2;
    draw_in_passes(view, first, middle, progress);
    draw_in_passes(view, middle, end, progress);
}

bool GlSplatter::State::fits_bins(int first, int end) const {
    return static_cast<std::size_t>(frame_.tiles()) * static_cast<std::size_t>(end - first) <= most_bins_;
}

void GlSplatter::State::read(Drawn& drawn) {
    picture_.read(drawn.image.rgba.size() * sizeof(float), drawn.image.rgba.data());
    kept_.read(drawn.depth.size() * sizeof(float), drawn.depth.data(), sizeof(std::uint32_t));
}

GlSplatter::GlSplatter(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning) {
    assert((tuning.tile_px == 0 || tuning.tile_px == 8 || tuning.tile_px == 16) && tuning.batch >= 0 && tuning.batch <= 16);
    assert(tuning.most_tiles > 0 && tuning.most_steps >= 64 * static_cast<std::uint32_t>(tuning.batch));
    const KeepCurrent keep;
    state_ = std::make_unique<State>(scene, device, tuning);
}

GlSplatter::~GlSplatter() {
    if (state_) free_in(state_->context, state_);
}

GlSplatter::GlSplatter(GlSplatter&&) noexcept = default;
GlSplatter& GlSplatter::operator=(GlSplatter&& other) noexcept {
    state_.swap(other.state_);
    return *this;
}

void GlSplatter::upload_kernels() {
    const GlScope scope(state_->context);
    state_->attempt([&] { state_->upload_kernels(); });
}

Drawn GlSplatter::draw(const View& view, const Classification& classification, int sheets, Progress* progress) {
    const GlScope scope(state_->context);
    return state_->attempt([&] { return state_->draw(view, classification, sheets, progress); });
}

bool GlSplatter::failed() const {
    return state_->failed;
}

const std::string& GlSplatter::renderer() const {
    return state_->context.renderer();
}

const GlSplatReport& GlSplatter::report() const {
    return state_->report;
}

}  // namespace subvol::detail
