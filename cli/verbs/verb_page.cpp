// SPDX-License-Identifier: Apache-2.0
// The verb `page`: one HTML file in which a volume can be turned, coloured and clipped without a network.
//
//     each step   mesh ─► fields as scalars ─► kernels, and values on the boundary's surface
//     all steps   one box, one range for each field, one transfer function for each field
//     page        kernels are rounded and merged until the file is no larger than asked; the errors of that are said
//
// All steps must have the fields of the first, in the same order. A grid of voxels gives one step: of a level set the body
// inside its surface, of fog the voxels, which end at their faces.
// The camera is the one that `render` would take. Unless it is left out, a picture of the first view by splats is added, with
// which a reader's drawing can be compared. A title or source on the page never has the folder of the file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "grid_fields.h"
#include "grid_input.h"
#include "input.h"
#include "limit_warning.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "picture_arguments.h"
#include "points_input.h"
#include "refine_arguments.h"
#include "sample_arguments.h"
#include "sampled_points.h"
#include "steps.h"
#include "subvol/boundary_values.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/page.h"
#include "subvol/quantity.h"
#include "subvol/splat.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class PageVerb : public Verb {
public:
    explicit PageVerb(CLI::App& program)
        : Verb(program, "page", "Write a self-contained HTML page that shows the volume interactively.",
               "  subvol page part.vtu -o part.html\n"
               "  subvol page part.vtu -o part.html --fields Temp,Pres --tf inferno\n"
               "  subvol page run.exo -o run.html --step 0-9 --max-bytes 10e6\n"
               "\n"
               "One file that needs no network: kernels, drawn by WebGL2 as `render` draws them. The reader can turn the "
               "volume, change the transfer function, clip, choose fields and steps, and pick values. JSON: bytes, points, "
               "kept (kernels in the page), bits, fields [{name, rmse, max_error, range}].") {
        show_limit_of_parts();
        add_input(app(), "FILE", input_, text(input_help(), "; or a grid of a .vdb"))->required();
        add_option(app(), Option("output", output_).also("o").help("FILE", "the page to write (.html)"))->required();
        add_option(app(), Option("fields", fields_)
                              .with_commas()
                              .help("A,B,…", "the fields to choose from: names, or all (default: the one of --field)"));
        add_option(
            app(),
            Option("max-bytes", max_bytes_)
                .help("B",
                      "the page's size (default 24e6): kernels are rounded, then merged, until it fits; the page says the "
                      "error"))
            ->transform(number_in(1e4, 2e9));
        add_option(app(), Option("title", title_).help("TEXT", "the page's title (default: the file's name)"));
        add_option(app(), Option("no-reference", no_reference_).help("without the picture of `render` to compare with"));
        picture_.add_some_to(app(), {"--size", "--camera", "--view", "--up", "--ortho", "--look", "--tf", "--range", "--log",
                                     "--symlog", "--bands", "--below", "--above", "--opacity", "--opacity-unit"});
        add_option(app(), Option("unit", unit_).help("TEXT", "the first field's unit, for the legend"));
        sample_.add_to(app());
        refine_.add_to(app(), "show the refined mesh of this level instead of the limit");
        set_essentials({"--output", "--fields", "--field", "--look", "--tf", "--opacity", "--view", "--camera", "--max-bytes",
                        "--per-edge", "--title", "--json"});
        group("Camera", {"--size", "--camera", "--view", "--up", "--ortho"});
        group("Colours and light", {"--look", "--tf", "--range", "--log", "--symlog", "--bands", "--below", "--above",
                                    "--opacity", "--opacity-unit", "--unit"});
        group("Kernels",
              {"--per-edge", "--centers", "--spacing", "--spacing-voxels", "--tolerance", "--footprint", "--footprint-size",
               "--values", "--kernel", "--value-kernel", "--threshold", "--correction", "--reduce", "--refine"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
    }

    int run(Report& report) override {
        check_output(output_, {".html"});
        std::optional<VdbGrid> grid;
        if (kind_of(input_) == InputKind::Grid) {
            refuse_options(app(), {"--fields"}, "needs a mesh; this is a grid of voxels");
            grid = report.unpack(load_grid(input_, common(), report.progress()));
        }
        const bool solid = !grid || grid->report().level_set;
        picture_.settle_look(solid);
        if (picture_.look == Look::Solid && !solid) {
            throw Error(ErrorCode::InvalidInput, "is fog, which has no surface", text(input_, ", grid ", grid->report().name),
                        "--look volume or xray");
        }
        if (picture_.look == Look::Isosurface) {
            throw Error(ErrorCode::InvalidInput, "a page has no lit isosurfaces", "--look isosurface",
                        "solid, volume or xray; --tf isosurface draws them without light");
        }
        picture_.check();
        report.if_long("--max-bytes that fits without merging, or a larger --spacing");
        tets_ = TetRefinement(refine_);
        PageOptions options{.title = title_.empty() ? title_of_file() : title_, .source = source_name()};
        const std::vector<PageStep> steps =
            grid ? std::vector<PageStep>{step_of_grid(*grid, options, report)} : make_steps(options, report);
        finish_options(options, steps.back(), report);
        const PageResult page = report.timed("page", [&] { return make_page(steps, options); });
        report.timed("write", [&] { detail::write_text_file(output_, page.html); });
        put(page.report, options, report);
        return 0;
    }

private:
    /// What stands on the page: not the folders of whoever made it.
    [[nodiscard]] std::string source_name() const {
        return is_model(input_) ? input_ : std::filesystem::path(input_).filename().string();
    }

    [[nodiscard]] std::string title_of_file() const {
        return is_model(input_) ? input_.substr(6) : std::filesystem::path(input_).filename().string();
    }

    /// The mesh with the fields of the page, each a scalar; the one of --field is the first.
    [[nodiscard]] HexMesh shown_mesh(HexMesh mesh, const CommonOptions& common, Report& report) const {
        std::vector<std::string> names = fields_;
        if (names == std::vector<std::string>{"all"}) names = names_of(mesh);
        CommonOptions first = common;
        if (!names.empty() && !common.field && !common.density && fields_ != std::vector<std::string>{"all"}) {
            first.field = names.front();
        }
        const HexMesh whole = mesh;
        mesh = report.unpack(with_selected_field(std::move(mesh), first));
        for (const std::string& name : names) {
            SelectedField more = select_field(whole, name);
            const bool there = std::ranges::any_of(
                mesh.attributes, [&](const Attribute& shown) { return shown.name == more.scalar.name || shown.name == name; });
            if (!there) mesh.attributes.push_back(std::move(more.scalar));
        }
        return mesh;
    }

    [[nodiscard]] std::vector<PageStep> make_steps(PageOptions& options, Report& report) {
        std::vector<PageStep> steps;
        std::vector<Range> ranges;
        const auto add = [&](const CommonOptions& common, const std::string& label) {
            report["input"] = input_;
            ReadResult read = report.unpack(read_input(input_, common, report.progress()));
            const std::vector<FieldInfo> of_file = std::move(read.fields);
            mesh_ = shown_mesh(report.unpack(mesh_of(std::move(read), common, nullptr)), common, report);
            if (!tets_.asked() && steps.empty())
                report.warn(limit_warning(input_, mesh_, refine_.options(0, nullptr).scheme, report.progress()));
            mesh_ = report.unpack(tets_.hexes(std::move(mesh_), 1, report.progress()));
            const HexMesh& mesh = mesh_;
            box_.add(bounds(mesh));
            if (options.fields.empty()) {
                for (const Attribute& field : mesh.attributes)
                    options.fields.push_back({.name = field.name, .unit = unit_of(of_file, field.name)});
            }
            const auto same = [](const PageField& a, const Attribute& b) { return a.name == b.name; };
            if (!std::ranges::equal(options.fields, mesh.attributes, same)) {
                throw Error(ErrorCode::InvalidInput, "has other fields than the first step", "step " + label);
            }
            for (std::size_t f = 0; f < mesh.attributes.size(); ++f) {
                const Range range = field_range(mesh, f);
                if (f >= ranges.size()) ranges.push_back(range);
                ranges[f] = {std::min(ranges[f].min, range.min), std::max(ranges[f].max, range.max)};
            }
            PageStep step{.label = label,
                          .volume = report.unpack(
                              tets_.asked() ? sample_tets_reported(mesh, sample_, std::nullopt, report.progress())
                                            : sample_reported(mesh, sample_, refine_, std::nullopt, report.progress()))};
            RefineOptions refine = refine_.options(0, report.progress());
            refine.levels = picture_levels(mesh, tets_.asked() ? std::optional(0) : refine_.levels);
            step.boundary = report.timed("boundary", [&] { return boundary_values(mesh, refine); });
            for (std::size_t f = 0; f < mesh.attributes.size() && !is_model(input_); ++f) {
                const auto [low, high] = std::ranges::minmax(step.boundary.values[f]);
                const Range inside = channel_range(step.volume, f);
                report.warn(range_warning(mesh.attributes[f], field_range(mesh, f),
                                          {.min = std::min(low, inside.min), .max = std::max(high, inside.max)}, true));
            }
            steps.push_back(std::move(step));
        };
        if (asks_for_steps(common())) {
            const MeshSeries series = open_series(input_);
            const FrameRange range = chosen_steps(series, common());
            const CommonOptions all = report.unpack(for_steps(input_, common(), range, report.progress()));
            StepsWithFields taken(report);
            for (int step = range.first; step <= range.last; ++step) {
                const std::string name = text(step, " (t = ", series.times[static_cast<std::size_t>(step)], ")");
                taken.take(step, [&] { add(of_step(all, step), name); });
            }
            taken.finish();
        } else {
            add(common(), "");
        }
        for (std::size_t f = 0; f < ranges.size(); ++f) {
            options.fields[f].min = ranges[f].min;
            options.fields[f].max = ranges[f].max;
        }
        return steps;
    }

    /// The body within the surface of a level set, or fog up to the faces of its voxels.
    [[nodiscard]] PageStep step_of_grid(const VdbGrid& grid, PageOptions& options, Report& report) {
        const GridReport& about = grid.report();
        PageStep step;
        step.volume = report.unpack(
            sample_reported(grid, sample_, std::nullopt, app(), report.progress(), about.level_set ? nullptr : &step.boundary));
        if (about.level_set)
            step.boundary = {step.volume.boundary, {std::vector<double>(step.volume.boundary.points.size(), 1)}};
        PageField field{.name = step.volume.channels.front().name, .min = 1, .max = 1};
        if (!about.level_set) {
            field.min = about.min;
            field.max = about.max;
        }
        options.fields.push_back(std::move(field));
        options.solid = about.level_set;
        box_ = about.frame;
        return step;
    }

    void finish_options(PageOptions& options, const PageStep& step, Report& report) const {
        const std::optional<Look> solid = picture_.look == Look::Solid ? std::optional(Look::Solid) : std::nullopt;
        options.look = solid ? PageLook::Solid : picture_.look == Look::Xray ? PageLook::Xray : PageLook::Volume;
        options.background = picture_.background_color();
        options.max_bytes = static_cast<std::size_t>(max_bytes_);
        options.progress = report.progress();
        PictureArguments volume = picture_;  // opacities are those of the look volume, which readers can choose
        if (solid) volume.look = Look::Volume;
        for (std::size_t f = 0; f < options.fields.size(); ++f) {
            PageField& field = options.fields[f];
            const Range range{field.min, field.max};
            PictureArguments of_field = volume;
            const bool in_file = picture_.choices.colors && picture_.choices.colors->find('.') != std::string::npos;
            if (f > 0 && in_file) of_field.choices.range = "field";  // the values of the file's map are those of the first
            if (f > 0 && picture_.choices.opacity && picture_.choices.opacity->find('%') == std::string::npos)
                of_field.choices.opacity.reset();
            const Optics optics = of_field.make_optics(box_, range, range);
            field.function = optics.function();
            if (solid) field.function.color = picture_.make_optics(box_, range, range).function().color;
            if (f == 0 && !unit_.empty()) field.unit = unit_;
            if (f == 0) options.opacity_unit_world = optics.opacity_unit();
        }
        const PageField& first = options.fields.front();
        const Range range{first.min, first.max};
        const Optics optics = picture_.make_optics(box_, range, range);
        std::vector<Vec3> framed;  // none of fog: the camera is fitted to its box
        if (options.solid)
            framed = mesh_.cells.empty() ? step.boundary.surface.points : framed_points(mesh_, picture_.look, optics);
        const std::vector<View> views = picture_.make_views(box_, framed);
        options.camera = views.front().camera();
        options.up = picture_.eye.up;
        if (no_reference_) return;
        SplatOptions splat{.samples = solid ? 2 : 1, .progress = report.progress()};
        if (solid) splat.shading = shading_for(optics.function());
        Image image = report.timed("reference", [&] {
            Splatter splatter(step.volume, splat);
            if (solid) splatter.set_boundary_colors(step.boundary.surface, step.boundary.values.front());
            return splatter.draw(views.front(), optics, report.progress()).image;
        });
        options.reference = std::move(image);
    }

    void put(const PageReport& made, const PageOptions& options, Report& report) const {
        report["output"] = output_;
        report["bytes"] = made.bytes;
        report["points"] = made.kernels;
        report["kept"] = made.kept;
        report["bits"] = made.bits;
        report["triangles"] = made.triangles;
        for (std::size_t f = 0; f < options.fields.size(); ++f) {
            const PageField& field = options.fields[f];
            report["fields"].push_back({{"name", field.name},
                                        {"rmse", made.errors[f].rmse},
                                        {"max_error", made.errors[f].max_abs},
                                        {"range", {field.min, field.max}}});
        }
        if (made.kept < made.kernels) {
            report.warn(text(made.kernels, " kernels were merged into ", made.kept, " to fit into ",
                             static_cast<std::size_t>(max_bytes_), " bytes; the page says the error (--max-bytes)"));
        }
    }

    std::string input_, output_, title_, unit_;
    std::vector<std::string> fields_;
    HexMesh mesh_;  // of the last step; empty of a level set
    Box box_;       // of all steps
    double max_bytes_ = 24e6;
    bool no_reference_ = false;
    PictureArguments picture_;
    SampleArguments sample_;
    RefineArguments refine_;
    TetRefinement tets_;
};

}  // namespace

std::unique_ptr<Verb> make_page_verb(CLI::App& program) {
    return std::make_unique<PageVerb>(program);
}

}  // namespace subvol::cli
