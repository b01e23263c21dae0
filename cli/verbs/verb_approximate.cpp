// SPDX-License-Identifier: Apache-2.0
// The verb `approximate`: it fits a control mesh to data, so that the limit of the mesh has the fields or the shape of the
// data.
//
//     data      a mesh, or a table of places and values           ─► samples
//               a grid, read at places in each control cell       ─► samples
//               a surface, or a level set where its distance is 0 ─► surface
//     shape     the control points move until the limit's boundary is near the surface, if that is asked for
//     fields    values at the control points by least squares of the limit at the samples
//     mapping   or the values of the data's cells at the control points, as they are, if --at-points asks for it
//     output    the control mesh with these values, and the errors at the samples and between them
//
// Of a series, each step or frame is fitted onto the same control mesh; one approximator keeps the places of the samples in
// the mesh while they stay the same, and says how often it had to find them. The exit code is 1 if a fitted shape is not
// sound.
#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <optional>

#include "grid_input.h"
#include "input.h"
#include "mesh_figures.h"
#include "mesh_frames.h"
#include "mesh_output.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "places_input.h"
#include "points_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/approximate.h"
#include "subvol/approximator.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "subvol/fit_shape.h"
#include "subvol/mesh_io.h"
#include "subvol/option.h"
#include "subvol/read_surface.h"
#include "text.h"
#include "vdb_functions.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// In each cell of the control mesh a grid is sampled at so many places along each edge.
constexpr int kPlacesPerEdge = 4;

constexpr std::initializer_list<const char*> kOfFields{"--levels", "--reach",  "--smoothing", "--iterations",
                                                       "--clamp",  "--refine", "--tolerance"};

class ApproximateVerb : public Verb {
public:
    explicit ApproximateVerb(CLI::App& program)
        : Verb(program, "approximate",
               "Fit a control mesh to data: its fields to a mesh, a grid or samples, its shape to a surface.",
               "  subvol approximate fine.vtu --onto coarse.vtu -o fitted.vtu\n"
               "  subvol approximate smoke.vdb --cells 32 -o smoke.vtu --refine 1 --tolerance .01\n"
               "  subvol approximate measured.csv --onto part.vtu -o fitted.vtu --smoothing 1e-3\n"
               "  subvol approximate run.pvd --onto coarse.vtu -o 'fitted_####.vtu' --step all\n"
               "  subvol approximate 'smoke_####.vdb' --onto coarse.vtu -o 'fitted_####.vtu' --frames 1-48\n"
               "  subvol approximate scan.stl --shape --onto block.vtu -o fitted.vtu\n"
               "  subvol approximate result.frd --onto other.inp -o mapped.vtu --at-points\n"
               "\n"
               "Least squares through the limit: a field that is a limit of the control mesh is found again.\n"
               "JSON: samples, between, outside, snapped, unseen, undecided, iterations, refined, continuous, fields {name: "
               "rms, "
               "rms_boundary, max, max_at, range, rms_between, max_between, max_between_at, beyond}, points, cells; of several "
               "steps or frames these are in the list frames, with frame, time and output, "
               "beside placements; with --shape also shape {before, after: rms, max, missed_rms, missed_max and their places; "
               "rounds, moved_world, volume_world, folds, mended}; with --at-points outside, farthest_world, farthest_at, "
               "points, "
               "cells.") {
        add_input(app(), "DATA", input_,
                  "a mesh, a .vdb grid of floats (where it is not active 0, or the background of a level set), a table "
                  "(.csv, .txt) of x, y, z and values, or "
                  "with --shape a surface (.stl, .obj, .ply, .glb, or a .vdb level set, where its distance is 0)")
            ->required();
        add_option(app(), Option("onto", onto_).help("MESH", "the control mesh: a file or model:NAME:RESOLUTION"));
        add_option(app(),
                   Option("cells", cells_)
                       .between(1, 1000)
                       .help("N",
                             "of grids, instead of --onto: a box of cubes about the active voxels, of all frames, N along "
                             "its longest side")
                       .instead_of({"onto"}));
        add_option(app(),
                   Option("output", output_).also("o").help("FILE", "the control mesh with the fitted fields (.vtu, .vtkhdf)"))
            ->required();
        add_option(
            app(),
            Option("frames", frames_)
                .help("A-B",
                      "a sequence of files: A-B, or N for 1-N. In DATA and --output a row of # is replaced by the number"))
            ->transform(frame_range());
        add_option(app(),
                   Option("at-points", at_points_)
                       .help("no fit: the values of the cells of DATA, a mesh, at the points of the control mesh; outside "
                             "those of the nearest place"));
        scheme_.add_scheme_to(app());
        add_options(app(), options_of(options_));
        CLI::Option* shape = add_option(
            app(), Option("shape", shape_).help("move the control points first: the limit's boundary to that of DATA"));
        add_options(app(), options_of(shaping_));
        for (const char* name : {"--shape-rounds", "--stiffness", "--keep-folds", "--boundary-move"})
            app().get_option(name)->needs(shape);
    }

