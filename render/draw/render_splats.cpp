// SPDX-License-Identifier: Apache-2.0
// Draws kernels as splats, and keeps what it can from picture to picture. The backend is the GPU, the CPU, sheets in OpenGL, or
// footprints; without a choice it is a hardware GPU if there is one, else the CPU, which also takes over from a GPU that fails.
//
//     classify ─► light volume (shadows, occlusion) ─► picture with n × n samples a pixel ─► means ─► colours of the boundary
//                  made anew if its key changes        frame made anew if its key changes
//
// Keys are lists of numbers: all that the light or the frame depends on besides the kernels. If only colours and opacities
// differ from the picture before, the frame stays and gets another transfer function. New kernels clear both keys. Means of
// depths are weighted by opacity. OpenGL contexts are current only while they are used; one that fails is given up, and the
// next picture makes another.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "footprints.h"
#include "gl_context.h"
#include "gl_sheets.h"
#include "gl_splatter.h"
#include "make_light_volume.h"
#include "picture_facts.h"
#include "pixel_tiles.h"
#include "splat_cpu.h"
#include "subvol/boundary_shading.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/splat.h"

namespace subvol {

namespace {

/// Software GL is slower than the CPU and draws the same picture, so it is used only if it is chosen.
SplatMethod resolved(const SplatOptions& options) {
    if (options.method != SplatMethod::Auto) return options.method;
    const auto device = find_gl_device(options.device);
    return device && device->hardware ? SplatMethod::Gl : SplatMethod::Cpu;
}

/// Draws sheets in its own context, which is current only while it draws.
class SheetDrawer {
public:
    explicit SheetDrawer(std::optional<int> device) : context_(device), sheets_(std::make_unique<detail::GlSheets>()) {}
    ~SheetDrawer() { detail::free_in(context_, sheets_); }
    SheetDrawer(const SheetDrawer&) = delete;
    SheetDrawer& operator=(const SheetDrawer&) = delete;

    [[nodiscard]] detail::Drawn draw(const detail::SplatFrame& frame, Progress* progress) {
        const detail::GlScope scope(context_);
        try {
            return sheets_->draw(frame, progress);
        } catch (const Error& error) {
            failed_ = failed_ || error.code() == ErrorCode::MissingCapability;
            throw;
        }
    }
    /// Whether drawing has failed: the context may be lost.
    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] const std::string& renderer() const { return context_.renderer(); }

private:
    detail::GlContext context_;
    std::unique_ptr<detail::GlSheets> sheets_;
    bool failed_ = false;
};

std::unique_ptr<SheetDrawer> make_sheet_drawer(const SplatOptions& options) {
    if (!find_gl_device(options.device))
        throw Error(ErrorCode::MissingCapability, "sheets need OpenGL 4.5, and none was found through EGL", {},
                    "the method splat");
    const detail::KeepCurrent keep;
    return std::make_unique<SheetDrawer>(options.device);
}

struct Mean {
    std::array<float, 4> color{};
    float depth = std::numeric_limits<float>::infinity();
};

Mean mean_of(const SplatResult& drawn, int x, int y, int n) {
    std::array<double, 4> sum{};
    double depth = 0, seen = 0;
    for (int j = y * n; j < (y + 1) * n; ++j) {
        for (int i = x * n; i < (x + 1) * n; ++i) {
            const auto pixel = drawn.image.pixel(i, j);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += double{pixel[c]};
            const auto at =
                static_cast<std::size_t>(j) * static_cast<std::size_t>(drawn.image.width) + static_cast<std::size_t>(i);
            if (!std::isfinite(drawn.depth[at])) continue;
            depth += double{pixel[3]} * double{drawn.depth[at]};
            seen += double{pixel[3]};
        }
    }
    Mean mean;
    for (std::size_t c = 0; c < 4; ++c) mean.color[c] = static_cast<float>(sum[c] / (n * n));
    if (seen > 0) mean.depth = static_cast<float>(depth / seen);
    return mean;
}

/// Replaces each n × n pixels by their mean; depths are weighted by opacity.
void take_means(SplatResult& drawn, int n) {
    if (n == 1) return;
    Image image(drawn.image.width / n, drawn.image.height / n);
    std::vector<float> depth(image.rgba.size() / 4);
    tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const Mean mean = mean_of(drawn, x, y, n);
            std::copy(mean.color.begin(), mean.color.end(), image.pixel(x, y).begin());
            depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] =
                mean.depth;
        }
    });
    drawn.image = std::move(image);
    drawn.depth = std::move(depth);
}

/// Numbers that a part of a picture depends on: as long as they are the same, the part is that of the picture before.
using Key = std::vector<double>;

void add(Key& key, const Vec3& v) {
    key.insert(key.end(), {v.x, v.y, v.z});
}

void add(Key& key, const std::vector<CutPlane>& planes) {
    key.push_back(static_cast<double>(planes.size()));
    for (const CutPlane& plane : planes) {
        add(key, plane.point);
        add(key, plane.normal);
    }
}

