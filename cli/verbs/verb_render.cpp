// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <utility>

#include "bricks_input.h"
#include "grid_input.h"
#include "input.h"
#include "mesh_pictures.h"
#include "part_note.h"
#include "picture_output.h"
#include "points_input.h"
#include "reference_pictures.h"
#include "render_arguments.h"
#include "render_method.h"
#include "sampled_points.h"
#include "share.h"
#include "sheet_scene.h"
#include "splat_pictures.h"
#include "steps.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/error.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

ShownField united(const ShownField& a, const ShownField& b) {
    return {b.name, {std::min(a.range.min, b.range.min), std::max(a.range.max, b.range.max)}};
}

class RenderVerb : public Verb {
public:
    explicit RenderVerb(CLI::App& program)
        : Verb(program, "render", "Render an image or a video.",
               "  subvol render model:ball -o ball.png\n"
               "  subvol render model:ball -o side.exr --view -y --size 1024x768 --tf coolwarm\n"
               "  subvol render model:ball -o turn.mp4 --turntable 120 --legend turn.svg\n"
               "  subvol render model:ball -o reference.exr --method tets --levels 2 --samples 2\n"
               "  subvol render run.pvd -o run.mp4 --step all             a film\n"
               "  subvol render smoke.vdb -o smoke.png --method grid\n"
               "  subvol render smoke.vdb -o smoke.png                   the voxels as kernels") {
        app()
            .add_option("FILE", input_, text(input_help(), "; or points (.ply, .vtp, .svk, .vdb), or a .vdb grid of floats"))
            ->required();
        app()
            .add_option("-o,--output", output_, "the picture (.png, or .exr for linear floats), or a turntable's video")
            ->type_name("IMAGE")
            ->required();
        arguments_.add_to(app());
        share_.add_to(app(), "rows of the picture, or some of the frames");
        set_essentials({"--output", "--field", "--look", "--tf", "--opacity", "--background", "--size", "--view", "--views",
                        "--camera", "--turntable", "--legend", "--per-edge", "--method", "--levels", "--json"});
        set_groups();
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        const bool in_bricks = is_bricks_input(input_);
        arguments_.settle(!holds_points(input_) && !is_vdb_file(input_), in_bricks);
        report.if_long(arguments_.method == "dense"      ? "--levels 2, a smaller --size, or --method splat"
                       : is_of_splats(arguments_.method) ? "a smaller --size, a larger --spacing, or fewer --sheets"
                                                         : "a smaller --size, fewer --samples, or --method splat");
        if (asks_for_steps(common()) && !in_bricks) {
            draw_steps(report);
            return 0;
        }
        PictureOutput output(output_, picture_.turntable_frames, picture_);
        set_share(output, picture_.turntable_frames.has_value());
        if (in_bricks) {
            draw_bricks(output, report);
        } else if (arguments_.method != "grid" && holds_points(input_)) {
            draw_points(output, report);
        } else if (arguments_.method == "grid" || is_vdb_file(input_)) {
            draw_voxels(output, report);
        } else {
            draw_mesh(output, report);
        }
        finish(output, report);
        return 0;
    }

private:
    /// Shares are of frames; of a single picture they are of rows, which only splats and tetrahedra can be drawn in.
    void set_share(PictureOutput& output, bool frames) {
        if (!shares(share_)) return;
        const Share share = share_of(share_);
        const bool in_rows = is_of_splats(arguments_.method) ? arguments_.method != "footprints" : arguments_.method == "tets";
        if (!frames && (!in_rows || arguments_.splat.seconds)) {
            throw Error(ErrorCode::InvalidInput, "is not drawn in shares",
                        arguments_.splat.seconds ? "--seconds" : "--method " + arguments_.method,
                        "--method splat or tets, or shares of frames: --turntable N, --step all");
        }
        by_rows_ = !frames;
        if (ranks() == nullptr || frames) {
            output.set_share(share, make_note(app(), input_, share));
        } else if (!ranks()->first()) {
            output.set_silent();
        }
    }

