// SPDX-License-Identifier: Apache-2.0
// The verb `demo`: the whole way from a generated model to a judged picture, for three models.
//
//     model ─┬─► kernels ─► splats ───────────────────────┐
//            ├─► lit picture, as the verb `render` draws  ├─► PSNR, map of the difference
//            └─► refined mesh ─┬─► rays through tetrahedra┘
//                              └─► grid of voxels
//
// The mesh is refined as often as its cells stay below a bound, as the memory of the rays grows with them. Seconds of each
// stage, counts and names of files go into a summary in JSON, and into a page that shows the pictures of each model in a row.
#include <sys/utsname.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <iomanip>

#include "input.h"
#include "options.h"
#include "outputs.h"
#include "picture_arguments.h"
#include "quantities.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/picture_maker.h"
#include "subvol/rasterize.h"
#include "subvol/render_tets.h"
#include "subvol/sample.h"
#include "subvol/splat.h"
#include "subvol/study_run.h"
#include "subvol/vdb_grid.h"
#include "subvol/version.h"
#include "text.h"
#include "vdb_functions.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr std::size_t kReferenceCells = 600'000;  // 3.6 million tetrahedra: about 1 GB at the peak
constexpr int kGridResolution = 200;

/// A generated model, and how it is drawn.
struct DemoCase {
    std::string name;
    HexMesh mesh;
    Camera camera;
    Optics optics;
    int sheets;
    int per_edge;
};

/// The camera and the smooth transfer function of the benchmark with the twisted block. Parts of the block are outside the
/// picture.
const Camera kTwistCamera{.eye = {2.6, -4.2, 2.0}, .target = {-0.3, 0, 0.1}, .up = {0, 0, 1}, .fovy_deg = 44};

Optics twist_optics() {
    return {{.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
             .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
            0.1};
}

Optics preset_optics(const std::string& preset, const HexMesh& mesh) {
    const Range range = field_range(mesh);
    return {transfer_function_preset(preset, range.min, range.max), bounds(mesh).diagonal() / 100};
}

std::vector<std::string> demo_names() {
    return {"pawn", "ball", "twist"};
}

/// resolution: as make_model takes it; 0: the model's default
DemoCase make_demo_case(const std::string& name, int resolution, double aspect) {
    HexMesh mesh = make_model(name, resolution);
    if (name == "twist") return {name, std::move(mesh), kTwistCamera, twist_optics(), 200, 1};
    Optics optics = preset_optics(name == "pawn" ? "surface" : "coolwarm", mesh);
    const Camera camera = parse_camera("iso", visible_bounds(mesh, optics), aspect);
    const int sheets = name == "pawn" ? 400 : 200;  // an opaque surface shows every step in depth
    return {name, std::move(mesh), camera, std::move(optics), sheets, 1};
}

/// The picture of a model that people look at first: lit, framed and on a light ground, as `subvol render` draws it.
///
/// pawn: its surface; ball: cut open; twist: solid
Image lit_picture(const DemoCase& shown, const PictureSize& size, Progress* progress) {
    MethodOptions options;
    if (shown.name == "ball") {
        options.style.look.look = Look::Solid;
        options.style.clip.planes.push_back({.point = bounds(shown.mesh).center(), .normal = {0, -1, 0}});
    } else if (shown.name == "twist") {
        options.style.look.look = Look::Solid;
    } else {
        options.style.look.colors = "surface";
        options.splat.shading = Shading{};
    }
    const Range range = field_range(shown.mesh);
    const Optics optics = picture_optics(options.style.look, bounds(shown.mesh), range, range);
    const double aspect = static_cast<double>(size.width) / size.height;
    const std::vector<Vec3> framed = framed_points(shown.mesh, options.style.look.look, optics);
    const Camera camera = find_camera({}, bounds(shown.mesh), framed, aspect, OptionNames::Flags);
    return PictureMaker({.mesh = shown.mesh}, options).draw(View(camera, size.width, size.height), optics, progress).image;
}

/// A page with the pictures and the figures of all models, for a browser.
std::string index_page(const Json& cases) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>subvol demo</title>\n<style>\n"
        "body { font: 16px/1.5 sans-serif; max-width: 1060px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; "
        "}\n"
        "img { max-width: 100%; height: auto; display: block; } figure { margin: 0; } figcaption { color: #555; }\n"
        ".row { display: grid; grid-template-columns: 2fr 1fr 1fr 1fr; gap: 1em; align-items: end; }\n"
        "@media (max-width: 640px) { .row { grid-template-columns: 1fr 1fr; } }\n</style>\n</head>\n<body>\n"
        "<h1>Three volumes, from a few cells to an image</h1>\n"
        "<p>Each row shows one model: how <code>subvol render</code> draws it, the image of its kernels, the reference by rays "
        "through tetrahedra, and where these two differ (brighter: more).</p>\n";
    for (const Json& shown : cases) {
        const Json& files = shown["files"];
        const auto figure = [&](const char* key, const std::string& caption) {
            const auto file = files[key].get<std::string>();
            return "<figure><a href=\"" + file + "\"><img src=\"" + file + "\" alt=\"" + caption + "\"></a><figcaption>" +
                   caption + "</figcaption></figure>\n";
        };
        const auto name = shown["name"].get<std::string>(), grid = files["vdb"].get<std::string>();
        html += "<h2>" + name + "</h2>\n<div class=\"row\">\n" + figure("picture", name) +
                figure("splat", counted(shown["points"].get<std::size_t>(), "kernel")) +
                figure("reference", counted(shown["equivalent_cells"].get<std::size_t>(), "cell")) +
                figure("difference", text("PSNR ", std::fixed, std::setprecision(1), shown["psnr"].get<double>(), " dB")) +
                "</div>\n<p>OpenVDB grid for Blender, Houdini and ParaView: <a href=\"" + grid + "\">" + grid + "</a></p>\n";
    }
    return html +
           "<h2>Next</h2>\n<p>With a mesh of your own: <code>subvol info part.vtk</code>, <code>subvol render part.vtk -o "
           "part.png</code>, <code>subvol vdb part.vtk -o part.vdb</code>. All figures are in <a "
           "href=\"summary.json\">summary.json</a>.</p>\n</body>\n</html>\n";
}

