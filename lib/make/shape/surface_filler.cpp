// SPDX-License-Identifier: Apache-2.0
#include "surface_filler.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/detail/fold_samples.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/mesh_report.h"

namespace subvol::detail {
namespace {

/// The sides of a mesh's cells, given those of the cells that they lie in, so that the volume remains. They change step by
/// step.
std::vector<double> sides_of(const LayeredMesh& mesh, std::span<const double> sides) {
    const auto volume = [](std::span<const double> of) {
        double sum = 0;
        for (const double side : of) sum += side * side * side;
        return sum;
    };
    std::vector<double> made;
    for (const Index parent : mesh.from) made.push_back(sides[parent]);
    if (std::ranges::min(sides) < std::ranges::max(sides)) {
        const Topology topology = build_topology(mesh.mesh);
        constexpr int kTimes = 3;
        for (int k = 0; k < kTimes; ++k) {
            const std::vector<double> before = made;
            for (Index c = 0; c < made.size(); ++c) {
                double sum = std::log(before[c]), count = 1;
                for (const Index f : topology.cell_faces[c]) {
                    if (topology.face_on_hull(f)) continue;
                    const auto [a, b] = topology.face_cells[f];
                    sum += std::log(before[a == c ? b : a]);
                    ++count;
                }
                made[c] = std::exp(sum / count);
            }
        }
    }
    // With layers there are more cells in the same volume: larger ones would press the boundary outwards.
    const double less = std::cbrt(volume(sides) / volume(made));
    for (double& side : made) side *= less;
    return made;
}

/// What is known of sharp edges.
SharpEdgeReport report_of(const SharpEdges& sharp, const SharpPaths& paths, const std::array<double, 2>& error) {
    SharpEdgeReport report;
    report.corners = sharp.corners.size();
    report.missed_corners = sharp.corners.size() - paths.corners.size();
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

void SurfaceFiller::fill(const SizedMesh& inside) {
    put_layers(with_layer_at_walls(inside.mesh, inside.materials), inside.sides, inside.materials);
    paths_ = {};
    report_.shape.before = error_until(mesh_, walls(), options_.scheme, options_.progress);
    report_.shape.rounds = 0;
    // The first rounds have control cells, as the limit of cubes is none of the surface's.
    const int half = options_.rounds / 2;
    draw(Scheme::Linear, 0, half);
    if (!sharp_.curves.empty()) paths_ = sharp_paths(mesh_, sharp_, report_.side_world);
    if (!paths_.creases.empty()) {
        std::vector<std::array<Index, 2>> along = paths_.creases;
        along.insert(along.end(), paths_.cuts.begin(), paths_.cuts.end());
        put_layers(with_layer_along(mesh_, along, materials_), std::vector(aims_.sides), std::vector(materials_));
        mesh_.creases = paths_.creases;
        draw(Scheme::Linear, half / 2, half);
    }
    draw(options_.scheme.kind, half, options_.rounds);
    straighten();
    report_.sharp = report_of(sharp_, paths_, fitter_->sharp_error(mesh_.points));
}

/// sides, materials: of the cells before there were layers
void SurfaceFiller::put_layers(LayeredMesh layered, std::span<const double> sides, std::span<const Index> materials) {
    aims_.sides = sides_of(layered, sides);
    aims_.weights.assign(aims_.sides.size(), 1);
    materials_.clear();
    for (std::size_t c = 0; c < layered.from.size() && !materials.empty(); ++c)
        materials_.push_back(materials[layered.from[c]]);
    mesh_ = std::move(layered.mesh);
    sharpen_walls(mesh_, materials_);
    start_ = mesh_.points;
}

std::vector<Vec3> SurfaceFiller::places_beyond(double far) const {
    std::vector<Vec3> places = fitter_->places_beyond(mesh_.points, far);
    for (const Index k : paths_.missed) {
        const SharpCurve& curve = sharp_.curves[k];
        const double steps = std::ceil(2 * curve.length() / report_.side_world);
        for (double step = 0; step <= steps; ++step) places.push_back(curve.at(step / steps));
    }
    return places;
}

void SurfaceFiller::draw(Scheme kind, int first, int end) {
    SchemeOptions scheme = options_.scheme;
    scheme.kind = kind;
    fitter_.emplace(build_topology(mesh_), walls(), scheme, options_.progress);
    fitter_->follow(sharp_, paths_);
    for (int round = first; round < end; ++round) {
        const double part = static_cast<double>(round) / options_.rounds;
        report_progress(options_.progress, "shape", (report_.refined + part) / (options_.refine + 1));
        relax(round);
    }
}

void SurfaceFiller::relax(int round) {
    constexpr double kMore = 1.5;
    mesh_.points = fitter_->relaxed(mesh_.points, aims_, std::pow(kMore, round));
    ++report_.shape.rounds;
}

/// Cells with flat corners and those whose limit folds or may fold count more, and all points are drawn again, until there
/// are no such cells. Folds are looked for near those that are known, and everywhere if there are none left.
void SurfaceFiller::straighten() {
    constexpr int kTimes = 10, kRounds = 2, kNear = 2;
    constexpr double kMore = 4;
    std::vector<std::uint8_t> near(mesh_.cells.size(), 1);
    for (int k = 0; k < kTimes; ++k) {
        report_progress(options_.progress, "straighten", static_cast<double>(k) / kTimes);
        std::vector<std::uint8_t> bad = bad_cells(near);
        if (std::ranges::count(bad, 1) == 0 && std::ranges::count(near, 0) > 0) {
            std::ranges::fill(near, 1);
            bad = bad_cells(near);
        }
        if (std::ranges::count(bad, 1) == 0) break;
        for (std::size_t c = 0; c < bad.size(); ++c) {
            if (bad[c] != 0) aims_.weights[c] *= kMore;
        }
        for (int round = 0; round < kRounds; ++round) relax(options_.rounds - 1);
        near = std::move(bad);
        grow(mesh_, near, kNear);
    }
    report_progress(options_.progress, "straighten", 1);  // ends what was cancelled
}

/// Flags for the cells that have flat corners, and those of the near ones whose limit folds or may fold.
std::vector<std::uint8_t> SurfaceFiller::bad_cells(const std::vector<std::uint8_t>& near) const {
    std::vector<std::uint8_t> sharp(mesh_.points.size(), 0);
    for (const auto& crease : mesh_.creases) {
        for (const Index p : crease) sharp[p] = 1;
    }
    std::vector<std::uint8_t> bad(mesh_.cells.size());
    parallel_each(bad.size(), [&](std::size_t c) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh_.points[mesh_.cells[c][k]];
        // The angle of a sharp edge may be acute, and would be rounded.
        constexpr double kFlatCorner = 0.3, kFlatAtCrease = 0.05;
        const bool at_crease = std::ranges::any_of(mesh_.cells[c], [&](Index p) { return sharp[p] != 0; });
        bad[c] = min_scaled_jacobian(corners) < (at_crease ? kFlatAtCrease : kFlatCorner) ? 1 : 0;
    });
    if (options_.folds.keep) return bad;
    FoldOptions folds;
    folds.scheme = options_.scheme;
    folds.progress = options_.progress;
    std::vector<Index> cells;
    for (Index c = 0; c < near.size(); ++c) {
        if (near[c] != 0) cells.push_back(c);
    }
    const std::vector<FoldVerdict> verdicts = fold_verdicts(mesh_, cells, folds);
    for (std::size_t k = 0; k < cells.size(); ++k) {
        if (verdicts[k] == FoldVerdict::Folded || verdicts[k] == FoldVerdict::Open) bad[cells[k]] = 1;
    }
    return bad;
}

}  // namespace subvol::detail
