// SPDX-License-Identifier: Apache-2.0
// The verb `compare`: how much A differs from B, the reference. Two pictures are compared by their pixels, two fields at
// random places in the domain of B:
//
//     both inputs ─► a view of each field ─► l1, l2, linf and gradients at N places
//                                         ─► integrals over the domains, and Hausdorff distance of isosurfaces
//                                         ─► the vertices that the first refinement of the mesh B adds
//                                         ─► the differences at the points of the mesh A, as a file
//
// Places at which A has no value count as uncovered. If less than a given share of them is covered, no demand counts as met,
// as the figures are then those of a part of B. Each demand METRIC=VALUE is judged by whether more or less of its metric is
// better; the exit code is 1 if one is not met. Names of metrics and the kinds of the inputs are checked before anything long
// begins.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iomanip>
#include <optional>
#include <string>
#include <vector>

#include "field_input.h"
#include "figures.h"
#include "input.h"
#include "mesh_figures.h"
#include "mesh_output.h"
#include "options.h"
#include "outputs.h"
#include "picture_comparison.h"
#include "probe_output.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/error.h"
#include "subvol/field_metrics.h"
#include "subvol/field_places.h"
#include "subvol/option.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kIsoResolution = 128;
constexpr std::size_t kMostNewVertices = 200'000;  // of which the root mean square is known to .2 %

/// The metrics of two fields.
struct FieldComparison {
    std::size_t samples = 100'000;
    std::optional<int> resolution{};
    std::optional<double> iso;
    double least_coverage = 0.99;
    std::string output;                 // a file of the differences on A's mesh
    std::optional<std::string> step_b;  // of B, if it is another one than that of A
    RefineArguments refine;

    void add_to(CLI::App& app);

    /// Refuses options that need meshes, or a file of steps as B. meshes: A and B are
    void check(bool meshes, const std::string& reference) const;

    /// The names of the figures that `measure` will give; `of_mesh`: the second is a mesh.
    [[nodiscard]] std::vector<std::string> names(bool of_mesh) const;

    [[nodiscard]] Figures measure(const std::string& test, const std::string& reference, const CommonOptions& options,
                                  Report& report) const;

    /// The differences at the points of A, as a file and as `difference` of the report.
    void write_difference(const FieldInput& a, const FieldInput& b, Report& report) const;
};

void FieldComparison::add_to(CLI::App& app) {
    const std::string group = "Fields";
    add_option(app, Option("samples", samples)
                        .between(1, 1e8)
                        .help("N", "number of random places in the second field's domain; see --seed"))
        ->group(group);
    add_option(app, Option("coverage", least_coverage)
                        .between(0, 1)
                        .help("SHARE",
                              "the least share of these places at which the first field must have a value, too, for any demand "
                              "to be met"))
        ->group(group);
    add_option(app,
               Option("iso", iso).help("V", "also the Hausdorff distance between the isosurfaces of this value (hausdorff)"))
        ->group(group);
    add_option(app, Option("resolution", resolution)
                        .between(2, 2000)
                        .help("N",
                              "cells along the longest side for mass (default: as many as it needs, 64 or 128) and isosurfaces "
                              "(default 128)"))
        ->group(group);
    refine.add_to(app, "compare meshes at this level; omitted: the limit, by curved pieces within tolerance");
    add_option(app,
               Option("output", output)
                   .also("o")
                   .help("FILE",
                         "of two meshes: A's mesh with the differences A - B of their fields, or of --field, at its points "
                         "(.vtu, .vtkhdf)")
                   .not_with("levels"))
        ->group(group);
    add_option(app, Option("step-b", step_b).help("N|last", "the step of B, if it is another one than that of A"))
        ->group(group);
    for (const char* name : {"--scheme", "--tension", "--levels", "--crease-angle"}) app.get_option(name)->group(group);
}

void FieldComparison::check(bool meshes, const std::string& reference) const {
    if (!output.empty()) {
        check_output(output, {".vtu", ".vtkhdf"});
        if (!meshes) throw Error(ErrorCode::InvalidInput, "needs two meshes", "--output", "a mesh as A and one as B");
    }
    if (!step_b) return;
    if (!may_have_steps(reference))
        throw Error(ErrorCode::InvalidInput, "needs a file of a mesh with steps as B", "--step-b", "a file of steps");
    CommonOptions of_b;
    of_b.step = step_b;
    const std::optional<std::size_t> step = [&] {
        try {
            return one_step(reference, of_b);
        } catch (const Error& error) {
            throw Error(error.code(), error.message(), "--step-b", "a number from 0, or last");
        }
    }();
    const std::size_t steps = open_series(reference).size();
    if (*step < steps) return;
    throw Error(ErrorCode::InvalidInput, text("there is no step ", *step), "--step-b", text("0 to ", steps - 1));
}

