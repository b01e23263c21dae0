// SPDX-License-Identifier: Apache-2.0
#include "tet_refinement.h"

#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kInterpolationTol = 1e-4;  // of the range of a field: far below the error of the mesh
constexpr int kMostSteps = 100;

// An edge of a box may have two tetrahedra or more, so the rule of hexahedra, sharp where one cell is, does not find it. A
// ball of some hundred points bends by 20 degrees at its edges.
constexpr double kCreaseAngleDeg = 60;

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

MixedMesh TetRefinement::refined(const HexMesh& mesh, int default_levels, Vertices vertices, Report& report) const {
    const MixedRefineOptions options{.scheme = *scheme_,
                                     .levels = levels_.value_or(default_levels),
                                     .crease_angle_deg = crease_angle_deg_,
                                     .progress = report.progress()};
    MixedMesh fine = report.timed("refine", [&] {
        MixedMesh control = join_split_cells(mesh);
        if (*scheme_ == TetScheme::Boxspline) control = in_tetrahedra(std::move(control));
        report["control_points"] = control.points.size();
        report["control_cells"] = control.cells();
        if (vertices == Vertices::OfTheLevel) return refine(control, options);
        MixedRefineOptions creases = options;
        creases.levels = 0;  // the control mesh with its creases, which the interpolation must know
        MixedInterpolation through = interpolate_vertices(refine(control, creases), *scheme_, kInterpolationTol, kMostSteps);
        report["off_points"] = through.left;
        return on_limit(refine(through.mesh, options), *scheme_);
    });
    report["scheme"] = name();
    report["levels"] = options.levels;
    report["crease_angle"] = *crease_angle_deg_;
    report["tets"] = fine.tets.size();
    report["octahedra"] = fine.octahedra.size();
    const MixedShape shape = measure_cells(fine);
    report["inverted_cells"] = shape.inverted;
    report["worst_shape"] = shape.worst;
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
