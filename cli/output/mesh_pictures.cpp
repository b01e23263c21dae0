// SPDX-License-Identifier: Apache-2.0
#include "mesh_pictures.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "ranked_bricks.h"
#include "reference_pictures.h"
#include "render_method.h"
#include "sampled_points.h"
#include "sheet_scene.h"
#include "subvol/boundary_values.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr int kTetsLevel = 1;

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

/// Whether there is light, which the reference methods have on the boundary only.
bool has_light(const RenderArguments& arguments) {
    if (!arguments.picture.lit()) return false;
    if (arguments.picture.look == Look::Solid) return true;
    throw Error(ErrorCode::InvalidInput, "method " + arguments.method + " lights the boundary only", "--look isosurface",
                "use --method splat or sheets, or --tf isosurface for surfaces without light");
}

/// The surface that is lit, if there is light, and the values on it.
BoundaryValues skin_of(const HexMesh& mesh, const RenderArguments& arguments, Report& report) {
    if (!has_light(arguments)) return {};
    const int levels = picture_levels(mesh, arguments.tets.asked() ? std::optional(0) : arguments.refine.levels);
    RefineOptions options = arguments.refine.options(levels, report.progress());
    options.levels = levels;
    return report.timed("boundary", [&] { return boundary_values(mesh, options); });
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

ShownMesh load_shown_mesh(const std::string& input, const CommonOptions& options, const RenderArguments& arguments,
                          Report& report, ShellsAlone alone) {
    ShownMesh shown;
    Shells* const wanted = arguments.tets.asked() ? nullptr : &shown.sheets;  // tetrahedra are refined by other rules
    if (arguments.tets.asked()) alone = ShellsAlone::Refuse;
    report["input"] = input;  // for errors
    shown.mesh = report.unpack(load_mesh(input, options, report.progress(), wanted, alone));
    shown.mesh = report.unpack(with_selected_field(std::move(shown.mesh), options, arguments.splat.color_field));
    shown.mesh =
        report.unpack(arguments.tets.hexes(std::move(shown.mesh), is_of_splats(arguments.method) ? 1 : 2, report.progress()));
    check_points(shown.mesh.points);
    check_points(shown.sheets.points);
    return shown;
}

PictureNotes make_notes(const ShownMesh& shown, const ShownColors& colors, RenderArguments& arguments, Report& report) {
    PictureNotes notes = make_notes(arguments.picture, colors, &shown.mesh);
    if (!shown.sheets.empty()) {
        notes.sheets =
            make_sheet_scene(shown.mesh, shown.sheets, arguments.refine.options(0, report.progress()), arguments.refine.levels,
                             colors.optics, arguments.reference.samples, arguments.options.clip, report);
    }
    return notes;
}

void write_mesh_pictures(const HexMesh& mesh, const std::vector<View>& views, const Optics& optics,
                         const RenderArguments& arguments, SplatWork work, const CLI::App& app, PictureOutput& output,
                         Report& report) {
    const ReferenceArguments& reference = arguments.reference;
    const SplatArguments& splat = arguments.splat;
    const RefineArguments& refine = arguments.refine;
    if (mesh.attributes.size() == 1) work.options.color_channel.reset();  // the field of the colours is --field itself
    if (arguments.method == "tets" || arguments.method == "pt") {
        const auto draw = [&](const auto& fine) {
            const Surface boundary = work.rows.finished() ? skin_of(mesh, arguments, report).surface : Surface{};
            if (arguments.method == "tets") {
                const TetsRenderer renderer(fine);
                report.add_seconds("prepare", renderer.seconds_build());
                const auto draw_rows = [&](const View& view, const TetsOptions& options) {
                    return renderer.draw(view, optics, options);
                };
                return write_tets(draw_rows, boundary, views, reference, work.rows, output, report);
            }
            ProjectedRenderer renderer(fine, {}, splat.device);
            write_projected_tets(renderer, boundary, views, optics, reference, splat.seconds, output, report);
        };
        if (arguments.tets.asked()) return draw(join_split_cells(mesh));
        draw(report.unpack(refine_reported(mesh, refine.options(kTetsLevel, report.progress()), Vertices::OnTheLimit)));
    } else if (arguments.method == "dense") {
        const RefineOptions options = refine.options(0, report.progress());
        const auto draw = [&](const View& view, Progress* progress) {
            return draw_dense(mesh, options, refine.levels, view, optics, reference, progress, report);
        };
        output.write(views, lit(draw, skin_of(mesh, arguments, report).surface, reference), report);
    } else if (splat.seconds) {
        const SampleOptions sample = arguments.sample.options(bounds(mesh), refine.options(0, report.progress()));
        write_splats_in_time(mesh, sample, *splat.seconds, views.front(), optics, work, output, report);
    } else {
        BoundaryValues skin;
        // Shadows and occlusion are those of the kernels: the boundary's own colours have none.
        const bool own_light = splat.shadows || splat.ambient_occlusion > 0;
        if (!own_light && arguments.picture.paints_boundary(app, refine)) skin = skin_of(mesh, arguments, report);
        const RbfVolume volume = report.unpack(
            arguments.tets.asked() ? sample_tets_reported(mesh, arguments.sample, optics.function(), report.progress())
                                   : sample_reported(mesh, arguments.sample, refine, optics.function(), report.progress()));
        write_splats(volume, reference.lod.value_or(0), skin, views, optics, work, output, report);
    }
}

void write_brick_tets(const Bricks& bricks, const BrickFields& fields, std::optional<BrickHull> hull,
                      const std::vector<View>& views, const Optics& optics, const RenderArguments& arguments,
                      const OwnRows& rows, PictureOutput& output, Report& report) {
    BrickTetsOptions options{.refine = arguments.refine.options(kTetsLevel, report.progress()),
                             .memory_bytes = arguments.memory_bytes};
    options.tets.progress = report.progress();
    Surface boundary;
    if (has_light(arguments) && rows.finished()) {
        boundary = report.timed("boundary",
                                [&] { return boundary_values(*hull, options.refine.scheme, arguments.refine.levels).surface; });
    }
    hull.reset();
    const BrickTets all = report.timed("measure", [&] { return measure_tets(bricks, options, rows); });
    report["levels"] = options.refine.levels;
    report["cells"] = all.tets / 6;
    const auto draw = [&](const View& view, const TetsOptions& tets) {
        options.tets = tets;
        TetsResult drawn = render_tets(bricks, fields, all, view, optics, options);
        report.add_seconds("prepare", drawn.report.seconds_build);
        return drawn;
    };
    write_tets(draw, boundary, views, arguments.reference, rows, output, report);
}

}  // namespace subvol::cli
