// SPDX-License-Identifier: Apache-2.0
#include "subvol/fit_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "fine_walls.h"
#include "shape_fitter.h"
#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "surface_bodies.h"

// A step looks for the nearest places of the surface and the boundary x = A c, both ways, and finds the ways d of the control
// points c that minimise
//
//     Σ w (n·A d + distance)²  +  part Σ w |A d|²  +  stiffness Σ |dᵢ − dⱼ|²
//
// the last sum over edges, n being the direction of the distance, so that the boundary may slide along the surface but not far.

namespace subvol {

using namespace detail;

namespace {

using Vectors = std::vector<Vec3>;

constexpr double kSliding = 0.01;  // the part

double product_of(const Vectors& a, const Vectors& b) {
    return parallel_sums(1, a.size(), [&](std::size_t i, std::vector<double>& sum) { sum[0] += glm::dot(a[i], b[i]); })[0];
}

constexpr int kDigits = 4;

/// "3, 17, 20 and 1,996 more"
std::string first_of(const std::vector<std::size_t>& cells) {
    constexpr std::size_t kNamed = 10;
    std::string list;
    for (std::size_t k = 0; k < std::min(kNamed, cells.size()); ++k) list += (k > 0 ? ", " : "") + std::to_string(cells[k]);
    if (cells.size() > kNamed) list += " and " + std::to_string(cells.size() - kNamed) + " more";
    return list;
}

void note_folds(const FoldCheck& check, FitShapeReport& report) {
    report.folds = check.report;
    for (const FoldPlace& at : check.places) report.folded_cells.push_back(at.cell);
    if (report.folded_cells.empty()) return;
    const std::size_t sampled = check.report.sampled.folded;
    report.warnings.push_back("the limit folds in " + counted(report.folded_cells.size(), "cell", "cells") + ": " +
                              first_of(report.folded_cells) +
                              (sampled > 0 ? " (" + std::to_string(sampled) + " found to fold by sampling)" : ""));
}

}  // namespace

namespace detail {

ShapeFitter::ShapeFitter(const Topology& control, const WallTargets& walls, const SchemeOptions& scheme,
                         const Progress* progress)
    : cells_(control.cells),
      edges_(control.edges),
      point_edges_(control.point_edges),
      boundary_points_(static_cast<std::size_t>(std::ranges::count(control.point_on_boundary, 1))),
      children_(scheme.kind == Scheme::Linear ? RefinementTables{control.point_count, {}, control.cells, {}, {}}
                                              : refinement_tables(control, {.scheme = scheme, .levels = 1})),
      matrix_(control, walls.materials, scheme),
      progress_(progress) {
    for (std::size_t m = 0; m < matrix_.walls().size(); ++m) {
        distances_.emplace_back(walls.targets[m], matrix_.walls()[m].rows.size(), progress);
    }
}

std::vector<Pull> ShapeFitter::pulls(const Vectors& control) const {
    const Vectors places = matrix_.apply(control);
    std::vector<Pull> made;
    for (std::size_t m = 0; m < distances_.size(); ++m) {
        const WallRows& wall = matrix_.walls()[m];
        if (wall.triangles.empty()) continue;
        const double part = static_cast<double>(wall.rows.size()) / static_cast<double>(matrix_.rows());
        for (Pull& pull : distances_[m].pulls(wall.surface(places), part * static_cast<double>(boundary_points_))) {
            for (Index& point : pull.points) point = wall.rows[point];
            made.push_back(pull);
        }
    }
    constexpr double kSharp = 1;
    std::ranges::move(sharp_.pulls(places, kSharp), std::back_inserter(made));
    return made;
}

Vectors ShapeFitter::solved(const std::vector<Pull>& pulls, double stiffness) const {
    const std::size_t fine = matrix_.rows();
    const auto applied = [&](const Vectors& d) {
        const Vectors moved = matrix_.apply(d);
        Vectors sums = gathered(pulls, [&](const Pull& pull) {
            const Vec3 way = pull.sum_of(moved);
            return pull.weight * (glm::dot(pull.direction, way) * pull.direction + kSliding * way);
        });
        parallel_each(sums.size(), [&](std::size_t p) {
            for (const Index e : point_edges_[static_cast<Index>(p)]) {
                const auto [a, b] = edges_[e];
                sums[p] += stiffness * (d[p] - d[a == p ? b : a]);
            }
        });
        return sums;
    };
    const std::vector<double> squares =
        matrix_.squares(std::vector<double>(fine, static_cast<double>(boundary_points_) / static_cast<double>(pulls.size())));
    std::vector<double> diagonal(squares.size());
    parallel_each(diagonal.size(), [&](std::size_t p) {
        const auto degree = static_cast<double>(point_edges_[static_cast<Index>(p)].size());
        diagonal[p] = squares[p] + stiffness * degree;
        if (!(diagonal[p] > 0)) diagonal[p] = 1;
    });

    Vectors rest = gathered(pulls, [](const Pull& pull) { return -pull.weight * pull.distance * pull.direction; });
    Vectors found(rest.size(), Vec3(0.0));
    constexpr int kSteps = 300;
    constexpr double kEnough = 1e-8;
    double enough = 0;
    conjugate_gradients(
        found, rest,
        [&](Vectors& eased) {
            parallel_each(eased.size(), [&](std::size_t p) { eased[p] = rest[p] / diagonal[p]; });
            return product_of(rest, eased);
        },
        [&](const Vectors& way, Vectors& image) { image = applied(way); }, product_of,
        [&](int step, double left) {
            if (step == 0) enough = kEnough * left;
            return step < kSteps && left > enough && !is_cancelled(progress_);
        });
    return found;
}

Vectors ShapeFitter::step(const Vectors& control, double stiffness) const {
    Vectors ways = solved(pulls(control), stiffness);
    keep_sound(control, ways);
    for (std::size_t p = 0; p < ways.size(); ++p) ways[p] += control[p];
    return ways;
}

// Points of cells that would become too bad go a part of the way only, those of the worst ones not at all.
void ShapeFitter::keep_sound(const Vectors& control, Vectors& ways) const {
    const auto quality = [&](std::size_t c, const auto& position) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = position(cells_[c][k]);
        return min_scaled_jacobian(corners);
    };
    std::vector<double> least(cells_.size());
    parallel_each(cells_.size(), [&](std::size_t c) {
        constexpr double kSound = 0.2, kPart = 0.98;
        const double now = quality(c, [&](Index p) { return control[p]; });
        least[c] = now > 0 ? std::min(kSound, kPart * now) : now;
    });
    std::vector<double> parts(control.size(), 1.0);
    constexpr int kTries = 12;
    constexpr double kLess = 0.6;
    for (int k = 0; k < kTries; ++k) {
        std::vector<std::uint8_t> bad(cells_.size());
        parallel_each(cells_.size(), [&](std::size_t c) {
            bad[c] = quality(c, [&](Index p) { return control[p] + parts[p] * ways[p]; }) < least[c] ? 1 : 0;
        });
        std::vector<std::uint8_t> slower(control.size(), 0);
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            if (bad[c] == 0) continue;
            for (const Index p : cells_[c]) slower[p] = 1;
        }
        bool any = false;
        for (std::size_t p = 0; p < slower.size(); ++p) {
            if (slower[p] == 0) continue;
            any = true;
            parts[p] = k + 1 == kTries ? 0 : kLess * parts[p];
        }
        if (!any) break;
    }
    for (std::size_t p = 0; p < ways.size(); ++p) ways[p] *= parts[p];
}

