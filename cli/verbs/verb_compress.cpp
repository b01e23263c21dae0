// SPDX-License-Identifier: Apache-2.0
// The verb `compress`: it writes a mesh with its fields as a small file, within a tolerance.
//
//     mesh         ─► wavelets of one field, within a root mean square error  ─► .svw
//     mesh, steps  ─► all fields, each value within a largest error           ─► .svw
//
// Every verb reads such a file as it reads any mesh: of details no kernels can be made, as they have signs and no mean.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <utility>

#include "grid_fields.h"
#include "input.h"
#include "mesh_frames.h"
#include "options.h"
#include "outputs.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/series_file.h"
#include "subvol/wavelet_file.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// Writes a mesh with one field as wavelets. returns: what was kept
Facts write_wavelets_reported(const std::string& path, const HexMesh& mesh, const WaveletFileOptions& options) {
    Facts facts;
    const WaveletFileReport written =
        facts.timed(options.progress, "wavelets", [&] { return write_wavelet_file(path, mesh, options); });
    std::size_t coefficients = 0, kept = 0;
    for (const WaveletArrayReport& array : written.arrays) {
        coefficients += array.coefficients;
        kept += array.kept;
    }
    const WaveletArrayReport &points = written.arrays.front(), &field = written.arrays.back();
    facts["points"] = mesh.points.size();
    facts["cells"] = written.cells;
    facts["levels"] = written.levels;
    facts["coarse_cells"] = written.coarse_cells;
    if (written.added_cells > 0) facts["added_cells"] = written.added_cells;
    facts["coefficients"] = coefficients;
    facts["coefficients_kept"] = kept;
    facts["bytes"] = written.bytes;
    facts["rms"] = field.rms;
    facts["max"] = field.max;
    facts["point_rms"] = points.rms;
    facts["point_max"] = points.max;
    facts["inverted_cells"] = written.inverted_cells;
    facts["output"] = path;
    if (written.inverted_cells > written.inverted_cells_before) {
        facts.warn(text(count_text(written.inverted_cells - written.inverted_cells_before),
                        " cells are inverted after rounding; a smaller --wavelet-point-tolerance keeps their shapes"));
    }
    return facts;
}

/// Writes steps within a most error. returns: what was kept
Facts write_series_reported(const std::string& path, const MeshSteps& steps, const SeriesFileOptions& options) {
    Facts facts;
    const SeriesFileReport written =
        facts.timed(options.progress, "series", [&] { return write_series_file(path, steps, options); });
    facts.merge(facts_of(written));
    facts["output"] = path;
    if (written.inverted_cells > written.inverted_cells_before) {
        facts.warn(text(count_text(written.inverted_cells - written.inverted_cells_before),
                        " cells are inverted after rounding; a smaller --max-point-error keeps their shapes"));
    }
    return facts;
}

class CompressVerb : public Verb {
public:
    explicit CompressVerb(CLI::App& program)
        : Verb(program, "compress", "Write a mesh and its fields within a tolerance, as a small file.",
               "  subvol compress run.foam -o run.svw --step all --max-error 1e-3    all steps and fields\n"
               "  subvol compress part.vtu -o part.svw --max-error 1e-3              one mesh\n"
               "  subvol compress fine.vtu -o fine.svw --wavelet-tolerance 1e-3      a refined mesh and one field\n"
               "\n"
               "Every verb reads such a file as it reads any mesh.") {
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(app(), Option("output", output_).also("o").help("FILE", "the file to write (.svw)"))->required();
        add_series();
        add_wavelets();
        set_essentials({"--output", "--max-error", "--wavelet-tolerance", "--field", "--step"});
        group("Meshes with all their fields", {"--max-error", "--max-point-error", "--key-steps"});
        group("Wavelets of one field",
              {"--wavelet-tolerance", "--wavelet-point-tolerance", "--levels", "--scheme", "--tension"});
    }

    int run(Report& report) override {
        check_output(output_, {".svw"});
        if (tolerance_) return write_wavelets(report);
        if (max_error_) return write_series(report);
        throw Error(ErrorCode::InvalidInput, "a compressed mesh needs a tolerance", output_,
                    "--max-error 1e-3 or --wavelet-tolerance 1e-3");
    }

private:
    void add_series() {
        std::vector<Option> described = options_of(series_);
        for (Option& option : described) {
            if (option.name != "max-error") {
                option.only_with("max-error");
                continue;
            }
            option.value = &max_error_;  // without it there are wavelets
            option.help("T",
                        "all fields, or that of --field: each value is off by at most T, in parts of the field's range in all "
                        "steps; with --step all a series");
        }
        add_options(app(), described);
    }