    void finish(PictureOutput& output, Report& report) {
        output.finish(report);
        if (ranks() != nullptr && !by_rows_)
            report["outputs"] = ranks()->gather_list(report.json().value("outputs", Json::array()));
    }

    void set_groups() {
        group("Camera", {"--size", "--camera", "--view", "--views", "--fit", "--ortho", "--turntable", "--fps"});
        group("Cuts", {"--clip", "--clip-box", "--slice", "--around"});
        group("Colours and light", {"--look", "--tf", "--tf-range", "--opacity", "--opacity-unit", "--legend", "--background",
                                    "--shade", "--shadows", "--ambient-occlusion", "--color-field"});
        group("Kernels",
              {"--per-edge", "--centers", "--spacing", "--spacing-voxels", "--tolerance", "--footprint", "--footprint-size",
               "--values", "--kernel", "--value-kernel", "--threshold", "--correction", "--reduce", "--refine"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
        group("Methods", {"--method", "--samples", "--seconds", "--backend", "--device", "--sheets", "--plain-sums",
                          "--tolerance-image", "--order", "--kbuffer", "--lod", "--memory", "--part"});
    }

    /// Lets `draw` make pictures in the colours of the fields, and writes their legend.
    ///
    /// draw: gets the ShownColors
    template <class Draw>
    void show(const Box& box, const ShownField& field, const ShownField& colors, PictureOutput& output, Report& report,
              const Draw& draw) {
        const ShownColors shown{picture_.make_optics(box, field.range, colors.range), picture_.legend_options(field, colors)};
        draw(shown);
        output.set_notes({});  // what they refer to is gone
        if (speaks()) picture_.write_legend(shown.optics, shown.legend, report);
    }

    /// A picture of each step, in one box and with one range of colours: all are read once for these.
    void draw_steps(Report& report) {
        if (picture_.turntable_frames || arguments_.splat.seconds || arguments_.method == "grid") {
            throw Error(ErrorCode::InvalidInput, "steps are drawn without it",
                        picture_.turntable_frames  ? "--turntable"
                        : arguments_.splat.seconds ? "--seconds"
                                                   : "--method grid");
        }
        const MeshSeries series = open_series(input_);
        const FrameRange steps = chosen_steps(series, common());
        PictureOutput output(output_, steps.count(), picture_, steps.first);
        set_share(output, true);
        Box box, seen;
        ShownField field, colors;
        for (int step = steps.first; step <= steps.last; ++step) {
            const ShownMesh of = load_shown_mesh(input_, of_step(common(), step), arguments_, report);
            const bool first = step == steps.first;
            field = first ? of.field() : united(field, of.field());
            colors = first ? of.colors() : united(colors, of.colors());
            box.add(of.box());
            for (const Vec3& p : of.sheets.points) seen.add(p);
        }
        seen.add(box);
        show(box, field, colors, output, report, [&](const ShownColors& shown) {
            std::vector<View> views;
            for (int step = steps.first; step <= steps.last; ++step) {
                if (!output.wants_next()) {
                    output.skip();
                    continue;
                }
                const ShownMesh of = load_shown_mesh(input_, of_step(common(), step), arguments_, report);
                output.set_notes(make_notes(of, shown, arguments_, report));
                if (views.empty()) views = picture_.make_views(seen);
                write_mesh_pictures(of.mesh, views, shown.optics, arguments_, splat_work(), app(), output, report);
            }
        });
        finish(output, report);
        report["times"] = std::vector(series.times.begin() + steps.first, series.times.begin() + steps.last + 1);
    }

    void draw_mesh(PictureOutput& output, Report& report) {
        const ShownMesh of = load_shown_mesh(input_, common(), arguments_, report, ShellsAlone::Take);
        const Box box = of.box();
        show(box, of.field(), of.colors(), output, report, [&](const ShownColors& shown) {
            const std::vector<Vec3>& sheets = of.sheets.points;
            output.set_notes(make_notes(of, shown, arguments_, report));
            Box seen = box;
            for (const Vec3& p : sheets) seen.add(p);
            if (of.mesh.cells.empty()) {
                const auto draw = [](const View& view, Progress*) { return empty_picture(view); };
                return output.write(picture_.make_views(seen, sheets), draw, report);
            }
            std::vector<Vec3> framed = picture_.framed_points(of.mesh, shown.optics);
            if (!framed.empty()) framed.insert(framed.end(), sheets.begin(), sheets.end());
            write_mesh_pictures(of.mesh, picture_.make_views(seen, framed), shown.optics, arguments_, splat_work(), app(),
                                output, report);
        });
    }

    void draw_bricks(PictureOutput& output, Report& report) {
        const bool by_tets = arguments_.method == "tets";
        if (!by_tets && arguments_.method != "splat") {
            throw Error(ErrorCode::InvalidInput, "a folder of bricks is not drawn by this method",
                        "--method " + arguments_.method, "splat or tets");
        }
        if (!by_tets) refuse_options(app(), {"--levels"}, "needs the whole mesh in memory; this is a folder of bricks");
        refuse_options(app(), {"--threshold", "--reduce", "--seconds", "--edges", "--color-field", "--lod"},
                       "needs the whole mesh in memory; this is a folder of bricks");
        const Bricks bricks = report.unpack(open_bricks_input(input_, app()));
        const StreamedField field = report.unpack(select_brick_field(bricks, common()));
        const BrickFields fields = [&](HexMesh brick) { return with_brick_fields(std::move(brick), {field}); };
        const ShownField what{report.json().at("field"), {field.min, field.max}};
        show(bricks.bounds, what, what, output, report, [&](const ShownColors& shown) {
            output.set_notes(make_notes(picture_, shown, nullptr));
            const bool solid = picture_.look == Look::Solid;
            std::optional<BrickHull> hull;
            if (solid || !by_tets) hull = report.timed("hull", [&] { return gather_hull(bricks, fields, report.progress()); });
            const std::vector<View> views = picture_.make_views(bricks.bounds, solid ? hull->mesh.points : std::vector<Vec3>());
            if (by_tets) {
                return write_brick_tets(bricks, fields, std::move(hull), views, shown.optics, arguments_, splat_work().rows,
                                        output, report);
            }
            const RefineOptions refine = arguments_.refine.options(0, report.progress());
            BrickSplatOptions options{.sample = arguments_.sample.options(bricks.bounds, refine),
                                      .splat = arguments_.options,
                                      .memory_bytes = arguments_.memory_bytes};
            options.splat.color_channel.reset();
            options.splat.progress = report.progress();
            BoundaryValues skin;
            if ((!by_rows_ || speaks()) && picture_.paints_boundary(app(), arguments_.refine)) {
                skin = report.timed("boundary", [&] { return boundary_values(*hull, refine.scheme); });
            }
            Surface boundary = report.timed("boundary", [&] { return sample_bricks_boundary(*hull, options.sample); });
            hull.reset();
            write_splats({bricks, fields, options, std::move(boundary), skin, arguments_.reference.samples}, views,
                         shown.optics, splat_work(), output, report);
        });
    }

    /// Rays through voxels, or the voxels as kernels.
    void draw_voxels(PictureOutput& output, Report& report) {
        if (arguments_.method != "grid" && !is_of_splats(arguments_.method)) {
            throw Error(ErrorCode::InvalidInput, "a grid has no cells", "--method " + arguments_.method,
                        "use grid, splat or sheets");
        }
        refuse_mesh_options(app(), "needs a mesh; this is a grid of voxels");
        report["input"] = input_;
        const VdbGrid grid = report.unpack(load_grid(input_, common(), report.progress()));
        const Box box = box_of(grid.report());
        const ShownField field{grid.report().name, {grid.report().min, grid.report().max}};
        show(box, field, field, output, report, [&](const ShownColors& shown) {
            output.set_notes(make_notes(picture_, shown, nullptr));
            if (arguments_.method == "grid") {
                const auto voxels = grid.voxels();
                const auto draw = [&](const View& view, Progress* progress) {
                    return draw_grid(*voxels, view, shown.optics, arguments_.reference, progress, report);
                };
                return output.write(picture_.make_views(box), draw, report);
            }
            const RbfVolume volume =
                report.unpack(sample_reported(grid, arguments_.sample, shown.optics.function(), app(), report.progress()));
            splat(volume, box, shown, output, report);
        });
    }

    /// Of a file with levels of detail each view reads what it needs. Without a boundary, all kernels decide where the volume
    /// ends.
    void draw_points(PictureOutput& output, Report& report) {
        if (!is_of_splats(arguments_.method))
            throw Error(ErrorCode::InvalidInput, "points can only be splatted", "--method " + arguments_.method);
        report["input"] = input_;
        if (holds_levels(input_) && arguments_.reference.lod.value_or(0) > 0) {
            const std::uint64_t kept = picture_.turntable_frames ? arguments_.memory_bytes : 0;
            LevelsInput levels =
                report.unpack(open_levels(input_, common(), arguments_.splat.color_field, kept, app(), report.progress()));
            if (levels.file.contents().boundary_triangles > 0) return draw_levels(levels, output, report);
        }
        const RbfVolume volume =
            report.unpack(load_points(input_, common(), arguments_.splat.color_field, app(), report.progress()));
        if (volume.channels.size() == 1) arguments_.options.color_channel.reset();
        const std::size_t last = volume.channels.size() - 1;
        const ShownField field{volume.channels.front().name, channel_range(volume, 0)};
        const ShownField colors{volume.channels.back().name, channel_range(volume, last)};
        show(volume.bounds, field, colors, output, report, [&](const ShownColors& shown) {
            output.set_notes(make_notes(picture_, shown, nullptr));
            splat(volume, volume.bounds, shown, output, report);
        });
    }

    void draw_levels(LevelsInput& levels, PictureOutput& output, Report& report) {
        const KernelFileContents& contents = levels.file.contents();
        const auto& field = contents.channels[levels.channels.front()];
        const auto& color = contents.channels[levels.channels.back()];
        if (levels.channels.size() == 1) arguments_.options.color_channel.reset();
        show(contents.bounds, {field.name, {field.min, field.max}}, {color.name, {color.min, color.max}}, output, report,
             [&](const ShownColors& shown) {
                 output.set_notes(make_notes(picture_, shown, nullptr));
                 LevelOfDetail level(levels.file, levels.channels, *arguments_.reference.lod);
                 write_splats(level, {}, picture_.make_views(contents.bounds), shown.optics, splat_work(), output, report);
             });
    }

    [[nodiscard]] SplatWork splat_work() const {
        return {arguments_.method, arguments_.options,
                OwnRows{by_rows_ ? std::optional(share_of(share_)) : std::nullopt, ranks()}};
    }

    /// Kernels without a boundary that has its own colours.
    void splat(const RbfVolume& volume, const Box& box, const ShownColors& shown, PictureOutput& output, Report& report) const {
        write_splats(volume, arguments_.reference.lod.value_or(0), {}, picture_.make_views(box), shown.optics, splat_work(),
                     output, report);
    }

    std::string input_;
    std::string output_;
    RenderArguments arguments_;
    PictureArguments& picture_ = arguments_.picture;
    ShareArgument share_;
    bool by_rows_ = false;  // this process draws some rows only
};

}  // namespace

std::unique_ptr<Verb> make_render_verb(CLI::App& program) {
    return std::make_unique<RenderVerb>(program);
}

}  // namespace subvol::cli