std::vector<std::string> FieldComparison::names(bool of_mesh) const {
    std::vector<std::string> all{"l1", "l2", "linf", "gradient_rmse", "mass"};
    if (of_mesh) all.emplace_back("new_vertex_rmse");
    if (iso) all.emplace_back("hausdorff");
    return all;
}

Figures FieldComparison::measure(const std::string& test, const std::string& reference, const CommonOptions& options,
                                 Report& report) const {
    report["input"] = test;  // for errors
    const KeepMesh keep = output.empty() || options.field || options.density ? KeepMesh::No : KeepMesh::Yes;
    const FieldInput a = report.unpack(load_field(test, options, refine, "a", report.progress(), keep));
    report["input"] = reference;
    CommonOptions of_b = options;
    if (step_b) {
        of_b.step = step_b;
        of_b.read.time.reset();
        of_b.interpolate_time = false;
    }
    const FieldInput b = report.unpack(load_field(reference, of_b, refine, "b", report.progress(), keep));
    const FieldDifference errors = report.timed("samples", [&] {
        return compare_fields(a.view, b.view, {.samples = samples, .seed = options.seed, .progress = report.progress()});
    });
    if (errors.samples == 0) {
        throw Error(ErrorCode::InvalidInput, "the two fields have no place in common", test + ", " + reference);
    }
    Figures figures;
    figures.put("l1", errors.l1);
    figures.put("l2", errors.l2);
    figures.put("linf", errors.linf);
    report["linf_at"] = json_of(errors.linf_at);
    figures.put("gradient_rmse", errors.gradient_rmse);
    const MassError mass = report.timed("mass", [&] { return mass_error(a.view, b.view, resolution, report.progress()); });
    figures.put("mass", mass.relative);
    report["mass_resolution"] = mass.resolution;
    report["a"]["mass"] = mass.test;
    report["b"]["mass"] = mass.reference;
    if (b.mesh) {
        const auto places = report.timed(
            "new_vertices", [&] { return new_vertices(*b.mesh, b.field, 0, scheme_named(refine.scheme), kMostNewVertices); });
        const FieldDifference at_vertices = compare_field(a.view, places);
        figures.put("new_vertex_rmse", at_vertices.l2);
        report["new_vertices"] = {{"samples", at_vertices.samples}, {"uncovered", at_vertices.uncovered}};
    }
    if (iso) {
        const auto found = report.timed("hausdorff", [&] {
            return isosurface_distance(a.view, b.view, *iso, resolution.value_or(kIsoResolution), report.progress());
        });
        figures.put("hausdorff", found.distance);
        report["isosurface"] = {
            {"spacing", found.spacing}, {"triangles_a", found.test_triangles}, {"triangles_b", found.reference_triangles}};
    }
    report["samples"] = errors.samples;
    report["uncovered"] = errors.uncovered;
    report["coverage"] = errors.coverage();
    if (!(errors.coverage() >= least_coverage)) {
        report.warn(text("the figures are of a part of the reference: ", test, " has values at ", errors.samples, " of ",
                         errors.samples + errors.uncovered, " places in ", reference, ", less than --coverage ",
                         least_coverage));
    }
    if (!output.empty()) write_difference(a, b, report);
    return figures;
}

void FieldComparison::write_difference(const FieldInput& a, const FieldInput& b, Report& report) const {
    const HexMesh &test = a.read ? *a.read : *a.mesh, &reference = b.read ? *b.read : *b.mesh;
    const MeshDifferenceOptions asked{.scheme = refine.options(0, nullptr).scheme, .progress = report.progress()};
    const MeshDifference found = report.timed("difference", [&] {
        try {
            return mesh_difference(test, reference, asked);
        } catch (const Error& error) {
            if (error.where() != "mesh_difference") throw;
            throw Error(error.code(), error.message(), "A, B", error.allowed());
        }
    });
    report.merge(write_reported(output, found.mesh, {}, a.sets, report.progress()));
    Facts facts;
    facts["difference"] = facts_of(found);
    report.merge(facts);
    report["output"] = output;
    if (found.outside > 0) {
        report.warn(text(counted(found.outside, "point"), " of A lie outside B, by at most ", found.outside_world,
                         ": their differences are those from the nearest place of B"));
    }
}

