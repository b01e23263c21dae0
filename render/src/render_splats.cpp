#include <tbb/global_control.h>

#include <chrono>

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

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

struct Splatter::State {
    SplatOptions options;
    Choice choice;
    detail::SplatScene scene;
    detail::SplatFrame frame{};  // its memory is used again
};

Splatter::Splatter(const RbfVolume& volume, const SplatOptions& options)
    : state_(std::make_unique<State>(State{options, choose(options.backend), detail::make_scene(volume, options)})) {
}

Splatter::~Splatter() = default;
Splatter::Splatter(Splatter&&) noexcept = default;
Splatter& Splatter::operator=(Splatter&&) noexcept = default;

SplatResult Splatter::draw(const View& view, const Optics& optics) {
    auto& [options, choice, scene, frame] = *state_;
    SplatResult result;
    auto& report = result.report;
    const auto start = std::chrono::steady_clock::now();
    const auto look = detail::classify(scene, optics);
    detail::prepare_frame(frame, scene, view, look, options.sheets, options.progress);
    report.seconds_prepare = seconds_since(start);

    const auto drawing = std::chrono::steady_clock::now();
    auto drawn = detail::draw_splats_cpu(frame, options.progress);
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