/// The finest level whose cells the reference can march.
int reference_level(std::size_t cells) {
    int level = 0;
    for (; 8 * cells <= kReferenceCells; cells *= 8) ++level;
    return level;
}

Json host() {
    utsname system{};
    uname(&system);
    return {{"system", text(system.sysname, " ", system.machine)},
            {"threads", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)}};
}

class DemoVerb : public Verb {
public:
    explicit DemoVerb(CLI::App& program)
        : Verb(program, "demo",
               "Run the full pipeline on built-in models: grid, splats, ray-cast reference, comparison and summary.",
               "  subvol demo -o out\n"
               "  subvol demo -o out --size 256",
               Reads::NoMesh) {
        add_option(app(),
                   Option("output", output_).also("o").help("DIR", "the folder for the files (created if it does not exist)"))
            ->required();
        add_option(app(), Option("resolution", resolution_)
                              .between(2, 512)
                              .help("N", "cells along a model's main direction (default: the model's own)"));
        add_option(app(), options_of(eye_).front());
    }

    int run(Report& report) override {
        const PictureSize size = eye_.size;
        folder_ = output_;
        make_folder(folder_);
        report.say("model     points  equivalent cells    splat s  reference s  PSNR dB");
        report["cases"] = Json::array();
        for (const std::string& name : demo_names()) {
            Json shown = run_case(name, size);
            report.say(table_row(shown));
            report["cases"].push_back(std::move(shown));
        }
        report["version"] = SUBVOL_VERSION;
        report["host"] = host();
        detail::write_text_file(folder_ / "summary.json", report.json().dump(2) + "\n");
        detail::write_text_file(folder_ / "index.html", index_page(report["cases"]));
        report.say(text("Everything is in ", folder_.string(), "; ", (folder_ / "index.html").string(), " shows it"));
        report.all_said();
        return 0;
    }

private:
    [[nodiscard]] Json run_case(const std::string& name, const PictureSize& size) const {
        Report stages(common());
        const double aspect = static_cast<double>(size.width) / size.height;
        const DemoCase shown = stages.timed("generate", [&] { return make_demo_case(name, resolution_, aspect); });
        const View view(shown.camera, size.width, size.height);
        Json files = Json::object();
        const auto file = [&](const char* key, const std::string& ending) {
            files[key] = name + ending;
            return folder_ / (name + ending);
        };

        const SampleResult sampled = stages.timed("sample", [&] {
            return sample_rbf_points(shown.mesh, {.per_edge = shown.per_edge, .progress = stages.progress()});
        });
        const Image splat = stages.timed("splat", [&] {
            return render_splats(sampled.volume, view, shown.optics, {.sheets = shown.sheets, .progress = stages.progress()})
                .image;
        });
        write_image(file("splat", "_splat.png"), splat);

        const Image picture = stages.timed("picture", [&] { return lit_picture(shown, size, stages.progress()); });
        write_image(file("picture", ".png"), picture, background_of(Look::Solid));

        const int level = reference_level(shown.mesh.cells.size());
        const HexMesh fine =
            stages.timed("refine", [&] { return refine(shown.mesh, {.levels = level, .progress = stages.progress()}); });
        write_grid(fine, file("vdb", ".vdb"), stages);
        const Image reference = stages.timed(
            "reference", [&] { return render_tets(fine, {}, view, shown.optics, {.progress = stages.progress()}).image; });
        write_image(file("reference", "_reference.png"), reference);
        write_image(file("difference", "_difference.png"), difference_heatmap(splat, reference));

        return {{"name", name},
                {"points", sampled.volume.size()},
                {"equivalent_cells", fine.cells.size()},
                {"psnr", compare_images(splat, reference).psnr},
                {"seconds", stages["seconds"]},
                {"files", files}};
    }

    static void write_grid(const HexMesh& mesh, const std::filesystem::path& path, Report& stages) {
        const std::vector<std::string> field{mesh.attributes.front().name};
        stages.timed("grid", [&] {
            vdb().write_vdb(path, vdb().rasterize(mesh, field, {.resolution = kGridResolution, .progress = stages.progress()}),
                            VdbCompression::Blosc);
        });
    }

    [[nodiscard]] static std::string table_row(const Json& shown) {
        const Json& seconds = shown["seconds"];
        const double splat = seconds["sample"].get<double>() + seconds["splat"].get<double>();
        const double reference = seconds["refine"].get<double>() + seconds["reference"].get<double>();
        return text(std::left, std::setw(7), shown["name"].get<std::string>(), std::right, std::setw(9),
                    shown["points"].get<std::size_t>(), std::setw(18), shown["equivalent_cells"].get<std::size_t>(), std::fixed,
                    std::setprecision(2), std::setw(11), splat, std::setw(13), reference, std::setw(9),
                    shown["psnr"].get<double>());
    }

    std::string output_;  // of --output
    std::filesystem::path folder_;
    int resolution_ = 0;
    ViewOptions eye_;
};

}  // namespace

std::unique_ptr<Verb> make_demo_verb(CLI::App& program) {
    return std::make_unique<DemoVerb>(program);
}

}  // namespace subvol::cli
