// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "grid_input.h"
#include "input.h"
#include "options.h"
#include "outputs.h"
#include "places_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "subvol/approximate.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// In each cell of the control mesh a grid is sampled at so many places along each edge.
constexpr int kPlacesPerEdge = 4;

class ApproximateVerb : public Verb {
public:
    explicit ApproximateVerb(CLI::App& program)
        : Verb(program, "approximate", "Fit the fields of a control mesh to data: a finer mesh, a grid, or scattered samples.",
               "  subvol approximate fine.vtu --onto coarse.vtu -o fitted.vtu\n"
               "  subvol approximate smoke.vdb --onto model:twist:12 -o smoke.vtu --refine 2 --tolerance .01\n"
               "  subvol approximate measured.csv --onto part.vtu -o fitted.vtu --smoothing 1e-3\n"
               "\n"
               "Least squares through the limit: a field that is a limit of the control mesh is found again.\n"
               "JSON: samples, outside, snapped, unseen, iterations, refined, fields {name: rms, rms_boundary, max, max_at, "
               "range}, points, cells.") {
        app()
            .add_option(
                "DATA", input_,
                "a mesh, a .vdb grid of floats (0 where it is not active), or a table (.csv, .txt) of x, y, z and values")
            ->required();
        app().add_option("--onto", onto_, "the control mesh: a file or model:NAME:RESOLUTION")->type_name("MESH")->required();
        app()
            .add_option("-o,--output", output_, "the control mesh with the fitted fields (.vtu, .vtkhdf)")
            ->type_name("FILE")
            ->required();
        scheme_.add_scheme_to(app());
        add_options(app(), options_of(options_));
    }

    int run(Report& report) override {
        check_output(output_, {".vtu", ".vtkhdf"});
        ApproximateOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.names = OptionNames::Flags;
        options.progress = report.progress();
        report.if_long("--levels 1");
        if (kind_of(onto_) == InputKind::Bricks) {
            throw Error(ErrorCode::InvalidInput, "is a folder of bricks", onto_, "a mesh in one piece");
        }
        const HexMesh onto = report.unpack(load_mesh(onto_, CommonOptions{}, report.progress()));
        report["input"] = input_;
        report["onto"] = onto_;
        const HexMesh samples = read_data(onto, options, report);
        const Approximation made = report.timed("fit", [&] { return approximate(onto, samples, options); });
        for (const std::string& warning : report.timed("write", [&] { return write_mesh(output_, made.mesh, {}); })) {
            report.warn(warning);
        }
        put(made, report);
        return 0;
    }

private:
    [[nodiscard]] HexMesh read_data(const HexMesh& onto, const ApproximateOptions& options, Report& report) {
        const std::string extension = extension_of(input_);
        if (extension == ".csv" || extension == ".txt") {
            refuse_mesh_options(app(), "needs a mesh; this is a table");
            refuse_options(app(), {"--field"}, "needs a mesh or a grid; of a table all columns are taken");
            return report.timed("read", [&] { return read_samples(input_); });
        }
        if (is_vdb_file(input_)) return read_grid(onto, options, report);
        if (const InputKind kind = kind_of(input_); kind == InputKind::Points || kind == InputKind::Bricks) {
            throw Error(ErrorCode::InvalidInput, kind == InputKind::Points ? "has kernels" : "is a folder of bricks", input_,
                        "a mesh, a .vdb grid of floats, or a table (.csv, .txt)");
        }
        return with_written_field(report.unpack(load_mesh(input_, common(), report.progress())), common());
    }

    [[nodiscard]] HexMesh read_grid(const HexMesh& onto, const ApproximateOptions& options, Report& report) {
        refuse_mesh_options(app(), "needs a mesh; this is a grid of voxels");
        const VdbGrid grid = report.unpack(load_grid(input_, common(), report.progress()));
        HexMesh samples;
        Attribute field{.name = grid.report().name, .channels = 1, .values = {}};
        std::size_t active = 0;
        LimitOptions limit;
        limit.scheme = options.scheme;
        limit.progress = report.progress();
        for (const Vec3& place : report.timed("sample", [&] { return places_in_cells(onto, kPlacesPerEdge, limit); })) {
            const auto value = grid.value(place);
            active += value ? 1 : 0;
            samples.points.push_back(place);
            field.values.push_back(value.value_or(0));  // the background of fog
        }
        samples.attributes.push_back(std::move(field));
        if (active == 0) {
            throw Error(ErrorCode::InvalidInput, "no active voxel lies in the control mesh", input_, "a grid that overlaps it");
        }
        return samples;
    }

    void put(const Approximation& made, Report& report) const {
        const ApproximateReport& found = made.report;
        report.merge(facts_of(found));
        report["points"] = made.mesh.points.size();
        report["cells"] = made.mesh.cells.size();
        report["output"] = output_;
        report.say(text("samples     ", found.samples,
                        found.snapped > 0 ? text(", ", found.snapped, " of them moved to the boundary") : "",
                        found.outside > 0 ? text("; ", found.outside, " more lie outside and are left out") : ""));
        report.say(
            text("control     ", counted(made.mesh.points.size(), "point"),
                 found.refined > 0 ? text(", refined ", counted(static_cast<std::size_t>(found.refined), "time")) : "",
                 found.unseen > 0 ? text("; ", found.unseen, " without a sample near them continue what is around them") : ""));
        for (const FieldError& error : found.fields) {
            report.say(text(error.name, ": error ", error.rms, " RMS, at the boundary ", error.rms_boundary, ", at most ",
                            error.max, " at ", error.max_at.x, ", ", error.max_at.y, ", ", error.max_at.z,
                            "; the data's range is ", error.range));
        }
        report.all_said();
    }

    std::string input_, onto_, output_;
    RefineArguments scheme_;
    ApproximateOptions options_;
};

}  // namespace

std::unique_ptr<Verb> make_approximate_verb(CLI::App& program) {
    return std::make_unique<ApproximateVerb>(program);
}

}  // namespace subvol::cli
