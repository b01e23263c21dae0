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
    if (!is_tet_scheme(arguments.scheme)) return;
    scheme_ = named<TetScheme>(arguments.scheme, "--scheme");
    levels_ = arguments.levels;
    crease_angle_deg_ = arguments.rules.crease_angle_deg.value_or(kCreaseAngleDeg);
    arguments.scheme = "linear";
    arguments.levels.reset();
    arguments.rules.crease_angle_deg.reset();
}

void TetRefinement::refuse_bricks(const std::string& bricks) const {
    if (!asked()) return;
    throw Error(ErrorCode::InvalidInput, "is a folder of bricks, which is not refined by \"" + name() + "\"", bricks,
                "another --scheme");
}

WithFacts<MixedMesh> TetRefinement::refined(const HexMesh& mesh, int default_levels, Vertices vertices, Progress* progress,
                                            std::vector<Index>* parents) const {
    Facts facts;
    if (!mesh.sharp_faces.empty())
        facts.warn(text(mesh.sharp_faces.size(), " sharp faces inside the mesh left out: ", name(), " has none"));
    const MixedRefineOptions options{.scheme = *scheme_,
                                     .levels = levels_.value_or(default_levels),
                                     .crease_angle_deg = crease_angle_deg_,
                                     .progress = progress};
    MixedMesh fine = facts.timed(progress, "refine", [&] {
        MixedMesh control = join_split_cells(mesh);
        if (*scheme_ == TetScheme::Boxspline) control = in_tetrahedra(std::move(control));
        facts["control_points"] = control.points.size();
        facts["control_cells"] = control.cells();
        if (options.levels <= kMostTetLevels)
            check_memory(options.levels, static_cast<double>(control.cells()) * std::pow(8.0, options.levels), kBytesPerTet);
        if (parents != nullptr) *parents = control_cells(control, options.levels);
        if (vertices == Vertices::OfTheLevel) return refine(control, options);
        MixedVolume volume = volume_through(control, options);
        facts["off_points"] = volume.left;
        return std::move(volume.mesh);
    });
    facts["scheme"] = name();
    facts["levels"] = options.levels;
    facts["crease_angle"] = *crease_angle_deg_;
    facts["tets"] = fine.tets.size();
    facts["octahedra"] = fine.octahedra.size();
    const MixedShape shape = measure_cells(fine);
    facts["inverted_cells"] = shape.inverted;
    facts["worst_shape"] = shape.worst;
    if (shape.inverted > 0) {
        facts.warn(text(shape.inverted, " of ", fine.cells(), " refined cells are inverted (worst shape ", shape.worst,
                        "; that of a regular cell is 1)"));
    }
    return {std::move(fine), std::move(facts)};
}

WithFacts<Facts> TetRefinement::figures(const HexMesh& mesh, int default_levels, Progress* progress) const {
    HexMesh bare{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
    const auto [fine, facts] = refined(bare, default_levels, Vertices::OnTheLimit, progress);
    WithFacts<Facts> result;
    for (const Fact& fact : facts.all()) {
        const bool beside = fact.name == "seconds" || fact.name == "warnings";
        (beside ? result.facts : result.value)[fact.name] = fact.value;
    }
    result.value["volume"] = measure_cells(fine).volume;
    return result;
}

WithFacts<HexMesh> TetRefinement::hexes(HexMesh mesh, int default_levels, Progress* progress) const {
    if (!scheme_) return {std::move(mesh)};
    auto [fine, facts] = refined(mesh, default_levels, Vertices::OnTheLimit, progress);
    return {in_hexahedra(fine), std::move(facts)};
}

}  // namespace subvol::cli
