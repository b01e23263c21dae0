// SPDX-License-Identifier: Apache-2.0
#include "tet_refinement.h"

#include <cmath>

#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

// An edge of a box may have two tetrahedra or more, so the rule of hexahedra, sharp where one cell is, does not find it. A
// ball of some hundred points bends by 20 degrees at its edges.
constexpr double kCreaseAngleDeg = 60;

constexpr double kBytesPerTet = 400;  // of eight for each cell and level, while the finest is put on its limit

}  // namespace

TetRefinement::TetRefinement(RefineArguments& arguments) {
    if (arguments.scheme != "tetoct" && arguments.scheme != "boxspline") return;
    scheme_ = arguments.scheme == "tetoct" ? TetScheme::Tetoct : TetScheme::Boxspline;
    levels_ = arguments.levels;
    crease_angle_deg_ = arguments.crease_angle_deg.value_or(kCreaseAngleDeg);
    arguments.scheme = "linear";
    arguments.levels.reset();
    arguments.crease_angle_deg.reset();
}

void TetRefinement::refuse_bricks(const std::string& bricks) const {
    if (!asked()) return;
    throw Error(ErrorCode::InvalidInput, "is a folder of bricks, which is not refined by \"" + name() + "\"", bricks,
                "another --scheme");
}

MixedMesh TetRefinement::refined(const HexMesh& mesh, int default_levels, Vertices vertices, Report& report,
                                 std::vector<Index>* parents) const {
    Json figures;
    MixedMesh fine = refined(mesh, default_levels, vertices, figures, report, parents);
    for (const auto& [key, value] : figures.items()) report[key.c_str()] = value;
    return fine;
}

Json TetRefinement::figures(const HexMesh& mesh, int default_levels, Report& report) const {
    Json figures;
    HexMesh bare{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
    const MixedMesh fine = refined(bare, default_levels, Vertices::OnTheLimit, figures, report, nullptr);
    figures["volume"] = measure_cells(fine).volume;
    return figures;
}

MixedMesh TetRefinement::refined(const HexMesh& mesh, int default_levels, Vertices vertices, Json& figures, Report& report,
                                 std::vector<Index>* parents) const {
    const MixedRefineOptions options{.scheme = *scheme_,
                                     .levels = levels_.value_or(default_levels),
                                     .crease_angle_deg = crease_angle_deg_,
                                     .progress = report.progress()};
    MixedMesh fine = report.timed("refine", [&] {
        MixedMesh control = join_split_cells(mesh);
        if (*scheme_ == TetScheme::Boxspline) control = in_tetrahedra(std::move(control));
        figures["control_points"] = control.points.size();
        figures["control_cells"] = control.cells();
        if (options.levels <= kMostTetLevels)
            check_memory(options.levels, static_cast<double>(control.cells()) * std::pow(8.0, options.levels), kBytesPerTet);
        if (parents != nullptr) *parents = control_cells(control, options.levels);
        if (vertices == Vertices::OfTheLevel) return refine(control, options);
        MixedVolume volume = volume_through(control, options);
        figures["off_points"] = volume.left;
        return std::move(volume.mesh);
    });
    figures["scheme"] = name();
    figures["levels"] = options.levels;
    figures["crease_angle"] = *crease_angle_deg_;
    figures["tets"] = fine.tets.size();
    figures["octahedra"] = fine.octahedra.size();
    const MixedShape shape = measure_cells(fine);
    figures["inverted_cells"] = shape.inverted;
    figures["worst_shape"] = shape.worst;
    if (shape.inverted > 0) {
        report.warn(text(shape.inverted, " of ", fine.cells(), " refined cells are inverted (worst shape ", shape.worst,
                         "; that of a regular cell is 1)"));
    }
    return fine;
}

HexMesh TetRefinement::hexes(HexMesh mesh, int default_levels, Report& report) const {
    if (!scheme_) return mesh;
    return in_hexahedra(refined(mesh, default_levels, Vertices::OnTheLimit, report));
}

}  // namespace subvol::cli
