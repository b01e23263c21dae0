#include "subvol/sample.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "boundary_surface.h"
#include "child_cells.h"
#include "last_level.h"
#include "sample_cells.h"
#include "sample_counts.h"
#include "sample_points.h"
#include "sample_tolerance.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

constexpr int kMostBoundaryLevels = 6;
constexpr int kMostDefaultBoundaryLevels = 4;

void check(const SampleOptions& options) {
    if (options.per_edge < 1 || options.per_edge > 64) {
        throw Error(ErrorCode::InvalidInput, "sample intervals per edge: " + std::to_string(options.per_edge), {}, "1 to 64");
    }
    if (!(options.spacing_world >= 0 && std::isfinite(options.spacing_world))) {
        throw Error(ErrorCode::InvalidInput, "the spacing is " + std::to_string(options.spacing_world), {},
                    "a positive length");
    }
    if (!(options.tolerance >= 0 && std::isfinite(options.tolerance))) {
        throw Error(ErrorCode::InvalidInput, "the tolerance is " + std::to_string(options.tolerance), {}, "a positive number");
    }
    if (options.footprint && !(options.footprint->spacing_px > 0 && options.footprint->least_cell_px >= 0)) {
        throw Error(ErrorCode::InvalidInput, "the footprint's spacing is not positive");
    }
    validate(options.kernel);
    validate(options.value_kernel);
    if (!is_radial(options.kernel)) {
        throw Error(ErrorCode::InvalidInput, "points need a radial kernel: their frames have no axes");
    }
    const double radius = support_radius(options.kernel);
    if (!(radius >= 1.2 && radius <= 4)) {
        throw Error(ErrorCode::InvalidInput, "the kernel radius is " + std::to_string(radius), {},
                    "1.2 to 4 sample intervals: smaller kernels leave holes");
    }
    const int boundary_levels = options.boundary_levels.value_or(0);
    if (boundary_levels < 0 || boundary_levels > kMostBoundaryLevels) {
        throw Error(ErrorCode::InvalidInput, "boundary levels: " + std::to_string(boundary_levels), {}, "0 to 6");
    }
}

RefineOptions refinement(const SampleOptions& options, int levels) {
    return {.scheme = options.scheme,
            .levels = levels,
            .tension = options.tension,
            .crease_angle_deg = {},
            .progress = options.progress};
}

/// The level whose points are just the samples, if there is one.
std::optional<int> level_of_samples(const SampleOptions& options) {
    const auto intervals = static_cast<unsigned>(options.per_edge);
    const bool graded = options.spacing_world > 0 || options.footprint || options.tolerance > 0;
    if (graded || options.values != ValueRule::Scheme || !std::has_single_bit(intervals)) return std::nullopt;
    return std::countr_zero(intervals);
}

/// intervals: the most that an edge has
Surface boundary_of(const HexMesh& control, const Topology& topology, int intervals, const SampleOptions& options) {
    const auto half_an_interval = static_cast<int>(std::bit_width(static_cast<unsigned>(intervals)));
    const int levels = options.boundary_levels.value_or(std::min(half_an_interval, kMostDefaultBoundaryLevels));
    const RefineOptions refine_options = refinement(options, levels);
    if (levels == 1 && interpolates(options.scheme)) return detail::boundary_of_child(control, topology, refine_options);
    return detail::boundary_at_level(control, refine_options);
}

void count_entities(SampleReport& report, const Topology& topology, std::size_t n) {
    report.at_vertices = topology.point_count;
    report.on_edges = topology.edges.size() * (n - 1);
    report.on_faces = topology.faces.size() * (n - 1) * (n - 1);
    report.in_cells = topology.cells.size() * (n - 1) * (n - 1) * (n - 1);
}

SampleResult sample_level(HexMesh control, int level, const SampleOptions& options) {
    report_progress(options.progress, "topology", 0);
    Topology topology = build_topology(control);
    Surface boundary = boundary_of(control, topology, options.per_edge, options);
    SampleReport counts;
    count_entities(counts, topology, static_cast<std::size_t>(options.per_edge));
    detail::PointLines lines;
    if (level == 0) {
        lines = detail::lines_of_mesh(topology);
    } else {
        detail::LastLevel last =
            detail::refine_without_cells(std::move(control), std::move(topology), refinement(options, level));
        lines = detail::lines_of_child(last.parent);
        control = std::move(last.mesh);
        if (!interpolates(options.scheme)) control.cells = detail::child_cells(last.parent);
    }
    if (!interpolates(options.scheme)) control = on_limit(std::move(control), options.scheme);
    SampleResult result = detail::sample_at_points(std::move(control), lines, options.scheme != Scheme::Linear, options);
    result.volume.boundary = std::move(boundary);
    counts.points = result.report.points;
    counts.flat_frames = result.report.flat_frames;
    result.report = counts;
    return result;
}

SampleResult sample_cells(const HexMesh& control, const SampleOptions& options) {
    const HexMesh once = refine(control, refinement(options, 1));
    const HexMesh twice = on_limit(refine(once, refinement(options, 1)), options.scheme);
    const Topology topology = build_topology(control);
    SampleResult result;
    int most = 1;
    if (options.tolerance > 0) {
        result = detail::sample_to_tolerance(control, twice, topology, options);
    } else {
        std::vector<int> intervals = detail::edge_intervals(control, topology, options);
        most = std::ranges::max(intervals);
        result = detail::sample_in_cells(control, twice, topology, std::move(intervals), options);
    }
    result.volume.boundary = boundary_of(control, topology, most, options);
    return result;
}

Box bounds_of(const RbfVolume& volume) {
    Box box;
    for (const Vec3& p : volume.centers) box.add(p);
    for (const Vec3& p : volume.boundary.points) box.add(p);
    return box;
}

}  // namespace

SampleResult sample_rbf_points(const HexMesh& mesh, const SampleOptions& options) {
    check(options);
    HexMesh control = refine(mesh, refinement(options, 0));
    if (options.crease_angle_deg) tag_creases(control, *options.crease_angle_deg);
    const auto level = level_of_samples(options);
    SampleResult result = level ? sample_level(std::move(control), *level, options) : sample_cells(control, options);
    result.volume.bounds = bounds_of(result.volume);
    return result;
}

}  // namespace subvol
