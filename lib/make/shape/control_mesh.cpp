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
#include <cmath>
#include <iterator>
#include <optional>

#include "castle.h"
#include "cube_grid.h"
#include "layers.h"
#include "shape_fitter.h"
#include "sharp_paths.h"
#include "subvol/cell.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/fold_samples.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "surface_bodies.h"

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

/// Cells inside a surface: cubes of a grid, some of them divided.
class CellsInside {
public:
    CellsInside(const SurfaceBodies& bodies, const ControlMeshOptions& options, double side)
        : options_(options), bodies_(bodies), grid_(grid_about(bodies.surface(), options, side)), cubes_(grid_) {
        // Cubes fill about the volume, and layers come on top.
        const double least = bodies.least_volume() / (side * side * side);
        if (least > static_cast<double>(options.max_cells)) check_count(static_cast<std::size_t>(std::round(least)));
        if (bodies.is_sheet()) refuse_sheet();
        inside_.resize(grid_.size());
        std::size_t found = 0;
        constexpr std::size_t kTogether = std::size_t{1} << 18;
        for (std::size_t begin = 0; begin < inside_.size(); begin += kTogether) {
            const std::size_t count = std::min(kTogether, inside_.size() - begin);
            parallel_each(count, [&](std::size_t k) {
                if (!is_cancelled(options.progress))
                    inside_[begin + k] = bodies.likeness(grid_.center(begin + k)) > kHalf ? 1 : 0;
            });
            report_progress(options.progress, "fill", begin + count, inside_.size());  // ends what was cancelled
            for (std::size_t k = begin; k < begin + count; ++k) found += inside_[k];
            check_count(found);
        }
        if (found == 0) {
            throw Error(ErrorCode::InvalidInput, "no cell has its middle inside the surface", "surface",
                        "a closed surface, and more cells if it is thin");
        }
        // Beside a bent sheet the surface winds by a half and a little more, somewhere inside of what it encloses by nearly
        // one.
        const auto clearly_inside = [&](std::size_t cube) {
            constexpr float kClear = 0.75F;
            return inside_[cube] != 0 && bodies.likeness(grid_.center(cube)) > kClear;
        };
        bool clear = !bodies.is_open();
        for (std::size_t cube = 0; cube < inside_.size() && !clear; ++cube) clear = clearly_inside(cube);
        if (!clear) refuse_sheet();
    }

    void divide_at(const std::vector<Vec3>& places) { cubes_.divide_at(places, options_.refine); }
    [[nodiscard]] std::size_t divided() const { return cubes_.count(); }

    /// The cells whose middles are inside. added: gets how many more were needed for their boundary to be a surface
    [[nodiscard]] SizedMesh cells(std::size_t& added) const {
        constexpr std::size_t kParts = 27;
        check_count(cubes_.count() * kParts);
        SizedMesh all = cubes_.cells(near());
        std::vector<float> likenesses(all.sides.size());
        std::vector<std::uint8_t> chosen(all.sides.size());
        parallel_each(chosen.size(), [&](std::size_t c) {
            if (is_cancelled(options_.progress)) return;
            likenesses[c] = bodies_.likeness(middle_of(all.mesh, static_cast<Index>(c)));
            chosen[c] = likenesses[c] > kHalf ? 1 : 0;
        });
        if (is_cancelled(options_.progress)) throw Error(ErrorCode::Cancelled, "stopped in shape");
        added = make_manifold(all.mesh, likenesses, chosen);
        SizedMesh made;
        for (std::size_t c = 0; c < chosen.size(); ++c) {
            if (chosen[c] == 0) continue;
            made.mesh.cells.push_back(all.mesh.cells[c]);
            made.sides.push_back(all.sides[c]);
        }
        check_count(made.sides.size());
        if (made.sides.empty()) refuse_sheet();
        made.mesh.points = std::move(all.mesh.points);
        made.mesh = without_unused_points(std::move(made.mesh));
        return made;
    }

private:
    static constexpr float kHalf = 0.5F;

    [[noreturn]] static void refuse_sheet() {
        throw Error(ErrorCode::InvalidInput,
                    "no cell has its middle inside the surface, as it is a sheet, which encloses no volume", "surface",
                    "a closed surface");
    }

    static CubeGrid grid_about(const Surface& surface, const ControlMeshOptions& options, double side) {
        const Box box = box_of(surface);
        const Vec3 counts = box.size() / side + 3.0;
        constexpr double kEmpty = 64;  // cubes of the grid for each of the mesh
        if (counts.x * counts.y * counts.z > kEmpty * static_cast<double>(options.max_cells)) {
            throw Error(ErrorCode::InvalidInput, "the grid would have too many cubes", option_name("cells", options.names),
                        "fewer cells");
        }
        return {box, side};
    }

    void check_count(std::size_t cells) const {
        if (cells <= options_.max_cells) return;
        throw Error(
            ErrorCode::InvalidInput,
            "there would be " + std::to_string(cells) + " or more" +
                (cubes_.count() > 0 ? " cells with divided cubes" : " cells"),
            option_name("cells", options_.names),
            std::string("fewer cells, ") + (cubes_.count() > 0 ? "a larger tolerance, " : "") + "or more with --max-cells");
    }

    /// Cubes inside and divided ones, and those that may be needed around them.
    [[nodiscard]] std::vector<std::uint8_t> near() const {
        std::vector<std::uint8_t> chosen(grid_.size(), 0);
        for (std::size_t cube = 0; cube < chosen.size(); ++cube) {
            const bool divided = cubes_.divided(cube);
            if (!divided && inside_[cube] == 0) continue;
            for (const std::size_t next : grid_.around(cube, divided ? 1 : 2)) chosen[next] = 1;
        }
        return chosen;
    }

