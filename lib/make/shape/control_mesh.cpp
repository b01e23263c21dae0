// SPDX-License-Identifier: Apache-2.0
// A mesh of hexahedra for what a surface of triangles encloses.
//
//     surface ──► bodies: what is inside of it ──► chains of sharp edges
//     ┌► cubes of a grid, some divided into 27 parts ──► those with their middles inside, and more until their boundary is
//     │  a surface ──► a layer of cells around them
//     │  rounds with straight cells: the boundary is drawn to the surface, more each time
//     │  paths of edges for the sharp chains ──► creases, with a layer of cells along them ──► more of these rounds
//     │  rounds with the limit of the scheme
//     │  more of these, in which cells with flat corners and those whose limit folds count more
//     └─ cubes are divided where the surface or a sharp chain is still too far away, as often as allowed
//     folds are mended and the report is made
//
// The first rounds have straight cells, as the limit of cubes is not like the surface. Each cell has a side that it should
// have; layers make all of them smaller, so that the volume remains. Surfaces without volume, or too far from the origin for
// the digits of their coordinates, are refused, as is a grid with too many cubes.
#include "subvol/control_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "cells_inside.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "surface_bodies.h"
#include "surface_filler.h"
#include "thin_parts.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kStraight = 180;
constexpr double kMuch = 0.02;  // of the volume

/// What is odd about a surface, and what was done about it.
void warn_of(const EnclosureReport& found, std::vector<std::string>& warnings) {
    const auto warn = [&](std::size_t count, const char* one, const char* many, const std::string& rest) {
        if (count > 0) warnings.push_back(counted(count, one, many) + rest);
    };
    warn(found.united, "part of the surface crosses", "parts of the surface cross", " others: the mesh is that of their union");
    warn(found.cavities_alike, "inner part of the surface has", "inner parts of the surface have",
         " the orientation of the outer one: taken as the walls of cavities");
    warn(found.copies, "triangle is", "triangles are", " there twice; copies are left out");
    warn(found.sheets, "triangle is", "triangles are", " in sheets that enclose nothing, which are left out");
    warn(found.turned, "triangle has", "triangles have", " another orientation than those around; they count as if turned");
    warn(found.many_edges, "edge belongs", "edges belong", " to more than two triangles");
    if (found.one_sided > 0) {
        warnings.push_back(
            "no orientation of the triangles agrees everywhere: the surface has only one side, and what is inside is "
            "a guess");
    }
}

void warn_of_volume(ControlMeshReport& report, OptionNames names) {
    if (!(report.enclosed_world > 0.0)) return;
    const double part = report.shape.volume_world / *report.enclosed_world - 1;
    if (std::abs(part) < kMuch) return;
    report.shape.warnings.push_back("the limit encloses " + number_text(100 * std::abs(part), 2) + " % " +
                                    (part < 0 ? "less" : "more") + " than the surface: more " + option_name("cells", names) +
                                    " or " + option_name("refine", names) + " come nearer");
}

/// Where something is wrong: whether the body is too thin for its cells, and how many would do.
void warn_of_thin_parts(const SurfaceBodies& bodies, const ControlMeshOptions& options, ControlMeshReport& report) {
    constexpr double kThin = 1.5, kAcross = 2, kLittle = 0.01, kMostCells = 1000;
    const bool is_off = report.enclosed_world && std::abs(report.shape.volume_world / *report.enclosed_world - 1) >= kMuch;
    const bool is_missed = report.sharp.missed > 0 || report.shape.after.missed_max > report.side_world;
    if (report.shape.is_sound() && !is_off && !is_missed) return;
    const ThinParts thin = thin_parts(bodies, kThin * report.side_world);
    report.thin = thin;
    if (thin.part < kLittle) return;
    const double cells = std::ceil(kAcross * report.side_world * options.cells / thin.thickness_world);
    report.shape.warnings.push_back(
        number_text(100 * thin.part, 2) + " % of the surface bounds parts that are thinner than " + number_text(kThin) +
        " cells, such as " + number_text(thin.thickness_world, 3) + " at " + number_text(thin.at.x, 3) + ", " +
        number_text(thin.at.y, 3) + ", " + number_text(thin.at.z, 3) + ": " +
        (cells > kMostCells ? "two across them take more than 1000 cells along the longest side"
                            : option_name("cells", options.names) + " " + number_text(cells) + " has two across them"));
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

}  // namespace

