// SPDX-License-Identifier: Apache-2.0
// A mesh of hexahedra for what surfaces of triangles enclose, each a material.
//
//     surfaces ──► bodies: what is inside of them ──► chains of sharp edges
//     ┌► cubes of a grid, some divided into 27 parts ──► those with their middles inside, and more until the walls of each
//     │  material are a surface ──► a layer of cells within them
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
#include "material_bodies.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "surface_filler.h"
#include "thin_parts.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kStraight = 180;
constexpr double kMuch = 0.02;  // of the volume

/// What errors call a surface.
std::string called(const MaterialBodies& bodies, Index material) {
    return bodies.size() > 1 ? bodies.name(material) : "surface";
}

void check_names(std::span<const MaterialSurface> materials) {
    std::vector<std::string> names;
    for (const MaterialSurface& material : materials) names.push_back(material.name);
    std::ranges::sort(names);
    if (names.size() > 1 && names.front().empty()) {
        throw Error(ErrorCode::InvalidInput, "a material has no name", "materials", "a name of its own for each");
    }
    const auto twice = std::ranges::adjacent_find(names);
    if (twice == names.end()) return;
    throw Error(ErrorCode::InvalidInput, "two materials have this name", *twice, "a name of its own for each");
}

/// The side of a cube, checked.
double side_of(const Box& box, int cells) {
    const Vec3 size = box.size();
    const double side = std::max({size.x, size.y, size.z}) / cells;
    constexpr double kSmallest = 1e-60, kLargest = 1e60;  // so that powers of it are numbers
    if (!(side > kSmallest && side < kLargest)) {
        throw Error(ErrorCode::InvalidInput,
                    "the surface has no size that can be worked with: a cell would have the side " + number_text(side),
                    "surface", "1e-60 to 1e60");
    }
    const Vec3 far = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    const double farthest = std::max({far.x, far.y, far.z}) / side;
    constexpr double kFarthest = 1e9;  // so that coordinates have seven digits within a cell
    if (farthest > kFarthest) {
        throw Error(
            ErrorCode::InvalidInput,
            "the surface is " + number_text(farthest, 2) + " cells away from the origin: its coordinates have no digits left",
            "surface", "up to 1e9 cells");
    }
    return side;
}

void add(EnclosureReport& sum, const EnclosureReport& more) {
    sum.walls += more.walls;
    sum.united += more.united;
    sum.cavities += more.cavities;
    sum.cavities_alike += more.cavities_alike;
    sum.copies += more.copies;
    sum.sheets += more.sheets;
    sum.turned += more.turned;
    sum.one_sided += more.one_sided;
    sum.many_edges += more.many_edges;
}

/// What is odd about a surface, and what was done about it.
void warn_of(const MaterialBodies& bodies, Index material, std::vector<std::string>& warnings) {
    const EnclosureReport& found = bodies[material].report();
    const std::string of = bodies.size() > 1 ? bodies.name(material) + ": " : "";
    const auto warn = [&](std::size_t count, const char* one, const char* many, const std::string& rest) {
        if (count > 0) warnings.push_back(of + counted(count, one, many) + rest);
    };
    warn(found.united, "part of the surface crosses", "parts of the surface cross", " others: the mesh is that of their union");
    warn(found.cavities_alike, "inner part of the surface has", "inner parts of the surface have",
         " the orientation of the outer one: taken as the walls of cavities");
    warn(found.copies, "triangle is", "triangles are", " there twice; copies are left out");
    warn(found.sheets, "triangle is", "triangles are", " in sheets that enclose nothing, which are left out");
    warn(found.turned, "triangle has", "triangles have", " another orientation than those around; they count as if turned");
    warn(found.many_edges, "edge belongs", "edges belong", " to more than two triangles");
    if (found.one_sided > 0) {
        warnings.push_back(of +
                           "no orientation of the triangles agrees everywhere: the surface has only one side, and what is "
                           "inside is a guess");
    }
    for (Index smaller = 0; smaller < material; ++smaller) {
        if (bodies.relation(smaller, material) != MaterialBodies::Relation::Crossing) continue;
        warnings.push_back(bodies.name(smaller) + " and " + bodies.name(material) + " cross: what both enclose is " +
                           bodies.name(smaller) + ", which encloses less");
    }
}