    const ControlMeshOptions& options_;
    const SurfaceBodies& bodies_;
    CubeGrid grid_;
    DividedCubes cubes_;
    std::vector<std::uint8_t> inside_;
};

/// The sides of a mesh's cells, given those of the cells that they lie in, so that the volume remains. They change step by
/// step.
std::vector<double> sides_of(const LayeredMesh& mesh, const std::vector<double>& sides) {
    const auto volume = [](const std::vector<double>& of) {
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
    constexpr double kMuch = 0.02;
    if (std::abs(part) < kMuch) return;
    report.shape.warnings.push_back("the limit encloses " + number_text(100 * std::abs(part), 2) + " % " +
                                    (part < 0 ? "less" : "more") + " than the surface: more " + option_name("cells", names) +
                                    " or " + option_name("refine", names) + " come nearer");
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

/// Draws the boundary of cells to a surface.
class SurfaceFiller {
public:
    SurfaceFiller(const Surface& surface, const SharpEdges& sharp, const ControlMeshOptions& options, ControlMeshReport& report)
        : surface_(surface), sharp_(sharp), options_(options), report_(report) {}

    void fill(const SizedMesh& inside) {
        LayeredMesh layered = with_layer_at_hull(inside.mesh);
        aims_.sides = sides_of(layered, inside.sides);
        aims_.weights.assign(aims_.sides.size(), 1);
        mesh_ = std::move(layered.mesh);
        start_ = mesh_.points;
        paths_ = {};
        report_.shape.before = error_until(mesh_, surface_, options_.scheme, options_.progress);
        report_.shape.rounds = 0;
        // The first rounds have control cells, as the limit of cubes is none of the surface's.
        const int half = options_.rounds / 2;
        draw(Scheme::Linear, 0, half);
        if (!sharp_.curves.empty()) paths_ = sharp_paths(mesh_, sharp_, report_.side_world);
        if (!paths_.creases.empty()) {
            std::vector<std::array<Index, 2>> along = paths_.creases;
            along.insert(along.end(), paths_.cuts.begin(), paths_.cuts.end());
            layered = with_layer_along(mesh_, along);
            aims_.sides = sides_of(layered, aims_.sides);
            aims_.weights.assign(aims_.sides.size(), 1);
            mesh_ = std::move(layered.mesh);
            mesh_.creases = paths_.creases;
            start_ = mesh_.points;
            draw(Scheme::Linear, half / 2, half);
        }
        draw(options_.scheme.kind, half, options_.rounds);
        straighten();
        report_.sharp = report_of(sharp_, paths_, fitter_->sharp_error(mesh_.points));
    }

    /// Places of the boundary and the surface with a distance beyond `far`, and those of sharp edges that are missed.
    [[nodiscard]] std::vector<Vec3> places_beyond(double far) const {
        std::vector<Vec3> places = fitter_->places_beyond(mesh_.points, far);
        for (const Index k : paths_.missed) {
            const SharpCurve& curve = sharp_.curves[k];
            const double steps = std::ceil(2 * curve.length() / report_.side_world);
            for (double step = 0; step <= steps; ++step) places.push_back(curve.at(step / steps));
        }
        return places;
    }

    [[nodiscard]] const HexMesh& mesh() const { return mesh_; }
    /// Where the points were as cubes with layers.
    [[nodiscard]] const std::vector<Vec3>& start() const { return start_; }

private:
    void draw(Scheme kind, int first, int end) {
        SchemeOptions scheme = options_.scheme;
        scheme.kind = kind;
        fitter_.emplace(build_topology(mesh_), surface_, scheme, options_.progress);
        fitter_->follow(sharp_, paths_);
        for (int round = first; round < end; ++round) {
            const double part = static_cast<double>(round) / options_.rounds;
            report_progress(options_.progress, "shape", (report_.refined + part) / (options_.refine + 1));
            relax(round);
        }
    }

    void relax(int round) {
        constexpr double kMore = 1.5;
        mesh_.points = fitter_->relaxed(mesh_.points, aims_, std::pow(kMore, round));
        ++report_.shape.rounds;
    }

    /// Cells with flat corners and those whose limit folds or may fold count more, and all points are drawn again, until there
    /// are no such cells. Folds are looked for near those that are known, and everywhere if there are none left.
    void straighten() {
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
    [[nodiscard]] std::vector<std::uint8_t> bad_cells(const std::vector<std::uint8_t>& near) const {
        std::vector<std::uint8_t> sharp(mesh_.points.size(), 0);
        for (const auto& crease : mesh_.creases) {
            for (const Index p : crease) sharp[p] = 1;
        }
        std::vector<std::uint8_t> bad(mesh_.cells.size());
        parallel_each(bad.size(), [&](std::size_t c) {
            std::array<Vec3, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh_.points[mesh_.cells[c][k]];
            // The angle of a sharp edge may be acute, and would be rounded.
            constexpr double kFlat = 0.3, kFlatAtCrease = 0.05;
            const bool at_crease = std::ranges::any_of(mesh_.cells[c], [&](Index p) { return sharp[p] != 0; });
            bad[c] = min_scaled_jacobian(corners) < (at_crease ? kFlatAtCrease : kFlat) ? 1 : 0;
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

    const Surface& surface_;
    const SharpEdges& sharp_;
    const ControlMeshOptions& options_;
    ControlMeshReport& report_;
    HexMesh mesh_;
    CellAims aims_;
    std::vector<Vec3> start_;
    SharpPaths paths_;
    std::optional<ShapeFitter> fitter_;  // of the last rounds
};

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
    const Box box = box_of(all);
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
    return {std::move(mesh), std::move(report)};
}

}  // namespace subvol