std::vector<Option> options_of(ControlMeshOptions& options) {
    std::vector<Option> all{
        Option("cells", options.cells).between(2, 1000).help("N", "cells along the longest side of the surface's box"),
        Option("max-cells", options.max_cells).between(1, 1'000'000'000).help("N", "the most cells that may be made"),
        Option("rounds", options.rounds)
            .between(1, 100)
            .help("N",
                  "how often the points are drawn to the nearest places of the surface; up to 20 times more "
                  "where cells stay flat or the limit folds"),
        Option("refine", options.refine)
            .between(0, 3)
            .help("N", "divide cells into 27 up to N times, where the boundary is not met within --tolerance"),
        Option("tolerance", options.tolerance)
            .between(0, 10)
            .only_with("refine")
            .help("T", "a distance that is near enough, as a part of a cell's side"),
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
    facts["refined"] = report.refined;
    facts["divided"] = report.divided;
    facts["side_world"] = report.side_world;
    if (report.enclosed_world) facts["enclosed_world"] = *report.enclosed_world;
    Facts& sharp = facts.group("sharp");
    sharp["curves"] = report.sharp.curves;
    sharp["missed"] = report.sharp.missed;
    sharp["length_world"] = report.sharp.length_world;
    sharp["missed_length_world"] = report.sharp.missed_length_world;
    sharp["creases"] = report.sharp.creases;
    sharp["rms"] = report.sharp.rms;
    sharp["max"] = report.sharp.max;
    facts["min_scaled_jacobian"] = report.min_scaled_jacobian;
    if (report.thin) {
        Facts& thin = facts.group("thin");
        thin["part"] = report.thin->part;
        thin["thickness_world"] = report.thin->thickness_world;
        thin["at"] = std::array{report.thin->at.x, report.thin->at.y, report.thin->at.z};
    }
    Facts& surface = facts.group("surface");
    surface["walls"] = report.surface.walls;
    surface["united"] = report.surface.united;
    surface["cavities"] = report.surface.cavities;
    surface["cavities_alike"] = report.surface.cavities_alike;
    surface["copies"] = report.surface.copies;
    surface["sheets"] = report.surface.sheets;
    surface["turned"] = report.surface.turned;
    surface["one_sided"] = report.surface.one_sided;
    surface["many_edges"] = report.surface.many_edges;
    return facts;
}

ControlMesh control_mesh_of(const Surface& all, const ControlMeshOptions& given) {
    ControlMeshOptions options = given;
    check_options(options);
    check_options(options.scheme);
    if (options.scheme.crease_angle_deg) {
        throw Error(ErrorCode::InvalidInput, "has no effect: sharp edges of the surface become creases",
                    option_name("crease-angle", options.names),
                    option_name("sharp-angle", options.names) + " for other angles");
    }
    validate(all);
    const Box box = bounds(all);
    const Vec3 size = box.size();
    ControlMeshReport report;
    report.side_world = std::max({size.x, size.y, size.z}) / options.cells;
    constexpr double kSmallest = 1e-60, kLargest = 1e60;  // so that powers of it are numbers
    if (!(report.side_world > kSmallest && report.side_world < kLargest)) {
        throw Error(
            ErrorCode::InvalidInput,
            "the surface has no size that can be worked with: a cell would have the side " + number_text(report.side_world),
            "surface", "1e-60 to 1e60");
    }
    const Vec3 far = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    const double farthest = std::max({far.x, far.y, far.z}) / report.side_world;
    constexpr double kFarthest = 1e9;  // so that coordinates have seven digits within a cell
    if (farthest > kFarthest) {
        throw Error(
            ErrorCode::InvalidInput,
            "the surface is " + number_text(farthest, 2) + " cells away from the origin: its coordinates have no digits left",
            "surface", "up to 1e9 cells");
    }
    const SurfaceBodies bodies(all);
    const Surface& surface = bodies.surface();
    report.surface = bodies.report();
    warn_of(report.surface, report.shape.warnings);
    if (surface.triangles.empty()) {
        throw Error(ErrorCode::InvalidInput, "no triangle has an area", "surface", "a closed surface");
    }
    const SharpEdges sharp =
        options.sharp_angle_deg < kStraight ? sharp_edges(surface, options.sharp_angle_deg, report.side_world) : SharpEdges{};
    CellsInside inside(bodies, options, report.side_world);
    SurfaceFiller filler(surface, sharp, options, report);
    for (;;) {
        filler.fill(inside.cells(report.added));
        if (report.refined == options.refine) break;
        inside.divide_at(filler.places_beyond(options.tolerance * report.side_world));
        if (inside.divided() == report.divided) break;
        report.divided = inside.divided();
        ++report.refined;
    }
    HexMesh mesh = filler.mesh();
    report.parts = parts_of(mesh);
    FitShapeOptions ending;
    ending.scheme = options.scheme;
    ending.folds = options.folds;
    ending.progress = options.progress;
    mesh = finished(std::move(mesh), surface, ending, report.shape);
    if (surface.triangles.size() < all.triangles.size()) {
        const OpenEdges open = open_edges(all);
        report.shape.open_edges = open.count;
        report.shape.open_length_world = open.length_world;
    }
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        report.shape.moved_world = std::max(report.shape.moved_world, glm::distance(filler.start()[p], mesh.points[p]));
    }
    report.min_scaled_jacobian = measure_cells(mesh).min_scaled_jacobian;
    report.enclosed_world = bodies.volume();
    warn_of_volume(report, options.names);
    warn_of_thin_parts(bodies, options, report);
    return {std::move(mesh), std::move(report)};
}

}  // namespace subvol