/// The open edges of surfaces of which triangles were left out.
void note_open_edges(std::span<const MaterialSurface> materials, const MaterialBodies& bodies, FitShapeReport& report) {
    OpenEdges sum;
    bool all = true;
    for (Index m = 0; m < bodies.size(); ++m) {
        const Surface& surface = materials[bodies.given(m)].surface;
        all &= bodies[m].surface().triangles.size() == surface.triangles.size();
        const OpenEdges open = open_edges(surface);
        sum.count += open.count;
        sum.length_world += open.length_world;
    }
    if (all) return;
    report.open_edges = sum.count;
    report.open_length_world = sum.length_world;
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
void warn_of_thin_parts(const MaterialBodies& bodies, const ControlMeshOptions& options, ControlMeshReport& report) {
    constexpr double kThin = 1.5, kAcross = 2, kLittle = 0.01, kMostCells = 1000;
    const bool is_off = report.enclosed_world && std::abs(report.shape.volume_world / *report.enclosed_world - 1) >= kMuch;
    const bool is_missed = report.sharp.missed > 0 || report.shape.after.missed_max > report.side_world;
    if (report.shape.is_sound() && !is_off && !is_missed) return;
    ThinParts thin;
    for (Index m = 0; m < bodies.size(); ++m) {
        const ThinParts own = thin_parts(bodies[m], kThin * report.side_world);
        if (own.part > thin.part) thin = own;
    }
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
    facts["lid_sides"] = report.lid_sides;
    if (report.enclosed_world) facts["enclosed_world"] = *report.enclosed_world;
    Facts& sharp = facts.group("sharp");
    sharp["corners"] = report.sharp.corners;
    sharp["missed_corners"] = report.sharp.missed_corners;
    sharp["curves"] = report.sharp.curves;
    sharp["missed"] = report.sharp.missed;
    sharp["length_world"] = report.sharp.length_world;
    sharp["missed_length_world"] = report.sharp.missed_length_world;
    sharp["creases"] = report.sharp.creases;
    sharp["rms"] = report.sharp.rms;
    sharp["max"] = report.sharp.max;
    const auto kept = [](double missed, double all) { return all > 0 ? 1 - missed / all : 1; };
    Facts& features = facts.group("features");
    features["points"] = kept(static_cast<double>(report.sharp.missed_corners), static_cast<double>(report.sharp.corners));
    features["curves"] = kept(report.sharp.missed_length_world, report.sharp.length_world);
    features["surfaces"] = report.shape.after.reached_part;
    facts["min_scaled_jacobian"] = report.min_scaled_jacobian;
    if (report.thin) {
        Facts& thin = facts.group("thin");
        thin["part"] = report.thin->part;
        thin["thickness_world"] = report.thin->thickness_world;
        thin["at"] = std::array{report.thin->at.x, report.thin->at.y, report.thin->at.z};
    }
    FactValue::List materials;
    for (const MaterialReport& material : report.materials) {
        Facts own;
        own["name"] = material.name;
        own["cells"] = material.cells;
        own["volume_world"] = material.volume_world;
        if (material.enclosed_world) own["enclosed_world"] = *material.enclosed_world;
        materials.emplace_back(std::move(own));
    }
    if (!materials.empty()) facts["materials"] = std::move(materials);
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

ControlMesh control_mesh_of(const Surface& surface, const ControlMeshOptions& options) {
    return control_mesh_of(std::array{MaterialSurface{"", surface}}, options);
}

ControlMesh control_mesh_of(std::span<const MaterialSurface> materials, const ControlMeshOptions& given) {
    ControlMeshOptions options = given;
    check_options(options);
    check_options(options.scheme);
    if (options.scheme.crease_angle_deg) {
        throw Error(ErrorCode::InvalidInput, "has no effect: sharp edges of the surface become creases",
                    option_name("crease-angle", options.names),
                    option_name("sharp-angle", options.names) + " for other angles");
    }
    if (materials.empty()) throw Error(ErrorCode::InvalidInput, "there is no surface", "materials", "one or more");
    check_names(materials);
    Box box;
    for (const MaterialSurface& material : materials) {
        validate(material.surface);
        const Box own = bounds(material.surface);
        box.add(own.lower);
        box.add(own.upper);
    }
    ControlMeshReport report;
    report.side_world = side_of(box, options.cells);
    const MaterialBodies bodies(materials, report.side_world);
    std::vector<WallTarget> targets;
    for (Index m = 0; m < bodies.size(); ++m) {
        if (bodies[m].surface().triangles.empty()) {
            throw Error(ErrorCode::InvalidInput, "no triangle has an area", called(bodies, m), "a closed surface");
        }
        add(report.surface, bodies[m].report());
        warn_of(bodies, m, report.shape.warnings);
        targets.push_back(bodies.target(m));
    }
    const SharpEdges sharp = options.sharp_angle_deg < kStraight ? bodies.sharp_edges(options.sharp_angle_deg) : SharpEdges{};
    CellsInside inside(bodies, options, report.side_world);
    SurfaceFiller filler(targets, sharp, options, report);
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
    FinishedShape ended = finished(std::move(mesh), filler.walls(), ending, report.shape);
    mesh = std::move(ended.mesh);
    note_open_edges(materials, bodies, report.shape);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        report.shape.moved_world = std::max(report.shape.moved_world, glm::distance(filler.start()[p], mesh.points[p]));
    }
    report.min_scaled_jacobian = measure_cells(mesh).min_scaled_jacobian;
    const std::vector<std::optional<double>> enclosed = bodies.volumes();
    report.enclosed_world = 0;
    for (const std::optional<double>& volume : enclosed) {
        report.enclosed_world =
            volume && report.enclosed_world ? std::optional(*report.enclosed_world + *volume) : std::nullopt;
    }
    MeshSets sets;
    // Walls between materials are inside of the mesh, where no patch can be.
    const Topology topology = build_topology(mesh);
    std::erase_if(ended.lids,
                  [&](const CellSide& at) { return !topology.face_on_hull(topology.cell_faces[at.cell][at.side]); });
    if (!ended.lids.empty()) sets.patches.push_back({"lid", std::move(ended.lids)});
    report.lid_sides = sets.patches.empty() ? 0 : sets.patches.front().sides.size();
    if (bodies.size() > 1) {
        sets.sets.resize(bodies.size());
        report.materials.resize(bodies.size());
        for (Index m = 0; m < bodies.size(); ++m) {
            CellSet& set = sets.sets[bodies.given(m)];
            set.name = bodies.name(m);
            for (Index c = 0; c < mesh.cells.size(); ++c) {
                if (filler.walls().materials[c] == m) set.cells.push_back(c);
            }
            report.materials[bodies.given(m)] = {set.name, set.cells.size(), ended.volumes[m], enclosed[m]};
        }
    }
    warn_of_volume(report, options.names);
    warn_of_thin_parts(bodies, options, report);
    return {std::move(mesh), std::move(sets), std::move(report)};
}

}  // namespace subvol
