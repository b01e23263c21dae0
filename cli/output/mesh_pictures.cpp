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

WithFacts<ShownBody> load_shown_body(const std::string& input, const CommonOptions& options, const RenderArguments& arguments,
                                     const CLI::App& app, Progress* progress, ShellsAlone alone) {
    const bool refined = arguments.tets.asked();  // tetrahedra are refined by other rules than shells
    if (refined) alone = ShellsAlone::Refuse;
    Facts facts;
    BodyInput body = facts.unpack(open_body(input, options, app, progress, !refined, alone));
    const std::string field = facts.unpack(body.select(options, OtherFields::Drop, arguments.splat.color_field));
    facts.merge(body.refine(arguments.tets, default_tet_level(arguments.method), progress));
    ShownBody shown{std::move(body), {field, {}}, {field, {}}};
    shown.field.range = shown.body.range(field);
    shown.colors = shown.field;
    const MeshSource source = shown.body.source();
    shown.box = source.bounds();
    if (const HexMesh* mesh = source.mesh()) {
        check_points(mesh->points);
        check_points(shown.body.shells.points);
        const std::string& colors = mesh->attributes.back().name;
        shown.colors = {colors, shown.body.range(colors)};
        if (mesh->cells.empty()) {
            for (const Vec3& p : mesh->points) shown.box.add(p);
        }
    }
    return {std::move(shown), std::move(facts)};
}

PictureNotes make_notes(const ShownBody& shown, const ShownColors& colors, RenderArguments& arguments, Progress* progress,
                        Facts& facts) {
    const MeshSource source = shown.body.source();
    PictureNotes notes = make_notes(arguments.picture, colors, source.mesh());
    if (!shown.body.shells.empty()) {
        const int samples =
            PictureStyle{.look = {.look = arguments.picture.look}, .samples = arguments.chosen.style.samples}.sample_count();
        notes.shells = make_shell_scene(*source.mesh(), shown.body.shells, arguments.refine.options(0, progress),
                                        arguments.refine.levels, colors.optics, samples, arguments.clip.clip(), facts);
    }
    return notes;
}

}  // namespace subvol::cli