    int run(Report& report) override {
        check_output(output_, {".vtu", ".vtkhdf"});
        ApproximateOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.names = OptionNames::Flags;
        options.progress = report.progress();
        options.keep_sign = is_vdb_file(input_);
        report.if_long("--levels 1");
        check_control(report);
        if (!cells_ && kind_of(onto_) == InputKind::Bricks) {
            throw Error(ErrorCode::InvalidInput, "is a folder of bricks", onto_, "a mesh in one piece");
        }
        const std::optional<Sequence> sequence = steps_or_frames(report);
        if (at_points_) check_mapping();
        MeshSets sets;
        HexMesh onto = cells_ ? mesh_of_box(box_of_grids(sequence, report), *cells_)
                              : report.unpack(load_mesh(onto_, CommonOptions{}, report.progress(), sets));
        report["input"] = input_;
        if (!cells_) report["onto"] = onto_;
        if (at_points_) {
            map_all(sequence, onto, sets, options, report);
            return 0;
        }
        if (sequence) {
            fit_all(*sequence, std::move(onto), sets, options, report);
            return 0;
        }
        Approximation made;
        if (is_surface()) {
            made.mesh = shaped(std::move(onto), read_surface_data(report), report);
        } else {
            const HexMesh samples = read_data(input_, common(), onto, options, report);
            if (shape_) onto = shaped(std::move(onto), boundary_surface(samples), report);
            made = report.timed("fit", [&] { return approximate(onto, samples, options); });
        }
        if (!made.parts.empty()) sets = sets_of_parts(std::move(sets), made.parts);
        report.merge(write_reported(output_, made.mesh, {}, sets, report.progress()));
        put(made, report);
        return is_sound_ ? 0 : 1;
    }

private:
    void check_control(Report& report) const {
        report["input"] = input_;
        if (!cells_ && onto_.empty()) {
            throw Error(ErrorCode::InvalidInput, "is needed: the control mesh", "--onto",
                        is_vdb_file(input_) ? "--onto MESH, or --cells N for a box about the grid" : "--onto MESH");
        }
        if (!cells_) return;
        if (!is_vdb_file(input_))
            throw Error(ErrorCode::InvalidInput, "makes a box about a grid of voxels; this is none", "--cells", "--onto MESH");
        if (shape_) throw Error(ErrorCode::InvalidInput, "needs a control mesh near the shape", "--shape", "--onto MESH");
    }

    /// Data of several times.
    ///
    /// times: of steps, from step 0; empty: of frames
    /// input, options: of the data of a number
    struct Sequence {
        const char* name;
        FrameRange range;
        std::vector<double> times;
        std::function<std::string(int)> input;
        std::function<CommonOptions(int)> options;
    };

    /// The box of the active voxels, of all frames.
    [[nodiscard]] Box box_of_grids(const std::optional<Sequence>& sequence, Report& report) {
        Box box;
        const auto add = [&](const std::string& input, const CommonOptions& reading) {
            report["input"] = input;
            const VdbGrid grid = report.unpack(load_grid(input, reading, report.progress()));
            const Box one = box_of(grid.report());
            box.add(one.lower);
            box.add(one.upper);
        };
        if (!sequence) {
            add(input_, common());
        } else {
            for (int number = sequence->range.first; number <= sequence->range.last; ++number)
                add(sequence->input(number), sequence->options(number));
        }
        return box;
    }