constexpr int kComparisonFailed = 1;

class CompareVerb : public Verb {
public:
    explicit CompareVerb(CLI::App& program)
        : Verb(program, "compare", "Measure how much two pictures, or two fields, differ; the second is the reference.",
               "  subvol compare splat.exr reference.exr --heatmap difference.png\n"
               "  subvol compare a.png b.png --fail-under psnr=40 --fail-under flip=.02\n"
               "  subvol compare a.png b.png --heatmap flip.png --heatmap-of flip\n"
               "  subvol compare a.exr b.exr --edge-band 2 --fail-under interior.rmse=.001\n"
               "  subvol compare points.ply mesh.vtu --iso .5 --fail-under l2=.01\n"
               "  subvol compare run2.vtu run1.vtu --field 'mises(STRESS)' -o difference.vtu\n"
               "  subvol compare run.pvd run.pvd --step 20 --step-b 10 -o change.vtu\n"
               "\n"
               "Pictures (any that OpenImageIO reads) are compared in linear light, peak 1: mse, rmse, mae, max, psnr (dB), "
               "flip; ssim of 8-bit sRGB luminance, ssim_linear of linear RGB; under srgb8 the differences of 8-bit sRGB. "
               "Fields are meshes, points or .vdb grids: l1, l2 (root mean "
               "square), linf, gradient_rmse, mass (relative), hausdorff (with --iso); new_vertex_rmse against a mesh: at the "
               "vertices that its first refinement adds (200,000 of them stand for more). Parts of pictures (.exr with a data "
               "window) are compared where they "
               "overlap. Fields: linf_at is the place of linf, among those of --samples. With --output also difference: "
               "same_points, "
               "outside and outside_distance (points of A outside B, which are compared with its nearest place), fields {name: "
               "max, at, point or cell}; values of A at its points, of B those of its limit there, or point by point where "
               "both have "
               "the "
               "same points and cells. Exit code 1 if a --fail-under is not met, or one is given and the first field has "
               "values at less of "
               "the second's "
               "domain than --coverage.") {
        show_limit_of_parts();
        add_input(app(), "A", a_, "a picture or a field")->required();
        add_input(app(), "B", b_, "the reference: a picture of the same size or a part of one, or a field")->required();
        add_option(
            app(),
            Option("fail-under", demands_)
                .help(
                    "METRIC=VALUE",
                    "exit with 1 if the metric is worse than the value (psnr, ssim: below it; all others: above); repeatable"));
        pictures_.add_to(app());
        fields_.add_to(app());
        set_essentials({"--fail-under", "--heatmap", "--heatmap-of", "--edge-band", "--samples", "--coverage", "--iso",
                        "--levels", "--output", "--step-b", "--field", "--json"});
    }

    int run(Report& report) override {
        const InputKind a = kind_of(a_), b = kind_of(b_);
        const bool pictures = b == InputKind::Picture;
        if ((a == InputKind::Picture) != pictures) {
            throw Error(ErrorCode::InvalidInput, "is a picture, " + (pictures ? a_ : b_) + " is a field", pictures ? b_ : a_,
                        "two pictures or two fields can be compared");
        }
        refuse_options_of(pictures ? "Fields" : "Pictures");
        const auto is_mesh = [](InputKind kind) { return kind == InputKind::Mesh || kind == InputKind::Bricks; };
        if (!is_mesh(a) && !is_mesh(b)) {
            refuse_mesh_options(app(), text("needs a mesh; these are ", pictures ? "pictures" : "points or grids"));
        }
        if (is_model(a_) && is_model(b_)) refuse_file_options(&app(), "says how a file is read; these are models");
        if (pictures) refuse_options(app(), {"--field"}, "is for fields; these are pictures");
        pictures_.check();
        std::vector<Demand> demands;
        const auto names = pictures ? pictures_.names() : fields_.names(is_mesh(b));
        for (const std::string& demand : demands_) demands.push_back(parse_demand(demand, names));
        if (!pictures) report.if_long("--samples 10000, --resolution 64, or --levels 1");
        check_there(a_);
        check_there(b_);
        if (!pictures) fields_.check(is_mesh(a) && is_mesh(b), b_);

        const Figures figures = pictures ? pictures_.measure(a_, b_, report) : fields_.measure(a_, b_, common(), report);
        figures.into(report);
        report["input"] = a_;
        report["reference"] = b_;
        const std::vector<std::string> faults = faults_of(figures, demands, report);
        report["passed"] = faults.empty();
        say(figures, pictures, faults, report);
        return judges() && !faults.empty() ? kComparisonFailed : 0;
    }

private:
    /// Whether there is a demand; else the verb measures only.
    [[nodiscard]] bool judges() { return !demands_.empty() || app().count("--coverage") > 0; }

