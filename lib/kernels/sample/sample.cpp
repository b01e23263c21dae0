// SPDX-License-Identifier: Apache-2.0
// Samples a subdivision volume into kernels. There are two ways to the points:
//
//     one power of two of intervals for all edges,   the mesh is refined so often; its points, on the limit, are the samples
//     and values of the scheme
//     anything else                                  intervals for each edge, or as many as a tolerance needs; samples are
//                                                    evaluated in blocks of cells
//
// With one kernel for each control point the samples need no refinement, and the topology is built part by part to save memory.
// Gradients and frames of the first way come from the lines of the mesh through each point. The boundary surface is refined for
// itself, by default to quads of half a sample interval, or coarser ones if there would be too many triangles.
//
// A piece of a mesh with enough layers of halo gives its own points the same bits as the whole mesh does. For meshes that
// differ in their points alone, lines and tables of the boundary are made once and applied to each.
#include "subvol/sample.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <type_traits>

#include "sample_ways.h"
#include "subvol/boundary_values.h"
#include "subvol/detail/boundary_level.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/points_range.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/option.h"
#include "subvol/sample_pieces.h"
#include "subvol/sample_tables.h"

namespace subvol {

namespace {

constexpr int kMostBoundaryLevels = 6;
constexpr int kMostDefaultBoundaryLevels = 4;

void check(const SampleOptions& options) {
    check_options(options);
    if (options.footprint && !(options.footprint->spacing_px > 0 && std::isfinite(options.footprint->spacing_px) &&
                               options.footprint->least_cell_px >= 0 && std::isfinite(options.footprint->least_cell_px))) {
        throw Error(ErrorCode::InvalidInput, "the footprint's spacing is not a positive number of pixels");
    }
    validate(options.kernel);
    validate(options.value_kernel);
    if (!is_radial(options.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial: frames define no axes for it", {}, "a radial kernel");
    }
    const double radius = support_radius(options.kernel);
    if (!(radius >= 1.2 && radius <= 4)) {
        throw Error(ErrorCode::InvalidInput, "the kernel radius is " + detail::number_text(radius), {},
                    "1.2 to 4 sample intervals: smaller kernels leave holes");
    }
}

/// Creases have been tagged.
RefineOptions refinement(const SampleOptions& options, int levels) {
    SchemeOptions scheme = options.scheme;
    scheme.crease_angle_deg.reset();
    return {.scheme = scheme, .levels = levels, .progress = options.progress};
}

/// The level whose points are exactly the samples, if there is one.
std::optional<int> level_of_samples(const SampleOptions& options) {
    const auto intervals = static_cast<unsigned>(options.per_edge);
    const bool graded = options.spacing_world > 0 || options.footprint || options.tolerance > 0 || options.centers;
    if (graded || options.values != ValueRule::Scheme || !std::has_single_bit(intervals)) return std::nullopt;
    return std::countr_zero(intervals);
}

std::size_t hull_triangles(const Topology& topology) {
    std::size_t quads = 0;
    for (Index f = 0; f < topology.faces.size(); ++f) quads += topology.face_on_hull(f) ? 1 : 0;
    return 2 * quads;
}

/// A closed surface of quads has about as many points as quads.
std::size_t hull_triangles(const std::vector<std::uint8_t>& on_hull) {
    return 2 * static_cast<std::size_t>(std::ranges::count_if(on_hull, [](std::uint8_t on) { return on != 0; }));
}

/// known:     the control mesh's topology, or a flag for each of its points: whether it is on the hull
/// intervals: of an edge
template <class Known>
Surface boundary_of(const HexMesh& control, const Known& known, int intervals, const SampleOptions& options) {
    const auto half_an_interval = static_cast<int>(std::bit_width(static_cast<unsigned>(intervals)));
    const int fine = std::min(half_an_interval, kMostDefaultBoundaryLevels);
    const int levels =
        options.boundary_levels ? *options.boundary_levels : detail::sensible_levels(hull_triangles(known), fine);
    const RefineOptions refine_options = refinement(options, levels);
    if (levels == 1 && interpolates(options.scheme.kind)) return detail::boundary_of_child(control, known, options.scheme);
    if constexpr (std::is_same_v<Known, Topology>) {
        return detail::boundary_at_level(control, refine_options);
    } else {
        return detail::boundary_at_level(control, known, refine_options);
    }
}

void count_entities(SampleReport& report, const Topology& topology, std::size_t n) {
    report.at_vertices = topology.point_count;
    report.on_edges = topology.edges.size() * (n - 1);
    report.on_faces = topology.faces.size() * (n - 1) * (n - 1);
    report.in_cells = topology.cells.size() * (n - 1) * (n - 1) * (n - 1);
}

/// A mesh whose points are the samples.
struct SampledLevel {
    HexMesh mesh;
    detail::PointLines lines;
    Surface boundary;
    SampleReport counts;
};

void mark_hull(const detail::MeshPart& part, std::vector<std::uint8_t>& on_hull) {
    const Topology& topology = part.topology;
    detail::parallel_each(topology.faces.size(), [&](std::size_t f) {
        if (!topology.face_on_hull(static_cast<Index>(f))) return;
        for (const Index p : topology.faces[f]) {
            if (part.own[p]) std::atomic_ref(on_hull[part.points[p]]).store(1, std::memory_order_relaxed);
        }
    });
}

/// The samples are the control points. The topology is built part by part, to save memory.
SampledLevel control_level(HexMesh control, const SampleOptions& options, bool with_boundary = true) {
    const std::size_t points = control.points.size();
    detail::LinesOfParts lines(points);
    std::vector<std::uint8_t> on_hull(points);
    detail::each_part(control, [&](const detail::MeshPart& part) {
        lines.add(part);
        mark_hull(part, on_hull);
    });
    SampledLevel level;
    level.lines = lines.finish();
    if (with_boundary) level.boundary = boundary_of(control, on_hull, options.per_edge, options);
    level.counts.at_vertices = points;
    level.mesh = std::move(control);
    return level;
}

SampledLevel refined_level(HexMesh control, int number, const SampleOptions& options) {
    Topology topology = build_topology(control);
    SampledLevel level;
    level.boundary = boundary_of(control, topology, options.per_edge, options);
    count_entities(level.counts, topology, static_cast<std::size_t>(options.per_edge));
    detail::RefinedPoints refined = detail::refine_points(std::move(control), std::move(topology), refinement(options, number));
    level.lines = detail::lines_of_child(refined.parent);
    level.mesh = std::move(refined.mesh);
    if (!interpolates(options.scheme.kind)) level.mesh.cells = detail::child_cells(refined.parent);
    return level;
}

SampleResult sample_level(HexMesh control, int number, const SampleOptions& options) {
    report_progress(options.progress, "topology", 0);
    // Bricks know the box of the control points, not that of their limit.
    std::optional<double> diagonal;
    if (number == 0) diagonal = bounds(control).diagonal();
    SampledLevel level =
        number == 0 ? control_level(std::move(control), options) : refined_level(std::move(control), number, options);
    if (!interpolates(options.scheme.kind)) level.mesh = on_limit(std::move(level.mesh), options.scheme.kind);
    level.mesh.cells = std::vector<std::array<Index, 8>>();
    SampleResult result =
        detail::sample_at_points(std::move(level.mesh), level.lines, options.scheme.kind != Scheme::Linear, options, diagonal);
    result.volume.boundary = std::move(level.boundary);
    level.counts.points = result.report.points;
    level.counts.flat_frames = result.report.flat_frames;
    result.report = level.counts;
    return result;
}

/// The intervals that set the level of the boundary where they differ: the root of their mean square over the hull's edges. The
/// most of any edge would make millions of triangles for a few long cells among many.
int intervals_of_hull(const Topology& topology, const std::vector<int>& intervals) {
    double squares = 0, edges = 0;
    for (Index f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(f)) continue;
        for (const Index e : topology.face_edges[f]) {
            squares += double(intervals[e]) * double(intervals[e]);
            ++edges;
        }
    }
    constexpr double kSlack = 1e-9;  // of a root that is whole
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(squares / std::max(edges, 1.0)) - kSlack)));
}

