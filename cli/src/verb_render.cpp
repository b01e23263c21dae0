#include "input.h"
#include "picture_arguments.h"
#include "picture_output.h"
#include "points_input.h"
#include "sample_arguments.h"
#include "subvol/error.h"
#include "subvol/render.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kTetsLevel = 1;

Backend backend_named(const std::string& name) {
    check_choice("--backend", name, {"auto", "gl", "cpu"});
    return name == "gl" ? Backend::Gl : name == "cpu" ? Backend::Cpu : Backend::Auto;
}

class RenderVerb : public Verb {
public:
    explicit RenderVerb(CLI::App& program)
        : Verb(program, "render", "Make a picture.",
               "  subvol render model:ball -o ball.png\n"
               "  subvol render model:ball -o side.exr --view -y --size 1024x768 --tf coolwarm\n"
               "  subvol render model:ball -o turn.mp4 --turntable 120 --legend turn.svg\n"
               "  subvol render model:ball -o reference.exr --method tets --levels 2 --samples 2") {
        app().add_option("FILE", input_, text(kInputHelp, "; or points (.ply, .vtp, .vdb)"))->required();
        app()
            .add_option("-o,--output", output_, "the picture (.png, or .exr for linear floats), or a turntable's video")
            ->type_name("IMAGE")
            ->required();
        app()
            .add_option("--method", method_,
                        "splat (kernels, the default), sheets (the same by OpenGL sheet buffers) or\n"
                        "tets (rays through tetrahedra)")
            ->type_name("NAME");
        app().add_option("--backend", backend_, "where to splat: auto (default), gl, cpu")->type_name("NAME");
        picture_.add_to(app());
        app()
            .add_option("--sheets", sheets_, "splat, sheets: planes over the volume's depth (default 200)")
            ->type_name("N")
            ->check(CLI::Range(2, 65536));
        app()
            .add_option("--samples", samples_, "tets: n x n rays a pixel (default 1)")
            ->type_name("N")
            ->check(CLI::Range(1, 16));
        sample_.add_to(app());
        refine_.add_to(app(), "show the refined mesh of this level (tets: default 1; else: omitted shows the limit)");
    }

    int run(Report& report) override {
        check_choice("--method", method_, {"splat", "sheets", "tets"}, {"dense", "grid", "pt"});
        const Backend backend = backend_named(backend_);
        if (method_ == "tets" && backend == Backend::Gl) {
            throw Error(ErrorCode::InvalidInput, "tets are drawn by the CPU only", "--backend gl");
        }
        if (method_ == "sheets" && backend == Backend::Cpu) {
            throw Error(ErrorCode::InvalidInput, "sheets are drawn by OpenGL only", "--backend cpu", "auto or gl");
        }
        picture_.check_legend();
        PictureOutput output(output_, picture_.turntable_frames, picture_);
        if (holds_points(input_)) {
            draw_points(backend, output, report);
        } else {
            draw_mesh(backend, output, report);
        }
        return 0;
    }

private:
    void draw_mesh(Backend backend, PictureOutput& output, Report& report) {
        const HexMesh mesh = with_selected_field(load_mesh(input_, common(), report), common(), report);
        const Box box = bounds(mesh);
        const std::vector<View> views = picture_.make_views(box);
        const Range range = first_field_range(mesh);
        const Optics optics = picture_.make_optics(box, range);
        picture_.write_legend(optics, range, report);
        if (method_ == "tets") {
            const HexMesh fine = refine_reported(mesh, refine_.options(kTetsLevel, report), Vertices::OnTheLimit, report);
            output.write(
                views, [&](const View& view, Progress* progress) { return tets(fine, view, optics, progress, report); },
                report);
        } else {
            splat(sample_reported(mesh, sample_, refine_, optics.function(), report), views, optics, backend, output, report);
        }
    }

    void draw_points(Backend backend, PictureOutput& output, Report& report) {
        if (method_ == "tets") throw Error(ErrorCode::InvalidInput, "points can only be splatted", "--method " + method_);
        const RbfVolume volume = load_points(input_, common(), app(), report);
        const std::vector<View> views = picture_.make_views(volume.bounds);
        const Range range = first_channel_range(volume);
        const Optics optics = picture_.make_optics(volume.bounds, range);
        picture_.write_legend(optics, range, report);
        splat(volume, views, optics, backend, output, report);
    }

    void splat(const RbfVolume& volume, const std::vector<View>& views, const Optics& optics, Backend backend,
               PictureOutput& output, Report& report) const {
        const auto draw = [&](const View& view, Progress* progress) {
            SplatResult drawn = render_splats(volume, view, optics,
                                              {.method = method_ == "sheets" ? SplatMethod::Sheets : SplatMethod::Kernels,
                                               .backend = backend,
                                               .sheets = sheets_,
                                               .progress = progress});
            report.add_seconds("prepare", drawn.report.seconds_prepare);
            report.add_seconds("draw", drawn.report.seconds_draw);
            report["method"] = method_;
            report["backend"] = drawn.report.backend;
            report["device"] = drawn.report.device;
            report["sheets"] = sheets_;
            return Picture{std::move(drawn.image)};
        };
        output.write(views, draw, report);
    }

    [[nodiscard]] Picture tets(const HexMesh& mesh, const View& view, const Optics& optics, Progress* progress,
                               Report& report) const {
        TetsResult drawn =
            render_tets(mesh, mesh.attributes.front().values, view, optics, {.samples = samples_, .progress = progress});
        report.add_seconds("prepare", drawn.report.seconds_build);
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

    std::string input_;
    std::string output_;
    std::string method_ = "splat";
    std::string backend_ = "auto";
    int sheets_ = 200;
    int samples_ = 1;
    PictureArguments picture_;
    SampleArguments sample_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_render_verb(CLI::App& program) {
    return std::make_unique<RenderVerb>(program);
}

}  // namespace subvol::cli