    void add_wavelets() {
        for (Option& option : options_of(wavelets_)) {
            if (option.name == "wavelet-tolerance") {
                option.value = &tolerance_;
                option
                    .help("T",
                          "control values and wavelet details of one field, with a root mean square error of at most T, in "
                          "parts of the field's range: for refined meshes and structured grids")
                    .not_with("max-error");
            } else {
                option.only_with("wavelet-tolerance");
            }
            add_option(app(), option);
        }
        for (Option& option : refine_.described()) {
            if (option.name != "scheme" && option.name != "tension") continue;
            add_option(app(), option.only_with("wavelet-tolerance"));
        }
    }

    /// The control values and details of one field.
    int write_wavelets(Report& report) {
        const InputKind kind = kind_of(input_);
        if (kind == InputKind::Bricks || kind == InputKind::Grid || asks_for_steps(common())) {
            throw Error(ErrorCode::InvalidInput, "wavelets need one mesh in memory", input_,
                        "a mesh file and one of its steps");
        }
        WaveletFileOptions options = wavelets_;
        options.scheme = refine_.options(1, nullptr).scheme;
        options.tolerance = *tolerance_;
        options.progress = report.progress();
        report["input"] = input_;
        HexMesh mesh = report.unpack(load_mesh(input_, common(), report.progress()));
        mesh = report.unpack(with_selected_field(std::move(mesh), common()));
        report.merge(write_wavelets_reported(output_, mesh, options));
        return 0;
    }

    /// The mesh, or with --step several steps of it, with all fields or that of --field.
    int write_series(Report& report) {
        const InputKind kind = kind_of(input_);
        if (kind == InputKind::Bricks || kind == InputKind::Grid) {
            throw Error(ErrorCode::InvalidInput, "a compressed mesh needs one mesh in memory", input_, "a mesh file");
        }
        SeriesFileOptions options = series_;
        options.tolerance = *max_error_;
        options.progress = report.progress();
        report["input"] = input_;
        MeshSets sets;
        const auto read = [&](const CommonOptions& one) {
            ReadResult found = report.unpack(read_input(input_, one, nullptr, ShellsAlone::Refuse));
            sets = std::move(found.sets);
            if (!sets.nodes.empty()) {
                report.warn(list_of({{}, {}, std::move(sets.nodes)}) + " not written: .svw files do not have them");
                sets.nodes.clear();
            }
            HexMesh mesh = report.unpack(mesh_of(std::move(found), one, nullptr));
            return one.field || one.density ? report.unpack(with_selected_field(std::move(mesh), one)) : mesh;
        };
        if (!asks_for_steps(common())) {
            const HexMesh mesh = read(common());
            report.merge(write_series_reported(
                output_, {{mesh.time.value_or(0)}, [&](std::size_t) { return mesh; }, [&] { return sets; }}, options));
            return 0;
        }
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        const CommonOptions all = report.unpack(for_steps(input_, common(), range, report.progress()));
        const auto first = series.times.begin() + range.first;
        StepsWithFields steps(report);
        const auto read_step = [&](std::size_t k) {
            const int step = range.first + static_cast<int>(k);
            CommonOptions one = of_step(all, step);
            HexMesh mesh;
            if (!steps.take(step, [&] { mesh = read(one); })) {  // it stays, without the field
                if (step == range.last) steps.refuse_none();
                one.field.reset();
                one.density.reset();
                mesh = read(one);
                mesh.attributes.clear();
            }
            return mesh;
        };
        report.merge(
            write_series_reported(output_, {{first, first + range.count()}, read_step, [&] { return sets; }}, options));
        steps.finish("written without the field");
        return 0;
    }

    std::string input_, output_;
    std::optional<double> max_error_, tolerance_;  // one of them is given
    SeriesFileOptions series_;
    WaveletFileOptions wavelets_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_compress_verb(CLI::App& program) {
    return std::make_unique<CompressVerb>(program);
}

}  // namespace subvol::cli
