#include <tbb/combinable.h>

#include <chrono>

#include "boundary_scene.h"
#include "pixel_tiles.h"
#include "subvol/render.h"
#include "tet_mesh.h"
#include "tet_tracer.h"

namespace subvol {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Traces, and hands its counts on when its tile is done.
class CountedTracer {
public:
    CountedTracer(TetTracer tracer, tbb::combinable<TraceCounts>& sums) : tracer_(std::move(tracer)), sums_(&sums) {}
    CountedTracer(CountedTracer&&) = delete;
    ~CountedTracer() {
        TraceCounts& sum = sums_->local();
        sum.rays += tracer_.counts().rays;
        sum.segments += tracer_.counts().segments;
        sum.lost_rays += tracer_.counts().lost_rays;
    }
    Segment operator()(const Ray& ray) { return tracer_.trace(ray); }

private:
    TetTracer tracer_;
    tbb::combinable<TraceCounts>* sums_;
};

}  // namespace

TetsResult render_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view, const Optics& optics,
                       const TetsOptions& options) {
    check_samples(options.samples);
    check_tet_input(mesh, scalar);
    TetsResult result;
    TetsReport& report = result.report;

    auto start = Clock::now();
    report_progress(options.progress, "build", 0);
    const TetMesh tets = build_tet_mesh(mesh, scalar);
    report_progress(options.progress, "build", 0.8);
    const BoundaryScene scene(tets, bounds(mesh));
    report_progress(options.progress, "build", 1);
    report.seconds_build = seconds_since(start);
    report.tets = tets.tets.size();
    report.degenerate_tets = tets.degenerate_tets;
    report.inverted_tets = tets.inverted_tets;

    start = Clock::now();
    tbb::combinable<TraceCounts> sums;
    result.image = draw_in_tiles(view, options.samples, options.progress,
                                 [&] { return CountedTracer(TetTracer(tets, scene, optics), sums); });
    sums.combine_each([&](const TraceCounts& sum) {
        report.rays += sum.rays;
        report.segments += sum.segments;
        report.lost_rays += sum.lost_rays;
    });
    report.seconds_draw = seconds_since(start);
    return result;
}

}  // namespace subvol
