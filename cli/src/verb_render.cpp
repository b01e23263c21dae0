#include "grid_input.h"
#include "input.h"
#include "picture_arguments.h"
#include "picture_output.h"
#include "points_input.h"
#include "sample_arguments.h"
#include "splat_arguments.h"
#include "subvol/error.h"
#include "subvol/progressive.h"
#include "subvol/render.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_pt.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kTetsLevel = 1;

class RenderVerb : public Verb {
public:
    explicit RenderVerb(CLI::App& program)
        : Verb(program, "render", "Make a picture.",
               "  subvol render model:ball -o ball.png\n"
               "  subvol render model:ball -o side.exr --view -y --size 1024x768 --tf coolwarm\n"
               "  subvol render model:ball -o turn.mp4 --turntable 120 --legend turn.svg\n"
               "  subvol render model:ball -o reference.exr --method tets --levels 2 --samples 2\n"
               "  subvol render smoke.vdb -o smoke.png --method grid") {
        app().add_option("FILE", input_, text(kInputHelp, "; or points (.ply, .vtp, .vdb); grid: a .vdb grid"))->required();
        app()
            .add_option("-o,--output", output_, "the picture (.png, or .exr for linear floats), or a turntable's video")
            ->type_name("IMAGE")
            ->required();
        app()
            .add_option("--method", method_,
                        "splat (kernels, the default), sheets (the same by OpenGL sheet buffers),\n"
                        "tets (rays through tetrahedra), pt (the same tetrahedra projected by OpenGL),\n"
                        "dense (rays through the dense grids of the limit) or\n"
                        "grid (rays through a .vdb file's voxels)")
            ->type_name("NAME");
        picture_.add_to(app());
        app()
            .add_option("--samples", samples_, "tets, dense, grid: n x n rays a pixel (default 1)")
            ->type_name("N")
            ->check(CLI::Range(1, 16));
        app()
            .add_option("--tolerance-image", image_tolerance_,
                        "dense, without --levels: raise the level until the RMS of the picture's change is less (default 1e-3)")
            ->type_name("RMS")
            ->check(CLI::PositiveNumber);
        app()
            .add_option("--order", order_,
                        "pt: what sorts the tetrahedra: topological (shared faces, the default), centroid, or\n"
                        "lists (every pixel its own)")
            ->type_name("NAME");
        sample_.add_to(app());
        refine_.add_to(app(), "show the refined mesh of this level (tets, pt: default 1; else: omitted shows the limit)");
        splat_.add_to(app());
    }

    int run(Report& report) override {
        check_choice("--method", method_, {"splat", "sheets", "tets", "pt", "dense", "grid"});
        check_choice("--order", order_, {"topological", "centroid", "lists"});
        options_ = splat_.options();
        if (method_ == "sheets") options_.method = SplatMethod::Sheets;
        if (method_ == "sheets" && options_.backend == Backend::Cpu) {
            throw Error(ErrorCode::InvalidInput, "sheets are drawn by OpenGL only", "--backend cpu", "auto or gl");
        }
        const bool by_rays = method_ == "tets" || method_ == "dense" || method_ == "grid";
        if (by_rays && (options_.backend == Backend::Gl || splat_.shade || splat_.color_field || splat_.seconds)) {
            throw Error(ErrorCode::InvalidInput, method_ + ": drawn by the CPU, without light and of one field",
                        "--backend gl, --shade, --color-field, --seconds");
        }
        if (method_ == "pt" && (options_.backend == Backend::Cpu || splat_.shade || splat_.color_field || splat_.seconds)) {
            throw Error(ErrorCode::InvalidInput, "tetrahedra are projected by OpenGL, without light and of one field",
                        "--backend cpu, --shade, --color-field, --seconds");
        }
        picture_.check_legend();
        PictureOutput output(output_, picture_.turntable_frames, picture_);
        if (method_ == "grid") {
            draw_grid(output, report);
        } else if (holds_points(input_)) {
            draw_points(output, report);
        } else {
            draw_mesh(output, report);
        }
        return 0;
    }

private:
    void draw_mesh(PictureOutput& output, Report& report) {
        const HexMesh mesh = with_selected_field(load_mesh(input_, common(), report), common(), report, splat_.color_field);
        if (mesh.attributes.size() == 1) options_.color_channel.reset();  // the colours' field is the field itself
        const Box box = bounds(mesh);
        const std::vector<View> views = picture_.make_views(box);
        const Range range = field_range(mesh, 0), colors = field_range(mesh, mesh.attributes.size() - 1);
        const Optics optics = picture_.make_optics(box, range, colors);
        if (method_ == "tets" || method_ == "pt") {
            const HexMesh fine = refine_reported(mesh, refine_.options(kTetsLevel, report), Vertices::OnTheLimit, report);
            const TetsRenderer renderer(fine, fine.attributes.front().values);
            report.add_seconds("prepare", renderer.seconds_build());
            const auto draw = [&](const View& view, Progress* progress) {
                return method_ == "pt" ? projected_tets(fine, view, optics, progress, report)
                                       : tets(renderer, view, optics, progress, report);
            };
            output.write(views, draw, report);
        } else if (method_ == "dense") {
            const RefineOptions refine = refine_.options(0, report);
            const auto draw = [&](const View& view, Progress* progress) {
                return dense(mesh, refine, view, optics, progress, report);
            };
            output.write(views, draw, report);
        } else if (splat_.seconds) {
            splat_in_time(mesh, views.front(), optics, output, report);
        } else {
            splat(sample_reported(mesh, sample_, refine_, optics.function(), report), views, optics, output, report);
        }
        picture_.write_legend(optics, colors, report);
    }