void add(Key& key, const std::optional<Box>& box) {
    if (!box) return;
    add(key, box->lower);
    add(key, box->upper);
}

/// What the light in a volume depends on besides its kernels: the view's axes, to which the key light is fixed, the opacities,
/// and what is cut away. Moving along these axes and coming nearer changes none of them.
Key light_key(const View& view, const Optics& optics, const Clip& clip) {
    Key key{optics.opacity_unit(), clip.slices_alone() ? 1.0 : 0.0};
    for (const Vec3& axis : view.axes()) add(key, axis);
    add(key, clip.planes);
    add(key, clip.box);
    // The knots of the colours, too: tables of opacities are made between all knots.
    for (const double knot : optics.knots()) key.push_back(knot);
    for (const auto& knot : optics.function().opacity) key.insert(key.end(), {knot.value, knot.alpha});
    return key;
}

/// What a prepared frame depends on besides its kernels: the view, the ends of its rays, what is cut away, and the range of the
/// transfer function, in whose cells values are counted.
Key frame_key(const View& view, const detail::SplatScene& scene, const detail::Classification& classification,
              const Clip& clip) {
    Key key{static_cast<double>(view.width()), static_cast<double>(view.height()), view.pixel(),
            view.perspective() ? 1.0 : 0.0,    classification.table.min,           classification.table.max,
            classification.colors.min,         classification.colors.max,          scene.solid ? 1.0 : 0.0,
            clip.around_slices ? 1.0 : 0.0};
    add(key, view.eye());
    for (const Vec3& axis : view.axes()) add(key, axis);
    add(key, clip.planes);
    add(key, clip.slices);
    add(key, clip.box);
    key.insert(key.end(), view.ray_ends().begin(), view.ray_ends().end());
    return key;
}

}  // namespace

struct Splatter::State {
    State(const RbfVolume& volume, const SplatOptions& wanted)
        : options(wanted), automatic(wanted.method == SplatMethod::Auto), scene(detail::make_scene(volume, wanted)) {
        options.method = resolved(wanted);
        if (options.method == SplatMethod::Sheets && scene.shadowed()) {
            throw Error(ErrorCode::InvalidInput, "sheet buffers support neither shadows nor ambient occlusion", {},
                        "the method splat");
        }
        try {
            open_device();
        } catch (const Error& error) {
            use_cpu_after(error);
        }
        if (options.method == SplatMethod::Footprints) footprints.emplace(scene);
    }

    /// Makes what draws with OpenGL, unless it is there.
    void open_device() {
        if (options.method == SplatMethod::Gl && !gpu) gpu.emplace(scene, options.device);
        if (options.method == SplatMethod::Sheets && !sheets) sheets = make_sheet_drawer(options);
    }

    /// Goes on with the CPU after an error of a GPU that nobody has asked for; throws it again if somebody has, or if the GPU
    /// is not to blame. A context that failed is given up, so that the next picture makes a new one.
    void use_cpu_after(const Error& error) {
        if (sheets && sheets->failed()) sheets.reset();
        if (gpu && gpu->failed()) gpu.reset();
        if (!automatic || gpu || options.method != SplatMethod::Gl || error.code() != ErrorCode::MissingCapability) throw;
        options.method = SplatMethod::Cpu;
        warning = "the CPU draws, as the GPU cannot: " + error.message();
    }

    [[nodiscard]] detail::Drawn draw(const View& view, const detail::Classification& classification, Progress* progress,
                                     SplatReport& report) {
        if (footprints) return draw_footprints(view, classification, progress, report);
        try {
            open_device();
            if (gpu) return draw_on_gpu(view, classification, progress, report);
            if (sheets) return draw_frame(view, classification, progress, report);
        } catch (const Error& error) {
            use_cpu_after(error);
        }
        report.warning = std::exchange(warning, {});
        return draw_frame(view, classification, progress, report);
    }

    /// Draws with the CPU or with sheet buffers; the CPU prepares the frame for both.
    [[nodiscard]] detail::Drawn draw_frame(const View& view, const detail::Classification& classification, Progress* progress,
                                           SplatReport& report) {
        const detail::Stopwatch watch;
        report.kept = prepare(view, classification, progress);
        report.sheets = frame.sheets.count;
        report.sheets_finest = sheets ? report.sheets : frame.finer.sheets_finest(report.sheets);
        report.seconds_prepare += watch.seconds();
        report.backend = sheets ? "gl" : "cpu";
        report.device = sheets ? sheets->renderer() : detail::cpu_threads();
        report.bin_entries = frame.tile_splats.size();
        report.boundary_hits = frame.intervals.hits;
        return sheets ? sheets->draw(frame, progress) : detail::draw_splats_cpu(frame, progress);
    }