    [[nodiscard]] std::optional<Sequence> steps_or_frames(Report& report) const {
        const bool of_files = !frames_.empty() || has_number(input_);
        if (!of_files && (!asks_for_steps(common()) || !may_have_steps(input_) || is_surface())) return std::nullopt;
        if (shape_) {
            throw Error(ErrorCode::InvalidInput, "moves control points, and all steps have the same", "--shape",
                        "one step with it, whose control mesh then serves the series");
        }
        if (of_files) {
            if (frames_.empty()) throw Error(ErrorCode::InvalidInput, "is needed for a sequence", "--frames", "1-10");
            check_numbered(input_, "frame", "data_####.csv");
            if (asks_for_steps(common())) {
                throw Error(ErrorCode::InvalidInput, "files of a sequence have one step each here", "--step", "--frames A-B");
            }
        }
        check_numbered(output_, of_files ? "frame" : "step", "fitted_####.vtu");
        if (of_files) {
            const FrameRange range = parse_frames(frames_);
            check_frames(input_, range);
            return Sequence{
                "frame", range, {}, [this](int frame) { return with_number(input_, frame); }, [this](int) { return common(); }};
        }
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        const CommonOptions all = report.unpack(for_steps(input_, common(), range, report.progress()));
        return Sequence{"step", range, series.times, [this](int) { return input_; },
                        [all](int step) { return of_step(all, step); }};
    }

    void fit_all(const Sequence& sequence, HexMesh onto, const MeshSets& sets, const ApproximateOptions& options,
                 Report& report) {
        Approximator approximator(onto, options);
        report["frames"] = Json::array();
        const FrameRange& range = sequence.range;
        for (int number = range.first; number <= range.last; ++number) {
            const std::string name = text(sequence.name, " ", number), path = with_number(output_, number);
            const auto index = static_cast<std::size_t>(number - range.first);
            report.begin_part(name, index, static_cast<std::size_t>(range.count()));
            const std::string input = sequence.input(number);
            const HexMesh samples = read_data(input, sequence.options(number), onto, options, report);
            const Approximation made = report.timed("fit", [&] {
                try {
                    return approximator.fit(samples, report.progress());
                } catch (const Error& error) {
                    if (error.where() != "samples") throw;
                    throw Error(error.code(), error.message(), sequence.times.empty() ? input : text(input, ", ", name),
                                error.allowed());
                }
            });
            report.merge(write_reported(path, made.mesh, {}, sets, report.progress()));
            Json entry{{"frame", number}};
            if (!sequence.times.empty()) entry["time"] = sequence.times[static_cast<std::size_t>(number)];
            entry.update(json_of(facts_of(made.report)));
            entry["output"] = path;
            report["frames"].push_back(std::move(entry));
            say_fields(made.report, name + ", ", report);
        }
        report["placements"] = approximator.placements();
        report["points"] = onto.points.size();
        report["cells"] = onto.cells.size();
        report["output"] = output_;
        report.say(text("control     ", counted(onto.points.size(), "point"), "; the samples' places were found ",
                        counted(approximator.placements(), "time"), " for ",
                        counted(static_cast<std::size_t>(range.count()), sequence.name)));
        report.all_said();
    }

    void check_mapping() {
        refuse_options(app(), kOfFields, "is about a fit; --at-points takes the values as they are");
        refuse_options(app(), {"--scheme", "--tension", "--crease-angle", "--shape", "--cells"},
                       "is about a fit; --at-points takes the values of the cells as they are");
        if (is_surface() || kind_of(input_) != InputKind::Mesh)
            throw Error(ErrorCode::InvalidInput, "has no cells with values between points, which --at-points takes", input_,
                        "a mesh; or a fit, without --at-points");
    }

    /// Values of the cells of the data at the points of the control mesh, of each step or frame.
    void map_all(const std::optional<Sequence>& sequence, const HexMesh& onto, const MeshSets& sets,
                 const ApproximateOptions& options, Report& report) {
        const auto map = [&](const std::string& input, const CommonOptions& reading, const std::string& output) {
            const HexMesh data = read_data(input, reading, onto, options, report);
            MappedFields mapped = report.timed("map", [&] { return map_fields(onto, data, report.progress()); });
            report.merge(write_reported(output, mapped.mesh, {}, sets, report.progress()));
            const MapReport& found = mapped.report;
            if (found.outside > 0) {
                const Vec3& at = found.farthest_at;
                report.warn(text(counted(found.outside, "point"), " of ", onto.points.size(), " lie outside of ", input,
                                 ", at most ", found.farthest_world, " from it, at ", at.x, ", ", at.y, ", ", at.z,
                                 ": they have the values of its nearest place"));
            }
            return facts_of(found);
        };
        report["points"] = onto.points.size();
        report["cells"] = onto.cells.size();
        report["output"] = output_;
        if (!sequence) return report.merge(map(input_, common(), output_));
        const FrameRange& range = sequence->range;
        report["frames"] = Json::array();
        for (int number = range.first; number <= range.last; ++number) {
            const std::string path = with_number(output_, number);
            report.begin_part(text(sequence->name, " ", number), static_cast<std::size_t>(number - range.first),
                              static_cast<std::size_t>(range.count()));
            Json entry{{"frame", number}};
            if (!sequence->times.empty()) entry["time"] = sequence->times[static_cast<std::size_t>(number)];
            entry.update(json_of(map(sequence->input(number), sequence->options(number), path)));
            entry["output"] = path;
            report["frames"].push_back(std::move(entry));
        }
    }

