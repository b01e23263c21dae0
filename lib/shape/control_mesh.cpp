// SPDX-License-Identifier: Apache-2.0
#include "subvol/control_mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "castle.h"
#include "layers.h"
#include "shape_fitter.h"
#include "sharp_paths.h"
#include "subvol/cell.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kStraight = 180;

Box box_of(const Surface& surface) {
    Box box;
    for (const auto& t : surface.triangles) {
        for (const Index p : t) box.add(surface.points[p]);
    }
    return box;
}

/// Cubes inside the surface. added: gets how many more were needed
HexMesh cubes_inside(const Surface& surface, const ControlMeshOptions& options, double side, std::size_t& added) {
    const Box box = box_of(surface);
    const Vec3 counts = box.size() / side + 3.0;
    constexpr double kEmpty = 64;  // cubes of the grid for each of the mesh
    if (counts.x * counts.y * counts.z > kEmpty * static_cast<double>(options.max_cells)) {
        throw Error(ErrorCode::InvalidInput, "the grid would have too many cubes", option_name("cells", options.names),
                    "fewer cells");
    }
    CubeGrid grid(box, side);
    const SurfaceTree tree(surface);
    std::vector<float> likeness(grid.size());
    parallel_each(grid.size(),
                  [&](std::size_t c) { likeness[c] = static_cast<float>(std::abs(tree.winding(grid.center(c)))); });
    grid.choose(std::move(likeness));
    const auto count = [&] { return static_cast<std::size_t>(std::ranges::count(grid.chosen(), 1)); };
    const std::size_t before = count();
    if (before == 0) {
        throw Error(ErrorCode::InvalidInput, "no cell has its middle inside the surface", "surface",
                    "a closed surface, and more cells if it is thin");
    }
    grid.make_manifold();
    added = count() - before;
    if (before + added > options.max_cells) {
        throw Error(ErrorCode::InvalidInput, "there would be " + std::to_string(before + added) + " cells",
                    option_name("cells", options.names), "fewer cells, or more with --max-cells");
    }
    return grid.cells();
}

std::size_t parts_of(const HexMesh& mesh) {
    DisjointSets joined(mesh.points.size());
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) joined.join(cell[0], p);
    }
    std::size_t parts = 0;
    for (Index p = 0; p < mesh.points.size(); ++p) parts += joined.least(p) == p ? 1 : 0;
    return parts;
}

/// What is known of sharp edges.
SharpEdgeReport report_of(const SharpEdges& sharp, const SharpPaths& paths, const std::array<double, 2>& error) {
    SharpEdgeReport report;
    report.curves = sharp.curves.size();
    report.missed = paths.missed.size();
    for (const SharpCurve& curve : sharp.curves) report.length_world += curve.length();
    for (const Index k : paths.missed) report.missed_length_world += sharp.curves[k].length();
    report.creases = paths.creases.size();
    report.rms = error[0];
    report.max = error[1];
    return report;
}

}  // namespace