    void draw_grid(PictureOutput& output, Report& report) {
        const VdbGrid grid = load_grid(input_, common(), report);
        const Box box = box_of(grid.report());
        const Range range{grid.report().min, grid.report().max};
        const Optics optics = picture_.make_optics(box, range, range);
        const auto voxels = grid.voxels();
        const auto draw = [&](const View& view, Progress* progress) {
            GridResult drawn = render_grid(*voxels, view, optics, {.samples = samples_, .progress = progress});
            report.add_seconds("draw", drawn.report.seconds_draw);
            report["method"] = method_;
            report["backend"] = "cpu";
            report["rays"] = drawn.report.rays;
            report["cells"] = drawn.report.cells;
            report["blocks"] = drawn.report.blocks;
            return Picture{std::move(drawn.image)};
        };
        output.write(picture_.make_views(box), draw, report);
        picture_.write_legend(optics, range, report);
    }

    void draw_points(PictureOutput& output, Report& report) {
        if (method_ == "tets" || method_ == "pt" || method_ == "dense")
            throw Error(ErrorCode::InvalidInput, "points can only be splatted", "--method " + method_);
        const RbfVolume volume = load_points(input_, common(), splat_.color_field, app(), report);
        if (volume.channels.size() == 1) options_.color_channel.reset();
        const std::vector<View> views = picture_.make_views(volume.bounds);
        const Range range = channel_range(volume, 0), colors = channel_range(volume, volume.channels.size() - 1);
        const Optics optics = picture_.make_optics(volume.bounds, range, colors);
        splat(volume, views, optics, output, report);
        picture_.write_legend(optics, colors, report);
    }

    void splat(const RbfVolume& volume, const std::vector<View>& views, const Optics& optics, PictureOutput& output,
               Report& report) const {
        Splatter splatter(volume, options_);
        const auto draw = [&](const View& view, Progress* progress) {
            SplatResult drawn = splatter.draw(view, optics, progress);
            report["method"] = method_;
            report_splats(drawn.report, splat_, report);
            return Picture{std::move(drawn.image), std::move(drawn.depth)};
        };
        output.write(views, draw, report);
    }

    void splat_in_time(const HexMesh& mesh, const View& view, const Optics& optics, PictureOutput& output,
                       Report& report) const {
        const auto draw = [&](const View&, Progress* progress) {
            const SampleOptions sample = sample_.options(bounds(mesh), refine_.options(0, report));
            ProgressiveResult drawn = render_progressively(
                mesh, view, optics, {.seconds = *splat_.seconds, .sample = sample, .splat = options_, .progress = progress});
            report["method"] = method_;
            report_splats(drawn.splat.report, splat_, report);
            report["points"] = drawn.splat.report.points;
            report["steps"] = drawn.steps;
            report["picture_scale"] = drawn.picture_scale;
            report["footprint_px"] = drawn.footprint_px;
            return Picture{std::move(drawn.splat.image), std::move(drawn.splat.depth)};
        };
        output.write({view}, draw, report);
    }