/// Samples at counts that differ from edge to edge, or with values that are not the scheme's.
SampleResult sample_graded(const HexMesh& control, const SampleOptions& options) {
    report_progress(options.progress, "topology", 0);
    const Topology topology = build_topology(control);
    report_progress(options.progress, "topology", 1);
    const detail::CellBlocks blocks(control, refinement(options, 2).scheme, options.progress);
    SampleResult result;
    int on_hull = 1;
    if (options.tolerance > 0) {
        result = detail::sample_to_tolerance(control, blocks, topology, options);
    } else {
        std::vector<int> intervals = detail::edge_intervals(control, topology, options);
        on_hull = intervals_of_hull(topology, intervals);
        result = detail::sample_in_cells(control, blocks, topology, std::move(intervals), options);
    }
    result.volume.boundary = boundary_of(control, topology, on_hull, options);
    return result;
}

Box bounds_of(const RbfVolume& volume) {
    Box box;
    for (const Vec3& p : volume.centers) box.add(p);
    for (const Vec3& p : volume.boundary.points) box.add(p);
    return box;
}

void check_part(const SampleOptions& options) {
    check(options);
    if (level_of_samples(options) != 0) {
        throw Error(ErrorCode::InvalidInput, "parts of a mesh are sampled at their points only", {}, "--per-edge 1");
    }
}

}  // namespace

// A kernel depends on the cells about its point: with the halo, a piece has them all, in the order of the whole mesh, so its
// own points get the bits that they have there. Other pieces own the halo's points.
PieceKernels sample_piece(const MeshSource& source, MeshPiece piece, const SampleOptions& options) {
    check_halo(source, options);
    check_part(options);
    SampledLevel level = control_level(detail::control_mesh(std::move(piece.mesh), options.scheme), options, false);
    level.mesh = detail::on_limit_of_part(std::move(level.mesh), options.scheme.kind);
    level.mesh.cells = std::vector<std::array<Index, 8>>();
    SampleResult sampled = sample_at_points(std::move(level.mesh), level.lines, options.scheme.kind != Scheme::Linear, options,
                                            source.bounds().diagonal());
    PieceKernels result{std::move(sampled.volume), {}, sampled.report.flat_frames};
    result.volume.bounds = bounds_of(result.volume);
    std::vector<std::size_t> places;
    for (std::size_t p = 0; p < piece.owned_points.size(); ++p) {
        if (!piece.owned_points[p]) continue;
        places.push_back(p);
        result.numbers.push_back(piece.point_numbers[p]);
    }
    detail::keep_kernels(result.volume, places);
    return result;
}

