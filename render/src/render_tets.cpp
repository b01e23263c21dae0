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

struct TetsRenderer::State {
    TetMesh tets;
    std::optional<BoundaryScene> scene;
    TetsReport built;
};

TetsRenderer::TetsRenderer(const HexMesh& mesh, std::span<const double> scalar, Progress* progress)
    : state_(std::make_unique<State>()) {
    check_tet_input(mesh, scalar);
    const auto start = Clock::now();
    report_progress(progress, "build", 0);
    TetMesh& tets = state_->tets;
    tets = build_tet_mesh(mesh, scalar);
    report_progress(progress, "build", 0.8);
    state_->scene.emplace(tets, bounds(mesh));
    report_progress(progress, "build", 1);
    TetsReport& built = state_->built;
    built.tets = tets.tets.size();
    built.degenerate_tets = tets.degenerate_tets;
    built.inverted_tets = tets.inverted_tets;
    built.bytes = tets.tets.size() * sizeof(TetMesh::Tet) + tets.points.size() * sizeof(TetMesh::Point) +
                  tets.boundary.size() * sizeof(TetFace);
    built.seconds_build = seconds_since(start);
}

TetsRenderer::~TetsRenderer() = default;
TetsRenderer::TetsRenderer(TetsRenderer&&) noexcept = default;
TetsRenderer& TetsRenderer::operator=(TetsRenderer&&) noexcept = default;

double TetsRenderer::seconds_build() const {
    return state_->built.seconds_build;
}

TetsResult TetsRenderer::draw(const View& view, const Optics& optics, const TetsOptions& options) const {
    check_samples(options.samples);
    TetsResult result{{}, state_->built};
    TetsReport& report = result.report;
    const auto start = Clock::now();
    tbb::combinable<TraceCounts> sums;
    result.image = draw_in_tiles(view, options.samples, options.progress,
                                 [&] { return CountedTracer(TetTracer(state_->tets, *state_->scene, optics), sums); });
    sums.combine_each([&](const TraceCounts& sum) {
        report.rays += sum.rays;
        report.segments += sum.segments;
        report.lost_rays += sum.lost_rays;
    });
    report.seconds_draw = seconds_since(start);
    return result;
}

TetsResult render_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view, const Optics& optics,
                       const TetsOptions& options) {
    check_samples(options.samples);
    return TetsRenderer(mesh, scalar, options.progress).draw(view, optics, options);
}

}  // namespace subvol