ShapeError ShapeFitter::error(const Vectors& control) const {
    const Vectors places = matrix_.apply(control);
    DistanceSums sums;
    for (std::size_t m = 0; m < distances_.size(); ++m) {
        const WallRows& wall = matrix_.walls()[m];
        if (!wall.triangles.empty()) distances_[m].add_errors(wall.surface(places), sums);
    }
    return sums.result();
}

Vectors ShapeFitter::places_beyond(const Vectors& control, double far) const {
    const Vectors places = matrix_.apply(control);
    Vectors beyond;
    for (std::size_t m = 0; m < distances_.size(); ++m) {
        const WallRows& wall = matrix_.walls()[m];
        if (!wall.triangles.empty()) {
            std::ranges::move(distances_[m].places_beyond(wall.surface(places), far), std::back_inserter(beyond));
        }
    }
    return beyond;
}

FinishedShape finished(HexMesh mesh, const WallTargets& walls, const FitShapeOptions& options, FitShapeReport& report) {
    FinishedShape made;
    FoldOptions folds;
    folds.scheme = options.scheme;
    folds.progress = options.progress;
    if (!options.folds.keep) {
        MendOptions mending;
        mending.folds = folds;
        mending.boundary_edges = options.folds.boundary_edges;
        Mended mended = mend_folds(std::move(mesh), mending);
        report.folds = mended.check.report;
        report.mended = mended.report.before.folded + mended.report.before.open;
        if (mended.report.work >= mended.report.budget && !mended.report.left.empty()) {
            report.warnings.push_back("mending ended with " + counted(mended.report.left.size(), "bad cell", "bad cells") +
                                      ", as its budget of " + std::to_string(mended.report.budget) + " tests was used up");
        }
        note_folds(mended.check, report);
        mesh = std::move(mended.mesh);
    } else {
        note_folds(check_folds(mesh, folds), report);
    }
    report.inverted_cells = inverted_cells(mesh, mesh.cells.size());
    if (!report.inverted_cells.empty()) {
        report.warnings.push_back(counted(report.inverted_cells.size(), "control cell is", "control cells are") +
                                  " turned inside out at a corner: " + first_of(report.inverted_cells));
    }
    const std::vector<FineWalls> fine = fine_walls(mesh, walls.materials, options.scheme);
    report.after = error_of(fine, walls, options.progress);
    report.volume_world = 0;
    for (const FineWalls& wall : fine) {
        made.volumes.push_back(wall.closed.triangles.empty() ? 0 : enclosed_volume(wall.closed));
        report.volume_world += made.volumes.back();
    }
    made.lids = lids_of(fine, walls);
    OpenEdges open;
    for (const WallTarget& target : walls.targets) {
        const OpenEdges own = open_edges(*target.surface);
        open.count += own.count;
        open.length_world += own.length_world;
    }
    report.open_edges = open.count;
    report.open_length_world = open.length_world;
    if (report.after.hole_part > 0) {
        report.warnings.push_back("the surface is open: " + counted(open.count, "edge belongs", "edges belong") +
                                  " to one triangle alone, of the length " + number_text(open.length_world, kDigits) +
                                  "; the mesh spans holes freely: " + number_text(100 * report.after.hole_part, 2) +
                                  " % of its boundary is over them, at most " + number_text(report.after.max, kDigits) +
                                  " from the surface, the rest at most " + number_text(report.after.covered_max, kDigits));
    } else if (open.count > 0) {
        report.warnings.push_back("the surface is open: " + counted(open.count, "edge belongs", "edges belong") +
                                  " to one triangle alone, of the length " + number_text(open.length_world, kDigits));
    }
    report_progress(options.progress, "fit shape", 1);  // ends what was cancelled
    made.mesh = std::move(mesh);
    return made;
}