Surface sample_boundary(const MeshHull& hull, const SampleOptions& options) {
    check_part(options);
    return boundary_of(detail::control_mesh(hull.mesh, options.scheme), hull.on_hull, options.per_edge, options);
}

void check_halo(const MeshSource& source, const SampleOptions& options) {
    // A derivative at a point takes up to three points ahead on a line: the line through the second of them is known from all
    // its cells. A Hessian takes the gradients of the neighbours too.
    // The limit of a vertex depends on the cells about it: where the scheme does not interpolate, one layer more.
    const int layers = (options.correction == Correction::Full ? 4 : 3) + (interpolates(options.scheme.kind) ? 0 : 1);
    source.check_halo(layers, "these kernels");
}

struct SampleTables::State {
    SampleOptions options;
    detail::PointLines lines;
    BoundaryTables boundary;
};

bool SampleTables::are_for(const SampleOptions& options) {
    return level_of_samples(options) == 0 && interpolates(options.scheme.kind);
}

SampleTables::SampleTables(const HexMesh& mesh, const SampleOptions& options) {
    check(options);
    if (!are_for(options)) {
        throw Error(ErrorCode::InvalidInput, "there are tables for one kernel at each control point only", "per_edge", "1");
    }
    const HexMesh control = detail::control_mesh(HexMesh(mesh), options.scheme);
    detail::LinesOfParts lines(control.points.size());
    detail::each_part(control, [&](const detail::MeshPart& part) { lines.add(part); });
    BoundaryTables boundary(control, refinement(options, options.boundary_levels.value_or(1)));
    state_ = std::make_unique<State>(State{options, lines.finish(), std::move(boundary)});
}

SampleTables::~SampleTables() = default;
SampleTables::SampleTables(SampleTables&&) noexcept = default;
SampleTables& SampleTables::operator=(SampleTables&&) noexcept = default;

SampleResult SampleTables::apply(const HexMesh& mesh) const {
    const State& state = *state_;
    HexMesh points = without_unused_points(HexMesh(mesh));
    Surface boundary = state.boundary.apply(points).surface;
    points.cells = std::vector<std::array<Index, 8>>();
    SampleResult result =
        detail::sample_at_points(std::move(points), state.lines, state.options.scheme.kind != Scheme::Linear, state.options);
    result.volume.boundary = std::move(boundary);
    result.volume.bounds = bounds_of(result.volume);
    result.report.at_vertices = result.report.points;
    return result;
}

SampleResult sample_rbf_points(HexMesh mesh, const SampleOptions& options) {
    check(options);
    HexMesh control = detail::control_mesh(std::move(mesh), options.scheme);
    const auto level = level_of_samples(options);
    SampleResult result = level ? sample_level(std::move(control), *level, options) : sample_graded(control, options);
    result.volume.bounds = bounds_of(result.volume);
    return result;
}

std::vector<Option> options_of(SampleOptions& options) {
    return {
        Option("per-edge", options.per_edge)
            .between(1, 64)
            .help("N", "sample intervals per cell edge; 1 is one kernel per control point"),
        Option("spacing", options.spacing_world)
            .positive()
            .or_none()
            .help(
                "H",
                "distance between samples in world units, instead of --per-edge; for a grid, rounded to whole voxels (default: "
                "one kernel per voxel)")
            .instead_of({"per-edge"}),
        Option("tolerance", options.tolerance)
            .positive()
            .or_none()
            .help("E", "instead: as many samples as an error of the field below E needs, in the field's unit")
            .instead_of({"per-edge", "spacing"}),
        Option("centers", options.centers)
            .help("also a kernel in the middle of each small cell between the samples: twice as many kernels, about a third of "
                  "the error"),
        Option("values", options.values)
            .help("NAME", "values between control points: scheme (exact), cubic (Catmull-Rom), paper (weighted mean)"),
        kernel_option("kernel", options.kernel).help("NAME|JSON", "the kernel of the points; see `subvol fit --kernels`"),
        kernel_option("value-kernel", options.value_kernel)
            .help("NAME|JSON", "the kernel that weighs the values of control points")
            .only_with("values", {"paper"}),
        Option("correction", options.correction)
            .help("NAME", "the derivatives of the field that kernels carry: none, gradient, second, full"),
        Option("boundary-levels", options.boundary_levels)
            .between(0, kMostBoundaryLevels)
            .help("L", "refinements of the boundary surface (default: so that its quads are half a sample interval wide)"),
    };
}

}  // namespace subvol
