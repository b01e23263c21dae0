// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "bricks_input.h"
#include "choices.h"
#include "clip_arguments.h"
#include "grid_input.h"
#include "input.h"
#include "part_note.h"
#include "picture_arguments.h"
#include "picture_output.h"
#include "points_input.h"
#include "rank_report.h"
#include "reference_arguments.h"
#include "reference_pictures.h"
#include "render_method.h"
#include "sampled_points.h"
#include "share.h"
#include "sheet_scene.h"
#include "splat_arguments.h"
#include "splat_pictures.h"
#include "steps.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/error.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kTetsLevel = 1;

/// mesh: or sheets
template <class Points>
void check_coordinates(const Points& mesh) {
    constexpr double kMost_world = 1e18;  // as of splats; far beyond it, squares and volumes overflow
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3 x = glm::abs(mesh.points[p]);
        const double largest = std::max({x.x, x.y, x.z});
        if (largest <= kMost_world) continue;
        throw Error(ErrorCode::InvalidInput, text("point ", p, " has the coordinate ", largest), {},
                    "at most 1e18 can be drawn");
    }
}

class RenderVerb : public Verb {
public:
    explicit RenderVerb(CLI::App& program)
        : Verb(program, "render", "Make a picture.",
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
        app()
            .add_option("--method", method_,
                        "splat (kernels, the default), sheets (the same by OpenGL sheet buffers), "
                        "footprints (kernels coloured first), tets (rays through tetrahedra), "
                        "pt (the same tetrahedra projected by OpenGL), dense (rays through the limit's cells) or "
                        "grid (rays through a .vdb file's voxels)")
            ->type_name("NAME")
            ->check(offered({"splat", "sheets", "footprints", "tets", "pt", "dense", "grid"}));
        picture_.add_to(app());
        clip_.add_to(app());
        reference_.add_to(app());
        sample_.add_to(app());
        refine_.add_to(app(), "draw the refined mesh of this level (default for tets and pt: 1; for the others: the limit)");
        splat_.add_to(app());
        app()
            .add_option("--memory", memory_bytes_,
                        "of bricks: what kernels take while a part of the picture is drawn; of .svk files with --lod: "
                        "what is kept for the next frame (default 1G)")
            ->type_name("BYTES")
            ->transform(CLI::AsSizeValue(false));
        share_.add_to(app(), "rows of the picture, or some of the frames");
        set_essentials({"--output", "--field", "--look", "--tf", "--opacity", "--background", "--size", "--view", "--views",
                        "--camera", "--turntable", "--legend", "--per-edge", "--method", "--levels", "--json"});
        set_groups();
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        check_choice("--method", method_, {"splat", "sheets", "footprints", "tets", "pt", "dense", "grid"});
        options_ = splat_.options(method_);
        picture_.settle_look(!holds_points(input_) && !is_vdb_file(input_) && !splat_.shade);
        if (reference_.samples == 0) reference_.samples = picture_.look == Look::Solid ? 2 : 1;
        options_.samples = reference_.samples;
        options_.clip = reference_.clip = clip_.clip();
        if (picture_.lit()) options_.shading = Shading{};
        if (!is_bricks_input(input_)) tets_ = TetRefinement(refine_);
        check_method(method_, picture_, splat_, reference_);
        picture_.check();
        report.if_long(method_ == "dense"      ? "--levels 2, a smaller --size, or --method splat"
                       : is_of_splats(method_) ? "a smaller --size, a larger --spacing, or fewer --sheets"
                                               : "a smaller --size, fewer --samples, or --method splat");
        if (asks_for_steps(common()) && !is_bricks_input(input_)) {
            draw_steps(report);
            return 0;
        }
        PictureOutput output(output_, picture_.turntable_frames, picture_);
        set_share(output, picture_.turntable_frames.has_value());
        if (is_bricks_input(input_)) {
            draw_bricks(output, report);
        } else if (method_ == "grid") {
            draw_voxels(output, report);
        } else if (holds_points(input_)) {
            draw_points(output, report);
        } else if (is_vdb_file(input_)) {
            draw_voxels(output, report);
        } else {
            draw_mesh(output, report);
        }
        finish(output, report);
        return 0;
    }

private:
    /// Shares are of frames; of a single picture they are of rows, which only splats can be drawn in.
    void set_share(PictureOutput& output, bool frames) {
        if (!shares(share_)) return;
        const Share share = share_of(share_);
        if (!frames && (!is_of_splats(method_) || method_ == "footprints" || splat_.seconds)) {
            throw Error(ErrorCode::InvalidInput, "is not drawn in shares", splat_.seconds ? "--seconds" : "--method " + method_,
                        "--method splat, or shares of frames: --turntable N, --step all");
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
        if (ranks() != nullptr && !by_rows_) gather_list(*ranks(), report, "outputs");
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

    /// sheets: gets those of the mesh, with all their fields
    /// alone:  Take: of sheets without cells the mesh has points alone
    [[nodiscard]] HexMesh shown_mesh(const CommonOptions& options, Report& report, Sheets& sheets,
                                     SheetsAlone alone = SheetsAlone::Refuse) const {
        Sheets* const wanted = tets_.asked() ? nullptr : &sheets;  // tetrahedra are refined by other rules
        if (tets_.asked()) alone = SheetsAlone::Refuse;
        HexMesh mesh =
            with_selected_field(load_mesh(input_, options, report, wanted, alone), options, report, splat_.color_field);
        mesh = tets_.hexes(std::move(mesh), is_of_splats(method_) ? 1 : 2, report);
        check_coordinates(mesh);
        check_coordinates(sheets);
        return mesh;
    }

    /// A picture of each step, in one box and with one range of colours: all are read once for these.
    void draw_steps(Report& report) {
        if (picture_.turntable_frames || splat_.seconds || method_ == "grid") {
            throw Error(ErrorCode::InvalidInput, "steps are drawn without it",
                        picture_.turntable_frames ? "--turntable"
                        : splat_.seconds          ? "--seconds"
                                                  : "--method grid");
        }
        const MeshSeries series = open_series(input_);
        const FrameRange steps = chosen_steps(series, common());
        PictureOutput output(output_, steps.count(), picture_, steps.first);
        set_share(output, true);
        Box box, seen;
        Range range, colors;
        std::string field_name, color_name;
        for (int step = steps.first; step <= steps.last; ++step) {
            Sheets sheets;
            const HexMesh mesh = shown_mesh(of_step(common(), step), report, sheets);
            const Range field = field_range(mesh, 0), color = field_range(mesh, mesh.attributes.size() - 1);
            const bool first = step == steps.first;
            range = first ? field : Range{std::min(range.min, field.min), std::max(range.max, field.max)};
            colors = first ? color : Range{std::min(colors.min, color.min), std::max(colors.max, color.max)};
            box.add(bounds(mesh));
            for (const Vec3& p : sheets.points) seen.add(p);
            field_name = mesh.attributes.front().name;
            color_name = mesh.attributes.back().name;
        }
        const Optics optics = picture_.make_optics(box, range, colors);
        seen.add(box);
        const LegendOptions legend = picture_.legend_options({field_name, range}, {color_name, colors});
        std::vector<View> views;
        for (int step = steps.first; step <= steps.last; ++step) {
            if (!output.wants_next()) {
                output.skip();
                continue;
            }
            Sheets sheets;
            const HexMesh mesh = shown_mesh(of_step(common(), step), report, sheets);
            PictureNotes notes = make_notes(picture_, optics, legend, &mesh);
            notes.sheets = sheet_scene(mesh, sheets, optics, report);
            if (views.empty()) views = picture_.make_views(seen);
            output.set_notes(std::move(notes));
            draw(mesh, views, optics, output, report);
        }
        output.set_notes({});  // the last mesh is gone
        finish(output, report);
        report["times"] = std::vector(series.times.begin() + steps.first, series.times.begin() + steps.last + 1);
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    void draw_mesh(PictureOutput& output, Report& report) {
        Sheets sheets;
        const HexMesh mesh = shown_mesh(common(), report, sheets, SheetsAlone::Take);
        Box box = bounds(mesh);
        if (mesh.cells.empty()) {
            for (const Vec3& p : mesh.points) box.add(p);
        }
        const Range range = field_range(mesh, 0), colors = field_range(mesh, mesh.attributes.size() - 1);
        const Optics optics = picture_.make_optics(box, range, colors);
        const LegendOptions legend =
            picture_.legend_options({mesh.attributes.front().name, range}, {mesh.attributes.back().name, colors});
        PictureNotes notes = make_notes(picture_, optics, legend, &mesh);
        notes.sheets = sheet_scene(mesh, sheets, optics, report);
        output.set_notes(std::move(notes));
        Box seen = box;
        for (const Vec3& p : sheets.points) seen.add(p);
        if (mesh.cells.empty()) {
            output.write(picture_.make_views(seen, sheets.points), empty_picture, report);
        } else {
            std::vector<Vec3> framed = picture_.framed_points(mesh, optics);
            if (!framed.empty()) framed.insert(framed.end(), sheets.points.begin(), sheets.points.end());
            draw(mesh, picture_.make_views(seen, framed), optics, output, report);
        }
        output.set_notes({});
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    /// Where sheets without cells are drawn.
    static Picture empty_picture(const View& view, Progress*) {
        Picture picture{Image(view.width(), view.height()), {}};
        picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
        return picture;
    }

    [[nodiscard]] std::shared_ptr<const SheetScene> sheet_scene(const HexMesh& mesh, const Sheets& sheets, const Optics& optics,
                                                                Report& report) const {
        if (sheets.empty()) return nullptr;
        return make_sheet_scene(mesh, sheets, refine_.options(0, report), refine_.levels, optics, reference_.samples,
                                options_.clip, report);
    }

    void draw(const HexMesh& mesh, const std::vector<View>& views, const Optics& optics, PictureOutput& output,
              Report& report) {
        if (mesh.attributes.size() == 1) options_.color_channel.reset();  // the field of the colours is --field itself
        if (method_ == "tets" || method_ == "pt") {
            const HexMesh fine = refine_reported(mesh, refine_.options(kTetsLevel, report), Vertices::OnTheLimit, report);
            const Surface boundary = skin_of(mesh, report).surface;
            if (method_ == "tets") {
                write_tets(fine, boundary, views, optics, reference_, output, report);
            } else {
                write_projected_tets(fine, boundary, views, optics, reference_, splat_.device, splat_.seconds, output, report);
            }
        } else if (method_ == "dense") {
            const RefineOptions refine = refine_.options(0, report);
            const auto draw = [&](const View& view, Progress* progress) {
                return draw_dense(mesh, refine, refine_.levels, view, optics, reference_, progress, report);
            };
            output.write(views, lit(draw, skin_of(mesh, report).surface, reference_), report);
        } else if (splat_.seconds) {
            const SampleOptions sample = sample_.options(bounds(mesh), refine_.options(0, report));
            write_splats_in_time(mesh, sample, *splat_.seconds, views.front(), optics, splat_work(), output, report);
        } else {
            BoundaryValues skin;
            // Shadows and occlusion are those of the kernels: the boundary's own colours have none.
            const bool own_light = splat_.shadows || splat_.ambient_occlusion > 0;
            if (!own_light && picture_.paints_boundary(app(), refine_)) skin = skin_of(mesh, report);
            const RbfVolume volume = tets_.asked() ? sample_tets_reported(mesh, sample_, optics.function(), report)
                                                   : sample_reported(mesh, sample_, refine_, optics.function(), report);
            splat(volume, skin, views, optics, output, report);
        }
    }

    void draw_bricks(PictureOutput& output, Report& report) {
        if (method_ != "splat") {
            throw Error(ErrorCode::InvalidInput, "a folder of bricks can only be splatted", "--method " + method_, "splat");
        }
        refuse_options(app(), {"--levels", "--threshold", "--reduce", "--seconds", "--edges", "--color-field", "--lod"},
                       "needs the whole mesh in memory; this is a folder of bricks");
        const Bricks bricks = open_bricks_input(input_, app(), report);
        const StreamedField field = select_brick_field(bricks, common(), report);
        const BrickFields fields = [&](HexMesh brick) { return with_brick_fields(std::move(brick), {field}); };
        const Range range{field.min, field.max};
        const Optics optics = picture_.make_optics(bricks.bounds, range, range);
        const std::string name = report.json().at("field");
        const LegendOptions legend = picture_.legend_options({name, range}, {name, range});
        output.set_notes(make_notes(picture_, optics, legend, nullptr));
        std::optional<BrickHull> hull = report.timed("hull", [&] { return gather_hull(bricks, fields, report.progress()); });
        const std::vector<View> views =
            picture_.make_views(bricks.bounds, picture_.look == Look::Solid ? hull->mesh.points : std::vector<Vec3>());
        const RefineOptions refine = refine_.options(0, report);
        BrickSplatOptions options{
            .sample = sample_.options(bricks.bounds, refine), .splat = options_, .memory_bytes = memory_bytes_};
        options.splat.color_channel.reset();
        options.splat.progress = report.progress();
        BoundaryValues skin;
        if ((!by_rows_ || speaks()) && picture_.paints_boundary(app(), refine_)) {
            skin = report.timed("boundary", [&] { return boundary_values(*hull, refine.scheme); });
        }
        Surface boundary = report.timed("boundary", [&] { return sample_bricks_boundary(*hull, options.sample); });
        hull.reset();
        write_splats({bricks, fields, options, std::move(boundary), skin, reference_.samples}, views, optics, splat_work(),
                     output, report);
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    /// The surface that is lit, if there is light, and the values on it.
    [[nodiscard]] BoundaryValues skin_of(const HexMesh& mesh, Report& report) const {
        if (!picture_.lit()) return {};
        if (picture_.look != Look::Solid) {
            throw Error(ErrorCode::InvalidInput, "method " + method_ + " lights the boundary only", "--look isosurface",
                        "use --method splat or sheets, or --tf isosurface for surfaces without light");
        }
        const int levels = picture_levels(mesh, tets_.asked() ? std::optional(0) : refine_.levels);
        RefineOptions options = refine_.options(levels, report);
        options.levels = levels;
        return report.timed("boundary", [&] { return boundary_values(mesh, options); });
    }

    /// Rays through voxels, or the voxels as kernels.
    void draw_voxels(PictureOutput& output, Report& report) {
        if (method_ != "grid" && !is_of_splats(method_)) {
            throw Error(ErrorCode::InvalidInput, "a grid has no cells", "--method " + method_, "use grid, splat or sheets");
        }
        const VdbGrid grid = load_grid(input_, common(), report);
        const Box box = box_of(grid.report());
        const Range range{grid.report().min, grid.report().max};
        const Optics optics = picture_.make_optics(box, range, range);
        const LegendOptions legend = picture_.legend_options({grid.report().name, range}, {grid.report().name, range});
        output.set_notes(make_notes(picture_, optics, legend, nullptr));
        if (method_ == "grid") {
            const auto voxels = grid.voxels();
            const auto draw = [&](const View& view, Progress* progress) {
                return draw_grid(*voxels, view, optics, reference_, progress, report);
            };
            output.write(picture_.make_views(box), draw, report);
        } else {
            const RbfVolume volume = sample_reported(grid, sample_, optics.function(), app(), report);
            splat(volume, {}, picture_.make_views(box), optics, output, report);
        }
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    /// Of a file with levels of detail each view reads what it needs. Without a boundary, all kernels decide where the volume
    /// ends.
    void draw_points(PictureOutput& output, Report& report) {
        if (!is_of_splats(method_)) throw Error(ErrorCode::InvalidInput, "points can only be splatted", "--method " + method_);
        if (holds_levels(input_) && reference_.lod.value_or(0) > 0) {
            const std::uint64_t kept = picture_.turntable_frames ? memory_bytes_ : 0;
            LevelsInput levels = open_levels(input_, common(), splat_.color_field, kept, app(), report);
            if (levels.file.contents().boundary_triangles > 0) return draw_levels(levels, output, report);
        }
        const RbfVolume volume = load_points(input_, common(), splat_.color_field, app(), report);
        if (volume.channels.size() == 1) options_.color_channel.reset();
        const Range range = channel_range(volume, 0), colors = channel_range(volume, volume.channels.size() - 1);
        const Optics optics = picture_.make_optics(volume.bounds, range, colors);
        const LegendOptions legend =
            picture_.legend_options({volume.channels.front().name, range}, {volume.channels.back().name, colors});
        output.set_notes(make_notes(picture_, optics, legend, nullptr));
        splat(volume, {}, picture_.make_views(volume.bounds), optics, output, report);
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    void draw_levels(LevelsInput& levels, PictureOutput& output, Report& report) {
        const KernelFileContents& contents = levels.file.contents();
        const auto& field = contents.channels[levels.channels.front()];
        const auto& color = contents.channels[levels.channels.back()];
        const Range range{field.min, field.max}, colors{color.min, color.max};
        if (levels.channels.size() == 1) options_.color_channel.reset();
        const Optics optics = picture_.make_optics(contents.bounds, range, colors);
        const LegendOptions legend = picture_.legend_options({field.name, range}, {color.name, colors});
        output.set_notes(make_notes(picture_, optics, legend, nullptr));
        LevelOfDetail shown(levels.file, levels.channels, *reference_.lod);
        write_splats(shown, {}, picture_.make_views(contents.bounds), optics, splat_work(), output, report);
        if (speaks()) picture_.write_legend(optics, legend, report);
    }

    [[nodiscard]] SplatWork splat_work() const {
        return {method_, options_, by_rows_ ? std::optional(share_of(share_)) : std::nullopt, ranks()};
    }

    void splat(const RbfVolume& volume, const BoundaryValues& skin, const std::vector<View>& views, const Optics& optics,
               PictureOutput& output, Report& report) const {
        const SplatWork work = splat_work();
        LevelOfDetail levels(volume, reference_.lod.value_or(0), work.options.channel, report);
        write_splats(levels, skin, views, optics, work, output, report);
    }

    std::string input_;
    std::string output_;
    std::uint64_t memory_bytes_ = std::uint64_t{1} << 30;
    std::string method_ = "splat";
    PictureArguments picture_;
    ReferenceArguments reference_;
    SampleArguments sample_;
    ClipArguments clip_;
    SplatArguments splat_;
    SplatOptions options_;
    RefineArguments refine_;
    ShareArgument share_;
    bool by_rows_ = false;  // this process draws some rows only
    TetRefinement tets_;
};

}  // namespace

std::unique_ptr<Verb> make_render_verb(CLI::App& program) {
    return std::make_unique<RenderVerb>(program);
}

}  // namespace subvol::cli
