#include <tbb/global_control.h>

#include <chrono>

#include "splat_backend.h"
#include "subvol/error.h"
#include "subvol/render.h"

namespace subvol {

namespace {

/// GL tiles are one work group; CPU tiles are larger, so that a kernel is read less often.
constexpr int kTileGl_px = 16;
constexpr int kTileCpu_px = 32;

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

SplatResult render_splats(const RbfVolume& volume, const View& view, const Optics& optics, const SplatOptions& options) {
    const Choice choice = choose(options.backend);
    SplatResult result;
    auto& report = result.report;
    const auto start = std::chrono::steady_clock::now();
    const auto values = make_preintegrated_table(optics);
    const auto frame = detail::prepare_splats(volume, view, values, options, choice.gl ? kTileGl_px : kTileCpu_px);
    const auto table = detail::over_unit_range(values);
    report.seconds_prepare = seconds_since(start);

    const auto drawing = std::chrono::steady_clock::now();
    result.image = choice.gl ? detail::draw_splats_gl(frame, view, table, options.progress)
                             : detail::draw_splats_cpu(frame, view, table, options.progress);
    report.seconds_draw = seconds_since(drawing);
    report.backend = choice.gl ? "gl" : "cpu";
    report.device = choice.device;
    report.points = volume.size();
    report.bin_entries = frame.bin_splats.size();
    report.boundary_hits = frame.intervals.hits;
    return result;
}

}  // namespace subvol