    /// Prepares the frame. Returns whether only colours and opacities are others than in the picture before, so that most of it
    /// stays as it is.
    bool prepare(const View& view, const detail::Classification& classification, Progress* progress) {
        Key key = frame_key(view, scene, classification, options.clip);
        const bool kept = std::exchange(made_of, {}) == key;
        if (kept)
            detail::set_transfer_function(frame, view, classification, options.sheets);
        else
            detail::prepare_frame(frame, scene, view, classification, options.sheets, progress);
        // The light at the ends depends on opacities.
        if (!kept || scene.shading || scene.light) detail::find_interval_ends(frame);
        made_of = std::move(key);
        return kept;
    }

    [[nodiscard]] detail::Drawn draw_footprints(const View& view, const detail::Classification& classification,
                                                Progress* progress, SplatReport& report) {
        report.backend = "cpu";
        report.device = detail::cpu_threads();
        detail::Drawn drawn = footprints->draw(frame, view, classification, progress);
        report.bin_entries = frame.tile_splats.size();
        return drawn;
    }

    [[nodiscard]] detail::Drawn draw_on_gpu(const View& view, const detail::Classification& classification, Progress* progress,
                                            SplatReport& report) {
        auto drawn = gpu->draw(view, classification, options.sheets, progress);
        report.backend = "gl";
        report.device = gpu->renderer();
        report.sheets = gpu->report().sheets;
        report.sheets_finest = gpu->report().sheets_finest;
        report.bin_entries = gpu->report().bin_entries;
        report.boundary_hits = gpu->report().boundary_hits;
        report.stages = gpu->report().stages;
        return drawn;
    }

    SplatOptions options;
    bool automatic;         // whether nobody has chosen the backend
    std::string warning{};  // that has not been reported yet
    detail::SplatScene scene;
    const Surface* boundary = nullptr;  // whose values give the colours; null: kernels do
    std::span<const double> values{};
    detail::LightVolume light{};  // of the last picture
    Key light_key{};              // what it was made of, besides the kernels
    std::optional<detail::GlSplatter> gpu;
    std::unique_ptr<SheetDrawer> sheets;
    std::optional<detail::Footprints> footprints;
    detail::SplatFrame frame{};  // its memory is used for every picture
    Key made_of{};               // the frame, besides the kernels; empty: it has to be made anew
};

Splatter::Splatter(const RbfVolume& volume, const SplatOptions& options) {
    detail::check_samples(options.samples);
    state_ = std::make_unique<State>(volume, options);
}

Splatter::~Splatter() = default;
Splatter::Splatter(Splatter&&) noexcept = default;
Splatter& Splatter::operator=(Splatter&&) noexcept = default;

void Splatter::set_clip(const Clip& clip) {
    detail::set_clip(state_->scene, clip);
    state_->options.clip = clip;
    if (state_->footprints) detail::check_footprints(state_->scene);
}

void Splatter::set_boundary_colors(const Surface& boundary, std::span<const double> values) {
    const bool shown = !values.empty() && !state_->scene.shadowed() && !state_->footprints;
    state_->boundary = shown ? &boundary : nullptr;
    state_->values = values;
}

void Splatter::set_kernels(const RbfVolume& volume) {
    State& state = *state_;
    detail::set_kernels(state.scene, volume, state.options.clip);
    state.light_key.clear();  // the light in the volume is made of kernels
    state.made_of.clear();
    try {
        if (state.gpu) state.gpu->upload_kernels();
    } catch (const Error& error) {
        state.use_cpu_after(error);
    }
}

SplatResult Splatter::draw(const View& view, const Optics& optics, Progress* progress) {
    State& state = *state_;
    if (!progress) progress = state.options.progress;
    SplatResult result;
    auto& report = result.report;
    const detail::Stopwatch watch;
    const auto classification = detail::classify(state.scene, optics);
    state.scene.solid = detail::is_solid(state.scene, optics);
    if (state.scene.shadowed()) {
        if (Key key = light_key(view, optics, state.options.clip); key != state.light_key) {
            state.light = detail::make_light_volume(state.scene, view, classification);
            state.light_key = std::move(key);
        }
        state.scene.light = &state.light;
        report.seconds_light = watch.seconds();
    }
    report.seconds_prepare = watch.seconds();
    const int n = state.options.samples;
    const View fine = view.resized(n * view.width(), n * view.height());  // the centres of its pixels are the samples
    auto drawn = state.draw(fine, classification, progress, report);
    result.image = std::move(drawn.image);
    result.depth = std::move(drawn.depth);
    take_means(result, n);
    report.seconds_draw = watch.seconds() - report.seconds_prepare;
    if (state.boundary != nullptr) {
        report_progress(progress, "colors", 0);
        const detail::Stopwatch coloring;
        color_boundary(result.image, *state.boundary, state.values, view, optics, state.options.shading.value_or(Shading{}), n,
                       state.options.clip);
        report.seconds_colors = coloring.seconds();
    }
    report.points = state.scene.volume->size();
    return result;
}

SplatResult render_splats(const RbfVolume& volume, const View& view, const Optics& optics, const SplatOptions& options) {
    return Splatter(volume, options).draw(view, optics);
}

}  // namespace subvol
