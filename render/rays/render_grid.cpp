// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_grid.h"

#include <tbb/combinable.h>

#include <cmath>

#include "grid_tracer.h"
#include "pixel_tiles.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"

namespace subvol {

using namespace detail;

namespace {

void check(const Voxels& grid, const GridOptions& options) {
    check_samples(options.samples);
    if (!(options.tolerance > 0 && std::isfinite(options.tolerance))) {
        throw Error(ErrorCode::InvalidInput, "the tolerance is " + number_text(options.tolerance), {}, "a positive number");
    }
    const double volume = glm::determinant(grid.to_world());
    if (volume == 0 || !std::isfinite(volume)) {
        throw Error(ErrorCode::InvalidInput, "the axes of the grid's voxels lie in a plane");
    }
}

// Traces, and adds its counts to the sums when its tile is done.
class CountedTracer {
public:
    CountedTracer(GridTracer tracer, tbb::combinable<GridTraceReport>& sums) : tracer_(std::move(tracer)), sums_(&sums) {}
    CountedTracer(CountedTracer&&) = delete;
    ~CountedTracer() {
        GridTraceReport& sum = sums_->local();
        sum.rays += tracer_.counts().rays;
        sum.cells += tracer_.counts().cells;
        sum.blocks += tracer_.counts().blocks;
    }
    Segment operator()(const Ray& ray) { return tracer_.trace(ray); }

private:
    GridTracer tracer_;
    tbb::combinable<GridTraceReport>* sums_;
};

}  // namespace

GridResult render_grid(const Voxels& grid, const View& view, const Optics& optics, const GridOptions& options) {
    check(grid, options);
    const auto [lower, upper] = grid.range();
    if (lower[0] > upper[0]) return {{view.width(), view.height()}, {}};
    GridResult result;
    const Stopwatch watch;
    Box box;
    for (unsigned k = 0; k < 8; ++k) {
        const auto end = [&](std::size_t axis) { return (k >> axis & 1) != 0 ? upper[axis] + 0.5 : lower[axis] - 0.5; };
        box.add(grid.to_world() * Vec3(end(0), end(1), end(2)));
    }
    const RayClip clip(options.clip, box.diagonal());
    tbb::combinable<GridTraceReport> sums;
    result.image = draw_in_tiles(view, options.samples, options.progress,
                                 [&] { return CountedTracer(GridTracer(grid, optics, options.tolerance, clip), sums); });
    sums.combine_each([&](const GridTraceReport& sum) {
        result.report.rays += sum.rays;
        result.report.cells += sum.cells;
        result.report.blocks += sum.blocks;
    });
    result.report.seconds_draw = watch.seconds();
    return result;
}

}  // namespace subvol