ShapeError error_until(const HexMesh& mesh, const WallTargets& walls, const SchemeOptions& scheme, const Progress* progress) {
    return error_of(fine_walls(mesh, walls.materials, scheme), walls, progress);
}

}  // namespace detail

void validate(const Surface& surface) {
    if (surface.triangles.empty()) throw Error(ErrorCode::InvalidInput, "the surface has no triangles", "surface");
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (const Index p : surface.triangles[t]) {
            if (p >= surface.points.size()) {
                throw Error(ErrorCode::InvalidInput, "triangle " + std::to_string(t) + " has the corner " + std::to_string(p),
                            "surface", "below " + std::to_string(surface.points.size()));
            }
            const Vec3& x = surface.points[p];
            if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) {
                throw Error(ErrorCode::InvalidInput, "point " + std::to_string(p) + " is not finite", "surface");
            }
        }
    }
}

std::vector<Option> options_of(ShapeFolds& folds) {
    return {Option("keep-folds", folds.keep).help("leave the points where they are if the limit folds"),
            Option("boundary-move", folds.boundary_edges)
                .between(0, 10)
                .not_with("keep-folds")
                .help("PART", "points of the boundary may move by this part of their shortest edge where the limit folds")};
}

std::vector<Option> options_of(FitShapeOptions& options) {
    std::vector<Option> all{Option("shape-rounds", options.rounds)
                                .between(1, 1000)
                                .help("N", "look for the nearest places and move the points up to N times"),
                            Option("stiffness", options.stiffness)
                                .between(1e-6, 1e6)
                                .help("S", "how much neighbours move together: more for surfaces with noise")};
    std::ranges::move(options_of(options.folds), std::back_inserter(all));
    return all;
}