    [[nodiscard]] std::vector<std::string> faults_of(const Figures& figures, const std::vector<Demand>& demands,
                                                     const Report& report) const {
        std::vector<std::string> faults;
        for (std::size_t i = 0; i < demands.size(); ++i) {
            if (demands[i].met_by(figures)) continue;
            faults.push_back(text(demands_[i], " is not met by ", std::setprecision(6), figures.at(demands[i].metric)));
        }
        const double coverage = report.json().value("coverage", 1.0);
        if (!(coverage >= fields_.least_coverage)) faults.push_back(text("a coverage of ", std::setprecision(3), coverage));
        return faults;
    }

    /// For people: the figure that is asked for most first, then the others, then the demands.
    void say(const Figures& figures, bool pictures, const std::vector<std::string>& faults, Report& report) {
        const std::string first = pictures ? "psnr" : "l2";
        Lines lines;
        const auto add = [&](const std::string& name, double value) {
            const PictureMetric* const metric = pictures ? find_metric(name) : nullptr;
            const bool plain = metric == nullptr || metric->unit.empty();
            lines.emplace_back(name,
                               text(std::setprecision(6), value, plain ? "" : " ", plain ? "" : metric->unit,
                                    !pictures && name == "linf" ? " at " + place_words(report.json().at("linf_at")) : ""));
        };
        add(first, figures.at(first));
        for (const auto& [name, value] : figures.all()) {
            if (name != first) add(name, value);
        }
        const Json& json = report.json();
        if (!pictures) {
            const auto samples = json.at("samples").get<std::size_t>(), uncovered = json.at("uncovered").get<std::size_t>();
            lines.emplace_back("covered", text(samples, " of ", samples + uncovered, " places"));
        }
        if (json.contains("window")) {
            const Json& part = json.at("window");
            lines.emplace_back("pixels", text(part.at("width"), " x ", part.at("height"), " from (", part.at("left"), ", ",
                                              part.at("top"), "), where the two overlap"));
        }
        if (json.contains("difference")) {
            for (const auto& [name, largest] : json.at("difference").at("fields").items())
                lines.emplace_back(name, text("differs at most by ", std::setprecision(6), largest.at("max").get<double>(),
                                              largest.contains("cell") ? " in cell " : " at point ",
                                              largest.at(largest.contains("cell") ? "cell" : "point"), " (",
                                              place_words(largest.at("at")), ")"));
            lines.emplace_back("differences",
                               text(json.at("output").get<std::string>(), ", at the points of A",
                                    json.at("difference").at("same_points").get<bool>() ? ", which B has, too" : ""));
        }
        if (json.contains("heatmap")) lines.emplace_back("heatmap", json.at("heatmap").get<std::string>());
        if (judges()) {
            std::vector<std::string> met = demands_;
            if (app().count("--coverage") > 0) met.push_back(text("coverage=", fields_.least_coverage));
            lines.emplace_back("verdict", faults.empty() ? "passed: " + join(met) : "failed: " + join(faults));
        }
        std::string all = aligned(lines);
        all.pop_back();
        report.say(all);
        report.all_said();
    }

    /// "0.5,1,0.25" of a list of numbers.
    static std::string place_words(const Json& place) { return place_text({place.at(0), place.at(1), place.at(2)}); }

    /// Checks both inputs before a long time is spent on one of them.
    static void check_there(const std::string& input) {
        std::error_code ignored;
        const bool there = input.starts_with("model:") || std::filesystem::exists(input, ignored);
        if (there) return;
        throw Error(ErrorCode::Io, "cannot be read: no such file", input);
    }

    void refuse_options_of(const std::string& group) {
        for (const CLI::Option* option : app().get_options()) {
            if (option->get_group() != group || option->count() == 0) continue;
            throw Error(ErrorCode::InvalidInput,
                        group == "Fields" ? "is for fields; these are pictures" : "is for pictures; these are fields",
                        option->get_name());
        }
    }

    std::string a_;
    std::string b_;
    std::vector<std::string> demands_;
    PictureComparison pictures_;
    FieldComparison fields_;
};

}  // namespace

std::unique_ptr<Verb> make_compare_verb(CLI::App& program) {
    return std::make_unique<CompareVerb>(program);
}

}  // namespace subvol::cli
