#include <tbb/global_control.h>

#include <chrono>

#include "gl_context.h"
#include "gl_sheets.h"
#include "splat_backend.h"
#include "subvol/error.h"
#include "subvol/render.h"

namespace subvol {

namespace {

struct Choice {
    bool gl = false;
    std::string device;
};

Choice choose(Backend wanted) {
    const auto cpu = [] {
        const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
        return Choice{false, std::to_string(threads) + " CPU threads"};
    };
    if (wanted == Backend::Cpu) return cpu();
    const auto device = find_gl_device();
    // Software GL is slower than the CPU backend and draws the same: only when asked for.
    if (device && (wanted == Backend::Gl || device->hardware)) return {true, device->renderer};
    if (wanted == Backend::Gl) {
        throw Error(ErrorCode::MissingCapability, "no OpenGL 4.5 was found through EGL", {}, "use the CPU backend");
    }
    return cpu();
}

/// Draws sheets in a context of its own, which is current only while it is worked with.
class SheetDrawer {
public:
    SheetDrawer() {
        sheets_.emplace();
        context_.release();
    }
    ~SheetDrawer() {
        const detail::GlScope scope(context_);
        sheets_.reset();
    }
    SheetDrawer(const SheetDrawer&) = delete;
    SheetDrawer& operator=(const SheetDrawer&) = delete;

    [[nodiscard]] detail::Drawn draw(const detail::SplatFrame& frame, Progress* progress) {
        const detail::GlScope scope(context_);
        return sheets_->draw(frame, progress);
    }
    [[nodiscard]] const std::string& device() const { return context_.renderer(); }

private:
    detail::GlContext context_;
    std::optional<detail::GlSheets> sheets_;
};

/// Nothing if sheets are not what is asked for.
std::unique_ptr<SheetDrawer> make_sheet_drawer(const SplatOptions& options) {
    if (options.method != SplatMethod::Sheets) return nullptr;
    if (options.backend == Backend::Cpu)
        throw Error(ErrorCode::InvalidInput, "sheets are drawn by OpenGL only", {}, "the backends auto and gl");
    if (!find_gl_device())
        throw Error(ErrorCode::MissingCapability, "sheets need OpenGL 4.5, and none was found through EGL", {},
                    "the method splat");
    return std::make_unique<SheetDrawer>();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

struct Splatter::State {
    SplatOptions options;
    Choice choice;
    detail::SplatScene scene;
    std::unique_ptr<SheetDrawer> sheets{};
    detail::SplatFrame frame{};  // its memory is used again
};

Splatter::Splatter(const RbfVolume& volume, const SplatOptions& options) {
    auto scene = detail::make_scene(volume, options);
    auto sheets = make_sheet_drawer(options);
    const Choice choice = sheets ? Choice{true, sheets->device()} : choose(options.backend);
    state_ = std::make_unique<State>(State{options, choice, std::move(scene), std::move(sheets)});
}

Splatter::~Splatter() = default;
Splatter::Splatter(Splatter&&) noexcept = default;
Splatter& Splatter::operator=(Splatter&&) noexcept = default;

SplatResult Splatter::draw(const View& view, const Optics& optics) {
    auto& [options, choice, scene, sheets, frame] = *state_;
    SplatResult result;
    auto& report = result.report;
    const auto start = std::chrono::steady_clock::now();
    const auto look = detail::classify(scene, optics);
    detail::prepare_frame(frame, scene, view, look, options.sheets, options.progress);
    report.seconds_prepare = seconds_since(start);

    const auto drawing = std::chrono::steady_clock::now();
    auto drawn = sheets ? sheets->draw(frame, options.progress) : detail::draw_splats_cpu(frame, options.progress);
    result.image = std::move(drawn.image);
    result.depth = std::move(drawn.depth);
    report.seconds_draw = seconds_since(drawing);
    report.backend = choice.gl ? "gl" : "cpu";
    report.device = choice.device;
    report.points = scene.volume->size();
    report.bin_entries = frame.tile_splats.size();
    report.boundary_hits = frame.intervals.hits;
    return result;
}

SplatResult render_splats(const RbfVolume& volume, const View& view, const Optics& optics, const SplatOptions& options) {
    return Splatter(volume, options).draw(view, optics);
}

}  // namespace subvol