    /// A .ply file has kernels, unless its shape is asked for; so has a grid fields.
    [[nodiscard]] bool is_surface() const {
        return shape_ ? is_surface_file(input_) || is_vdb_file(input_)
                      : is_surface_file(input_) && extension_of(input_) != ".ply";
    }

    [[nodiscard]] Surface read_surface_data(Report& report) {
        if (!shape_) {
            detail::refuse_missing(input_);
            throw Error(ErrorCode::InvalidInput, "is a surface, which has a shape but no fields", input_,
                        "--shape with it; `" + detail::command_for_surface(input_) + "` makes a control mesh of it");
        }
        if (is_vdb_file(input_)) return level_set_surface(report);
        refuse_mesh_options(app(), "needs a mesh; this is a surface");
        refuse_options(app(), {"--field"}, "is about fields; a surface has none");
        refuse_options(app(), kOfFields, "is about fields; a surface has none");
        return report.timed("read", [&] { return read_surface(input_); });
    }

    /// The surface where the distances of a level set are 0.
    [[nodiscard]] Surface level_set_surface(Report& report) {
        refuse_mesh_options(app(), "needs a mesh; this is a grid of voxels");
        refuse_options(app(), kOfFields, "is about fields; of a level set the shape is taken");
        const VdbGrid grid = report.unpack(load_grid(input_, common(), report.progress()));
        if (!grid.report().level_set) {
            throw Error(ErrorCode::InvalidInput, "is fog, which has no surface of its own",
                        text(input_, ", grid ", grid.report().name),
                        "a level set; `" + detail::command_for_surface(input_, "--iso VALUE") + "` makes a control mesh of it");
        }
        return report.timed("read", [&] { return vdb().grid_surface(grid, std::nullopt); });
    }

    [[nodiscard]] HexMesh shaped(HexMesh onto, const Surface& surface, Report& report) {
        FitShapeOptions options = shaping_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.names = OptionNames::Flags;
        options.progress = report.progress();
        ShapedMesh made = report.timed("shape", [&] { return fit_shape(std::move(onto), surface, options); });
        Facts found;
        found["shape"] = facts_of(made.report);
        report.merge(found);
        const ShapeError &before = made.report.before, &after = made.report.after;
        report.say(text("shape       boundary ", after.rms, " RMS from the surface (before ", before.rms, "), at most ",
                        after.max, " at ", after.max_at.x, ", ", after.max_at.y, ", ", after.max_at.z));
        report.say(text("            surface ", after.missed_rms, " RMS from the boundary (before ", before.missed_rms,
                        "), at most ", after.missed_max));
        report.say(text("folds       ", fold_text(made.report.folds, made.mesh.cells.size())));
        for (const std::string& warning : made.report.warnings) report.warn(warning);
        is_sound_ = made.report.is_sound();
        return std::move(made.mesh);
    }

    [[nodiscard]] HexMesh read_data(const std::string& input, const CommonOptions& reading, const HexMesh& onto,
                                    const ApproximateOptions& options, Report& report) {
        const std::string extension = extension_of(input);
        if (shape_ && (extension == ".csv" || extension == ".txt"))
            throw Error(ErrorCode::InvalidInput, "has no shape", "--shape", "a mesh, a surface or a level set");
        if (extension == ".csv" || extension == ".txt") {
            refuse_mesh_options(app(), "needs a mesh; this is a table");
            refuse_options(app(), {"--field"}, "needs a mesh or a grid; of a table all columns are taken");
            return report.timed("read", [&] { return read_samples(input); });
        }
        if (is_vdb_file(input)) return read_grid(input, reading, onto, options, report);
        if (const InputKind kind = kind_of(input); kind == InputKind::Points || kind == InputKind::Bricks) {
            if (kind == InputKind::Points) (void)read_points_input(input, report.progress());  // a .ply file may be a surface
            throw Error(ErrorCode::InvalidInput, kind == InputKind::Points ? "has kernels" : "is a folder of bricks", input,
                        "a mesh, a .vdb grid of floats, or a table (.csv, .txt)");
        }
        return with_written_field(report.unpack(load_mesh(input, reading, report.progress())), reading);
    }