std::vector<Option> options_of(ControlMeshOptions& options) {
    std::vector<Option> all{
        Option("cells", options.cells).between(2, 1000).help("N", "cells along the longest side of the surface's box"),
        Option("max-cells", options.max_cells).between(1, 1'000'000'000).help("N", "the most cells that may be made"),
        Option("rounds", options.rounds)
            .between(1, 100)
            .help("N", "how often the points are drawn to the nearest places of the surface"),
        Option("sharp-angle", options.sharp_angle_deg)
            .between(1, kStraight)
            .help("DEG", "edges of the surface that are bent by more become creases of the mesh (180: none)")};
    std::ranges::move(options_of(options.folds), std::back_inserter(all));
    return all;
}

Facts facts_of(const ControlMeshReport& report) {
    Facts facts = facts_of(report.shape);
    facts["parts"] = report.parts;
    facts["added"] = report.added;
    facts["side_world"] = report.side_world;
    Facts& sharp = facts.group("sharp");
    sharp["curves"] = report.sharp.curves;
    sharp["missed"] = report.sharp.missed;
    sharp["length_world"] = report.sharp.length_world;
    sharp["missed_length_world"] = report.sharp.missed_length_world;
    sharp["creases"] = report.sharp.creases;
    sharp["rms"] = report.sharp.rms;
    sharp["max"] = report.sharp.max;
    facts["min_scaled_jacobian"] = report.min_scaled_jacobian;
    return facts;
}

ControlMesh control_mesh_of(const Surface& surface, const ControlMeshOptions& given) {
    ControlMeshOptions options = given;
    check_options(options);
    check_options(options.scheme);
    if (options.scheme.crease_angle_deg) {
        throw Error(ErrorCode::InvalidInput, "has no effect: sharp edges of the surface become creases",
                    option_name("crease-angle", options.names),
                    option_name("sharp-angle", options.names) + " for other angles");
    }
    validate(surface);
    const Vec3 size = box_of(surface).size();
    ControlMeshReport report;
    report.side_world = std::max({size.x, size.y, size.z}) / options.cells;
    constexpr double kSmallest = 1e-60, kLargest = 1e60;  // so that powers of it are numbers
    if (!(report.side_world > kSmallest && report.side_world < kLargest)) {
        throw Error(
            ErrorCode::InvalidInput,
            "the surface has no size that can be worked with: a cell would have the side " + number_text(report.side_world),
            "surface", "1e-60 to 1e60");
    }
    const HexMesh cubes = cubes_inside(surface, options, report.side_world, report.added);
    HexMesh mesh = with_layer(cubes);
    report.parts = parts_of(mesh);
    report.shape.before = shape_error(mesh, surface, options.scheme);
    std::vector<Vec3> start = mesh.points;
    const SharpEdges sharp =
        options.sharp_angle_deg < kStraight ? sharp_edges(surface, options.sharp_angle_deg, report.side_world) : SharpEdges{};
    SharpPaths paths;
    const auto rounds_of = [&](Scheme kind, int first, int end) {
        SchemeOptions scheme = options.scheme;
        scheme.kind = kind;
        ShapeFitter fitter(build_topology(mesh), surface, scheme);
        fitter.follow(sharp, paths);
        // With layers there are more cells than cubes in the same volume: larger ones would press the boundary outwards.
        const double side =
            report.side_world * std::cbrt(static_cast<double>(cubes.cells.size()) / static_cast<double>(mesh.cells.size()));
        for (int round = first; round < end; ++round) {
            report_progress(options.progress, "shape", static_cast<double>(round) / options.rounds);
            constexpr double kMore = 1.5;
            mesh.points = fitter.relaxed(mesh.points, side, std::pow(kMore, round));
        }
        report.shape.rounds += end - first;
        return fitter.sharp_error(mesh.points);
    };
    // The first rounds have control cells, as the limit of cubes is none of the surface's.
    const int half = options.rounds / 2;
    rounds_of(Scheme::Linear, 0, half);
    if (!sharp.curves.empty()) paths = sharp_paths(mesh, sharp, report.side_world);
    if (!paths.creases.empty()) {
        std::vector<std::array<Index, 2>> along = paths.creases;
        along.insert(along.end(), paths.cuts.begin(), paths.cuts.end());
        mesh = with_layer_along(mesh, along);
        mesh.creases = paths.creases;
        start = mesh.points;
        rounds_of(Scheme::Linear, half / 2, half);
    }
    const auto sharp_error = rounds_of(options.scheme.kind, half, options.rounds);
    report.sharp = report_of(sharp, paths, sharp_error);
    FitShapeOptions ending;
    ending.scheme = options.scheme;
    ending.folds = options.folds;
    ending.progress = options.progress;
    mesh = finished(std::move(mesh), surface, ending, report.shape);
    for (std::size_t p = 0; p < start.size(); ++p) {
        report.shape.moved_world = std::max(report.shape.moved_world, glm::distance(start[p], mesh.points[p]));
    }
    report.min_scaled_jacobian = measure_cells(mesh).min_scaled_jacobian;
    return {std::move(mesh), std::move(report)};
}

}  // namespace subvol