Facts facts_of(const FitShapeReport& report) {
    Facts facts;
    const auto put = [&](const std::string& name, const ShapeError& error) {
        Facts& group = facts.group(name);
        group["rms"] = error.rms;
        group["max"] = error.max;
        group["max_at"] = std::array{error.max_at.x, error.max_at.y, error.max_at.z};
        group["covered_rms"] = error.covered_rms;
        group["covered_max"] = error.covered_max;
        group["hole_part"] = error.hole_part;
        group["reached_part"] = error.reached_part;
        group["missed_rms"] = error.missed_rms;
        group["missed_max"] = error.missed_max;
        group["missed_at"] = std::array{error.missed_at.x, error.missed_at.y, error.missed_at.z};
    };
    facts["open_edges"] = report.open_edges;
    facts["open_length"] = report.open_length_world;
    put("before", report.before);
    put("after", report.after);
    facts["rounds"] = report.rounds;
    facts["moved_world"] = report.moved_world;
    facts["volume_world"] = report.volume_world;
    facts["folds"] = facts_of(report.folds);
    facts["mended"] = report.mended;
    facts["folded_cells"] = report.folded_cells;
    facts["inverted_cells"] = report.inverted_cells;
    for (const std::string& warning : report.warnings) facts.warn(warning);
    return facts;
}

ShapeError shape_error(const HexMesh& mesh, const Surface& surface, const SchemeOptions& scheme) {
    validate(mesh);
    validate(surface);
    const WallTarget target{&surface};
    return error_until(mesh, {{}, {&target, 1}}, scheme, nullptr);
}

ShapedMesh fit_shape(HexMesh mesh, const Surface& surface, const FitShapeOptions& given) {
    FitShapeOptions options = given;
    check_options(options);
    check_options(options.scheme);
    validate(mesh);
    validate(surface);
    if (options.scheme.crease_angle_deg) tag_creases(mesh, *options.scheme.crease_angle_deg);
    options.scheme.crease_angle_deg.reset();
    FitShapeReport report;
    const WallTarget target{&surface};
    const WallTargets walls{{}, {&target, 1}};
    report.before = error_until(mesh, walls, options.scheme, options.progress);
    report_progress(options.progress, "fit shape", 0);  // ends what was cancelled
    const ShapeFitter fitter(build_topology(mesh), walls, options.scheme, options.progress);
    const std::vector<Vec3> start = mesh.points;
    double best = std::numeric_limits<double>::infinity();
    for (int round = 0; round < options.rounds; ++round) {
        report_progress(options.progress, "fit shape", static_cast<double>(round) / options.rounds);
        std::vector<Vec3> points = fitter.step(mesh.points, options.stiffness);
        const ShapeError error = fitter.error(points);
        const double sum = error.covered_rms * error.covered_rms + error.missed_rms * error.missed_rms;
        constexpr double kProgress = 0.999;
        if (!(sum < kProgress * best)) break;
        best = sum;
        mesh.points = std::move(points);
        ++report.rounds;
    }
    mesh = finished(std::move(mesh), walls, options, report).mesh;
    for (std::size_t p = 0; p < start.size(); ++p) {
        report.moved_world = std::max(report.moved_world, glm::distance(start[p], mesh.points[p]));
    }
    return {std::move(mesh), report};
}

}  // namespace subvol