    [[nodiscard]] HexMesh read_grid(const std::string& input, const CommonOptions& reading, const HexMesh& onto,
                                    const ApproximateOptions& options, Report& report) {
        refuse_mesh_options(app(), "needs a mesh; this is a grid of voxels");
        const VdbGrid grid = report.unpack(load_grid(input, reading, report.progress()));
        HexMesh samples;
        Attribute field{.name = grid.report().name, .channels = 1, .values = {}};
        std::size_t covered = 0;
        LimitOptions limit;
        limit.scheme = options.scheme;
        limit.progress = report.progress();
        if (places_.empty()) places_ = report.timed("sample", [&] { return places_in_cells(onto, kPlacesPerEdge, limit); });
        for (const Vec3& place : places_) {
            const auto value = grid.value(place);
            covered += value ? 1 : 0;
            samples.points.push_back(place);
            field.values.push_back(value.value_or(grid.report().outside));
        }
        samples.attributes.push_back(std::move(field));
        if (covered == 0) {
            throw Error(ErrorCode::InvalidInput, "no active voxel lies in the control mesh", input, "a grid that overlaps it");
        }
        return samples;
    }

    void put(const Approximation& made, Report& report) const {
        const ApproximateReport& found = made.report;
        if (!is_surface()) report.merge(facts_of(found));
        report["points"] = made.mesh.points.size();
        report["cells"] = made.mesh.cells.size();
        report["output"] = output_;
        if (is_surface()) {
            report.all_said();
            return;
        }
        report.say(text("samples     ", found.samples,
                        found.between > 0 ? text(", and ", found.between, " between the points of the data") : "",
                        found.snapped > 0 ? text(", ", found.snapped, " of them moved to the boundary") : "",
                        found.outside > 0 ? text("; ", found.outside, " more lie outside and are left out") : ""));
        report.say(text("control     ", counted(made.mesh.points.size(), "point"),
                        found.refined > 0 ? text(", refined ", counted(static_cast<std::size_t>(found.refined), "time")) : ""));
        say_fields(found, "", report);
        report.all_said();
    }

    /// before: the names
    static void say_fields(const ApproximateReport& found, const std::string& before, Report& report) {
        for (const FieldError& error : found.fields) {
            report.say(text(before, error.name, ": error ", error.rms, " RMS, ",
                            std::isnan(error.rms_boundary) ? "" : text("at the boundary ", error.rms_boundary, ", "),
                            "at most ", error.max, " at ", error.max_at.x, ", ", error.max_at.y, ", ", error.max_at.z,
                            "; the data's range is ", error.range));
            const Vec3& at = error.max_between_at;
            report.say(text(before, error.name, ": between the samples ", error.rms_between, " RMS from ",
                            found.continuous ? "the data" : "the nearest sample", ", at most ", error.max_between, " at ", at.x,
                            ", ", at.y, ", ", at.z, "; beyond the data's range by at most ", error.beyond));
        }
        if (found.undecided == 0) return;
        report.warn(text(before, "samples hardly decide the values of ", counted(found.undecided, "control point"),
                         found.unseen > 0 ? text(", ", found.unseen, " of which have none near them") : "",
                         ": these continue the values around them, and the error there is not known; a coarser control mesh or "
                         "more samples decide them"));
    }

    std::string input_, onto_, output_, frames_;
    std::optional<int> cells_;
    std::vector<Vec3> places_;  // where grids are sampled
    RefineArguments scheme_;
    ApproximateOptions options_;
    FitShapeOptions shaping_;
    bool shape_ = false, at_points_ = false;
    bool is_sound_ = true;  // the shape that was fitted
};

}  // namespace

std::unique_ptr<Verb> make_approximate_verb(CLI::App& program) {
    return std::make_unique<ApproximateVerb>(program);
}

}  // namespace subvol::cli