    [[nodiscard]] Picture tets(const TetsRenderer& renderer, const View& view, const Optics& optics, Progress* progress,
                               Report& report) const {
        TetsResult drawn = renderer.draw(view, optics, {.samples = samples_, .progress = progress});
        report.add_seconds("draw", drawn.report.seconds_draw);
        report["method"] = method_;
        report["backend"] = "cpu";
        report["tets"] = drawn.report.tets;
        report["degenerate_tets"] = drawn.report.degenerate_tets;
        report["inverted_tets"] = drawn.report.inverted_tets;
        report["rays"] = drawn.report.rays;
        report["lost_rays"] = drawn.report.lost_rays;
        if (drawn.report.lost_rays > 0) report.warn(text(drawn.report.lost_rays, " rays were lost inside the mesh"));
        return Picture{std::move(drawn.image)};
    }

    [[nodiscard]] Picture dense(const HexMesh& mesh, const RefineOptions& refine, const View& view, const Optics& optics,
                                Progress* progress, Report& report) const {
        DenseResult drawn = render_dense(mesh, mesh.attributes.front().values, view, optics,
                                         {.refine = refine,
                                          .levels = refine_.levels,
                                          .image_tolerance = image_tolerance_,
                                          .samples = samples_,
                                          .progress = progress});
        report.add_seconds("prepare", drawn.report.seconds_build);
        report.add_seconds("draw", drawn.report.seconds_draw);
        report["method"] = method_;
        report["backend"] = "cpu";
        report["levels"] = drawn.report.levels;
        if (drawn.report.image_change) report["image_change"] = *drawn.report.image_change;
        report["blocks"] = drawn.report.blocks;
        report["skipped_blocks"] = drawn.report.skipped_blocks;
        report["micro_cells"] = drawn.report.micro_cells;
        report["passes"] = drawn.report.passes;
        report["bytes"] = drawn.report.bytes;
        report["rays"] = drawn.report.rays;
        report["lost_rays"] = drawn.report.lost_rays;
        if (!refine_.levels && !drawn.report.converged) {
            report.warn(text("the picture still changes by ", drawn.report.image_change.value_or(0), " at level ",
                             drawn.report.levels, ": --levels draws a finer one"));
        }
        if (drawn.report.lost_rays > 0) report.warn(text(drawn.report.lost_rays, " rays were lost inside the mesh"));
        return Picture{std::move(drawn.image)};
    }

    [[nodiscard]] Picture projected_tets(const HexMesh& mesh, const View& view, const Optics& optics, Progress* progress,
                                         Report& report) const {
        const PtOrder order = order_ == "lists"      ? PtOrder::Lists
                              : order_ == "centroid" ? PtOrder::Centroid
                                                     : PtOrder::Topological;
        PtResult drawn = render_projected_tets(mesh, mesh.attributes.front().values, view, optics,
                                               {.order = order, .device = splat_.device, .progress = progress});
        const PtReport& pt = drawn.report;
        report.add_seconds("prepare", pt.seconds_build);
        report.add_seconds("sort", pt.seconds_sort);
        report.add_seconds("draw", pt.seconds_draw);
        report["method"] = method_;
        report["backend"] = "gl";
        report["device"] = pt.device;
        report["order"] = order_;
        report["tets"] = pt.tets;
        report["degenerate_tets"] = pt.degenerate_tets;
        report["inverted_tets"] = pt.inverted_tets;
        if (order == PtOrder::Topological) report["cycles"] = pt.cycles;
        if (order == PtOrder::Lists) report["fragments"] = pt.fragments;
        if (pt.violations) report["order_violations"] = *pt.violations;
        if (pt.cycles > 0) report.warn(text("the order of the tetrahedra has cycles, broken ", pt.cycles, " times"));
        return Picture{std::move(drawn.image)};
    }

    std::string input_;
    std::string output_;
    std::string method_ = "splat";
    std::string order_ = "topological";
    int samples_ = 1;
    double image_tolerance_ = 1e-3;
    PictureArguments picture_;
    SampleArguments sample_;
    SplatArguments splat_;
    SplatOptions options_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_render_verb(CLI::App& program) {
    return std::make_unique<RenderVerb>(program);
}

}  // namespace subvol::cli
