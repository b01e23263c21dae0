// SPDX-License-Identifier: Apache-2.0
#include "mesh_pictures.h"

#include <algorithm>
#include <utility>

#include "shell_scene.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

void check_points(const std::vector<Vec3>& points) {
    constexpr double kMost_world = 1e18;  // as of splats; far beyond it, squares and volumes overflow
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3 x = glm::abs(points[p]);
        const double largest = std::max({x.x, x.y, x.z});
        if (largest <= kMost_world) continue;
        throw Error(ErrorCode::InvalidInput, text("point ", p, " has the coordinate ", largest), {},
                    "at most 1e18 can be drawn");
    }
}

}  // namespace

ShownField ShownMesh::field() const {
    return {mesh.attributes.front().name, field_range(mesh, 0)};
}

ShownField ShownMesh::colors() const {
    return {mesh.attributes.back().name, field_range(mesh, mesh.attributes.size() - 1)};
}

Box ShownMesh::box() const {
    Box box = bounds(mesh);
    if (mesh.cells.empty()) {
        for (const Vec3& p : mesh.points) box.add(p);
    }
    return box;
}

WithFacts<ShownMesh> load_shown_mesh(const std::string& input, const CommonOptions& options, const RenderArguments& arguments,
                                     Progress* progress, ShellsAlone alone) {
    ShownMesh shown;
    Facts facts;
    Shells* const wanted = arguments.tets.asked() ? nullptr : &shown.shells;  // tetrahedra are refined by other rules
    if (arguments.tets.asked()) alone = ShellsAlone::Refuse;
    shown.mesh = facts.unpack(load_mesh(input, options, progress, wanted, alone));
    shown.mesh = facts.unpack(with_selected_field(std::move(shown.mesh), options, arguments.splat.color_field));
    shown.mesh = facts.unpack(arguments.tets.hexes(std::move(shown.mesh), default_tet_level(arguments.method), progress));
    check_points(shown.mesh.points);
    check_points(shown.shells.points);
    return {std::move(shown), std::move(facts)};
}

PictureNotes make_notes(const ShownMesh& shown, const ShownColors& colors, RenderArguments& arguments, Progress* progress,
                        Facts& facts) {
    PictureNotes notes = make_notes(arguments.picture, colors, &shown.mesh);
    if (!shown.shells.empty()) {
        const int samples =
            PictureStyle{.look = {.look = arguments.picture.look}, .samples = arguments.chosen.style.samples}.sample_count();
        notes.shells = make_shell_scene(shown.mesh, shown.shells, arguments.refine.options(0, progress),
                                        arguments.refine.levels, colors.optics, samples, arguments.clip.clip(), facts);
    }
    return notes;
}

}  // namespace subvol::cli
