// SPDX-License-Identifier: Apache-2.0
// The verb `vdb`: grids of voxels, one for each field, from a mesh, a sequence or points.
//
//     bricks   blocks of voxels, each from the cells about it; memory is that of a block
//     steps    a file for each step of a series, with velocities from the times of the steps
//     frames   a file for each mesh of a numbered sequence, or for each frame on the way from one mesh to another
//     points   sums of kernels in voxels
//     share    one slab of the voxels, to be joined
//     mesh     all voxels at once, or in parts within a given memory
//
// The first of these that fits the input and the options is done. Shares keep all bits of their values: they are rounded to 16
// bits where all voxels are at hand, so that the result does not depend on the number of shares. Of a mesh or of points, a
// result without any voxel is an error that suggests finer ones.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <tuple>

#include "bricks_input.h"
#include "choices.h"
#include "input.h"
#include "limit_warning.h"
#include "mesh_frames.h"
#include "mesh_grids.h"
#include "options.h"
#include "outputs.h"
#include "part_kinds.h"
#include "points_input.h"
#include "share.h"
#include "steps.h"
#include "subvol/error.h"
#include "subvol/nanovdb.h"
#include "subvol/option.h"
#include "subvol/rasterize.h"
#include "text.h"
#include "vdb_frames.h"
#include "vdb_functions.h"
#include "verb.h"
#include "voxels_of_points.h"

namespace subvol::cli {
namespace {

/// A name of an output with the number of a frame or step.
constexpr const char* kNumbered = "out_####.vdb";

class VdbVerb : public Verb {
public:
    explicit VdbVerb(CLI::App& program)
        : Verb(program, "vdb", "Turn a mesh, a sequence or points into an OpenVDB file: one grid per field.",
               "  subvol vdb model:ball -o ball.vdb\n"
               "  subvol vdb flow.vtk -o flow.vdb --fields Temp,V --resolution 400 --half\n"
               "  subvol vdb fire.vtu -o fire.vdb --fields \"heat=(Temp-293)/620\" --up y\n"
               "  subvol vdb part.vtu -o part.vdb --sdf --half-width 4\n"
               "  subvol vdb 'run_####.vtu' -o 'run_####.vdb' --frames 1-240 --velocity --fps 24\n"
               "  subvol vdb run.pvd -o 'run_####.vdb' --step all --velocity\n"
               "  subvol vdb rest.vtu --to bent.vtu -o 'bend_##.vdb' --frames 24\n"
               "  subvol vdb kernels.ply -o kernels.vdb --voxel-size 0.01\n"
               "  subvol vdb model:pawn -o pawn.vdb --resolution 1600 --memory 2G\n"
               "  subvol vdb big.vtu -o part2.vdb --part 2/4           a share, for join") {
        show_limit_of_parts();
        add_input(app(), "FILE", input_, text(input_help(), "; or points (.ply, .vtp, .svk, .vdb)"))->required();
        add_option(app(), Option("output", output_.path).also("o").help("FILE", "the file to write (.vdb)"))->required();
        asked_.add_sizes_to(app());
        refine_.add_to(app(), "rasterize the refined mesh of this level; omitted: the limit");
        asked_.add_grids_to(app());
        asked_.add_files_to(app());
        share_.add_to(app(), "a slab of the voxels, or some of the frames");
        asked_.add_frames_to(app());
        set_essentials({"--output", "--resolution", "--voxel-size", "--fields", "--levels", "--sdf", "--half", "--frames",
                        "--to", "--velocity", "--memory", "--nano"});
        group("Voxels", {"--voxel-size", "--resolution", "--like", "--budget"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle", "--from", "--per-edge"});
        group("Grids",
              {"--fields", "--cell-ids", "--mask", "--coverage", "--error", "--sdf", "--half-width", "--half", "--prune"});
        group("Files", {"--compression", "--memory", "--part", "--nano"});
        group("Sequences", {"--frames", "--to", "--velocity", "--fps"});
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        if (const auto one = asked_.level_set()) output_.level_set = one->name;
        check_choice("--from", asked_.from, {"mesh", "points"});
        check_choice("--up", asked_.up, {"z", "y"});
        if (asked_.nano && !vdb().has_nanovdb()) {
            throw Error(ErrorCode::MissingCapability, "this build has no NanoVDB", "--nano",
                        "configure again where libnanovdb-dev is installed");
        }
        output_.memory_bytes = asked_.memory_bytes;
        output_.nano = asked_.nano;
        output_.compression = asked_.compression;
        report.if_long("a lower --resolution, or --levels 1");
        check_output(output_.path, {".vdb"});
        const Share share = share_of(share_);
        MeshGrids maker(input_, asked_, refine_);
        const InputKind kind = kind_of(input_);
        if (kind == InputKind::Bricks) {
            run_bricks(maker, share, report);
        } else if (asks_for_steps(common())) {
            run_steps(maker, share, report);
        } else if (!asked_.frames.empty() || !asked_.to.empty() || has_number(input_)) {
            run_frames(maker, share, report);
        } else if (kind == InputKind::Points) {
            if (shares(share_)) {
                throw Error(ErrorCode::InvalidInput, "works with a mesh only, not with points",
                            ranks() != nullptr ? "vdb in several processes" : "--part");
            }
            run_points(maker, report);
        } else if (shares(share_)) {
            run_share(maker, share, report);
        } else {
            run_one(maker, report);
        }
        return 0;
    }

private:
    void run_one(MeshGrids& maker, Report& report) {
        report["input"] = input_;
        std::vector<Index> cells;
        const HexMesh mesh = report.unpack(maker.load(input_, common(), report.progress(), &cells));
        if (asked_.velocity && mesh.find_attribute(kVelocity) == nullptr) {
            throw Error(ErrorCode::InvalidInput, "needs a sequence, or a vector field that is called U, V or velocity",
                        "--velocity", "--frames A-B, or --fields vel=FIELD");
        }
        const bool once = output_.memory_bytes == 0;
        const RasterizeOptions options = report.unpack(maker.set_up(mesh, report.progress(), once, cells));
        if (options.limit != nullptr || options.refine.levels > 0) {  // else the cells are those of the file
            HexMesh part;
            report.warn(limit_warning(input_, rasterized_cells(mesh, cells, part), options.refine.scheme, report.progress()));
        }
        if (output_.memory_bytes > 0) {
            if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one file only, not with parts", "--error");
            refuse_with_memory();
            report.merge(write_parts(input_, mesh, names_of(mesh), options, output_,
                                     [&](std::vector<VdbGrid>& grids) { maker.fields().clamp(mesh, grids); }));
            return;
        }
        std::vector<VdbGrid> grids = report.unpack(maker.make(mesh, options));
        maker.fields().refuse_nothing_left(grids);
        if (!has_voxels(grids)) throw no_voxels(input_, finer_voxels(mesh));
        report.merge(maker.fields().overshoot(mesh, grids, !is_model(input_)));
        std::vector<GridErrorFigures> errors;
        if (asked_.error) errors = report.unpack(maker.add_errors(mesh, options, grids));
        report.merge(write_reported(grids, output_, report.progress()));
        for (const auto& [grid, max, rms] : errors) {
            report["grids"][grid]["error_max"] = max;
            report["grids"][grid]["error_rms"] = rms;
        }
    }

    /// Block by block of voxels, each from the cells about it.
    void run_bricks(const MeshGrids& maker, const Share& share, Report& report) {
        refuse_options(app(),
                       {"--budget", "--remap", "--clamp", "--up", "--scale", "--cell-ids", "--error", "--coverage", "--sdf",
                        "--from", "--nano", "--frames", "--to", "--velocity"},
                       "needs the whole mesh in memory; this is a folder of bricks");
        maker.tets().refuse_bricks(input_);
        report["input"] = input_;
        const Bricks bricks = report.unpack(open_bricks_input(input_, app()));
        RasterizeOptions options = maker.options(report.progress());
        options.voxel_size_world = asked_.grids.voxel_size_world;
        options.resolution = asked_.grids.resolution;
        options.voxel_size_world = voxel_size_of(bricks.bounds, options);
        options.refine = refine_.options(0, report.progress());
        options.on_limit = !interpolates(options.refine.scheme.kind);
        options.metadata.emplace_back("subvol_scheme", refine_.scheme);
        options.find_limit = !refine_.levels;
        if (output_.memory_bytes > 0) options.block_bytes = output_.memory_bytes;
        const std::vector<StreamedField> fields = fields_of_bricks(maker, bricks, report);
        std::vector<SourceField> written;
        std::vector<std::string> names;
        for (const StreamedField& field : fields) {
            const std::string& name = names.emplace_back(field.name.empty() ? "density" : field.name);
            written.push_back({name, field.vector ? 3 : 1, field.min, field.max});
        }
        const auto chosen = [&](HexMesh brick) { return with_brick_fields(std::move(brick), fields); };
        const MeshSource source = source_of(bricks).changed(chosen, written);
        if (!shares(share_)) {
            report.merge(write_parts(input_, source, names, options, output_,
                                     [&](std::vector<VdbGrid>& grids) { maker.fields().prune(grids); }));
            return;
        }
        GridShare made = report.timed("rasterize", [&] { return vdb().rasterize_share(source, names, options, share); });
        maker.fields().prune(made.grids);
        report.merge(facts_of(made.report));
        const auto all = whole_of(std::move(made), report);
        if (!all) return;
        if (!has_voxels(*all)) throw no_voxels(input_, finer_voxels(source));
        report.merge(write_reported(*all, output_, report.progress()));
    }

    [[nodiscard]] std::vector<StreamedField> fields_of_bricks(const MeshGrids& maker, const Bricks& bricks,
                                                              Report& report) const {
        std::vector<StreamedField> fields;
        for (const auto& [name, source] : maker.fields().asked()) {
            if (name != source)
                throw Error(ErrorCode::InvalidInput, "of bricks, fields are written as they are", "--fields", source);
            fields.push_back(named_brick_field(bricks, name, true));
        }
        if (fields.empty()) fields.push_back(report.unpack(select_brick_field(bricks, common())));
        return fields;
    }

    /// One slab of the voxels, as a file of its own.
    void run_share(MeshGrids& maker, const Share& share, Report& report) {
        refuse_options(app(), {"--velocity", "--error", "--memory", "--nano"},
                       ranks() != nullptr ? "does not work in several processes of MPI" : "does not work with --part");
        if (asked_.from == "points") throw Error(ErrorCode::InvalidInput, "is not done in shares", "--from points");
        report["input"] = input_;
        std::vector<Index> cells;
        const HexMesh mesh = report.unpack(maker.load(input_, common(), report.progress(), &cells));
        const RasterizeOptions options = report.unpack(maker.set_up(mesh, report.progress(), false, cells));
        GridShare made = report.timed("rasterize", [&] { return vdb().rasterize_share(mesh, names_of(mesh), options, share); });
        maker.fields().clamp(mesh, made.grids);
        const auto all = whole_of(std::move(made), report);
        if (!all) return;
        if (!has_voxels(*all)) throw no_voxels(input_, finer_voxels(mesh));
        report.merge(maker.fields().overshoot(mesh, *all, !is_model(input_)));
        report.merge(write_reported(*all, output_, report.progress()));
    }

    /// The grids of all shares, if this process has them; nothing if it has written or sent its own.
    ///
    /// own: this process's share. Its grids are not rounded to 16 bits: that is done with all voxels at hand
    [[nodiscard]] std::optional<std::vector<VdbGrid>> whole_of(GridShare own, Report& report) {
        for (VdbGrid& grid : own.grids) vdb().store_in_half(grid, false);
        const Transport to =
            transport(share_, input_, own.layers,
                      {{"half", asked_.grids.half}, {"compression", std::string(name_of(asked_.compression))}}, report);
        auto all = report.unpack(deliver(GridParts{output_, report.progress()}, std::move(own.grids), to));
        if (!all) return all;
        for (VdbGrid& grid : *all) vdb().store_in_half(grid, asked_.grids.half);
        return all;
    }

    void run_points(const MeshGrids& maker, Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "needs a mesh; these are points", "--error");
        if (asked_.velocity) throw Error(ErrorCode::InvalidInput, "needs a sequence", "--velocity", "--frames A-B");
        asked_.from = "points";
        RasterizeOptions options = maker.options(report.progress());
        options.voxel_size_world = asked_.grids.voxel_size_world;
        options.resolution = asked_.grids.resolution;
        options.level_set = asked_.level_set();
        refuse_options(app(), {"--remap", "--clamp", "--up", "--scale"}, "needs a mesh; these are points");
        std::vector<std::string> names;
        for (const GridField& field : maker.fields().asked()) {
            if (field.name != field.source) {
                throw Error(ErrorCode::InvalidInput, "needs a mesh; points have channels",
                            "--fields " + field.name + "=" + field.source, "--fields with names of channels");
            }
            names.push_back(field.name);
        }
        report["input"] = input_;
        std::vector<VdbGrid> grids = report.unpack(grids_of_points(input_, names, common(), app(), options));
        maker.fields().prune(grids);
        maker.fields().refuse_nothing_left(grids);
        if (!has_voxels(grids)) {
            throw no_voxels(input_, text("try --voxel-size below ", grids.front().report().voxel_size_world));
        }
        report.merge(write_reported(grids, output_, report.progress()));
    }

    void run_frames(MeshGrids& maker, const Share& share, Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--error");
        check_frame_names();
        const FrameRange range = parse_frames(asked_.frames);
        if (asked_.to.empty()) check_frames(input_, range);
        MeshFrames frames(input_, asked_.to.empty() ? std::nullopt : std::optional(asked_.to), range,
                          [&](const std::string& name) { return load(maker, name, common(), report); });
        write(maker, {frames, range, share, {}}, report);
    }

    void run_steps(MeshGrids& maker, const Share& share, Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one step only", "--error", "--step N");
        if (!asked_.frames.empty() || !asked_.to.empty()) {
            throw Error(ErrorCode::InvalidInput, "a series has steps", asked_.frames.empty() ? "--to" : "--frames",
                        "--step A-B");
        }
        if (app().count("--fps") > 0) {
            throw Error(ErrorCode::InvalidInput, "the velocity of steps follows from their times", "--fps");
        }
        check_numbered(output_.path, "step", kNumbered);
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        const CommonOptions all = report.unpack(for_steps(input_, common(), range, report.progress()));
        MeshFrames frames(range, series.times, [&](int step) { return load(maker, input_, of_step(all, step), report); });
        const FrameRange steps = frames_of(share, range);
        report["times"] = std::vector(series.times.begin() + steps.first, series.times.begin() + steps.last + 1);
        write(maker, {frames, range, share, series.times}, report);
    }

    void write(MeshGrids& maker, const FramesToGrids& frames, Report& report) {
        if (output_.memory_bytes > 0)
            throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--memory");
        if (share_.given()) report["part"] = frames.share.name();
        StepsWithFields taken(report);
        FramesToGrids there = frames;  // from the first that has the fields: the grids are set up for it
        while (there.all.first < there.all.last &&
               !taken.take(there.all.first, [&] { std::ignore = frames.frames.mesh(there.all.first); }))
            ++there.all.first;
        FrameWriter writer(maker, there, asked_, output_, report.progress());
        report.merge(writer.facts());
        report["frames"] = Json::array();
        const FrameRange range = frames_of(frames.share, frames.all);
        for (int frame = std::max(range.first, there.all.first); frame <= range.last; ++frame) {
            const int number = frame - range.first;
            report.begin_part(text("frame ", number + 1, " of ", range.count()), static_cast<std::size_t>(number),
                              static_cast<std::size_t>(range.count()));
            taken.take(frame, [&] {
                const Facts entry = report.unpack(writer.write(frame));  // may move the list
                report["frames"].push_back(json_of(entry));
            });
        }
        taken.finish();
        if (ranks() != nullptr) report["frames"] = ranks()->gather_list(report["frames"]);
        report["input"] = input_;
        report["output"] = output_.path;
    }

    [[nodiscard]] static HexMesh load(const MeshGrids& maker, const std::string& input, const CommonOptions& options,
                                      Report& report) {
        report["input"] = input;
        return report.unpack(maker.load(input, options, report.progress()));
    }

    void check_frame_names() const {
        if (asked_.frames.empty()) throw Error(ErrorCode::InvalidInput, "is needed for a sequence", "--frames", "1-10");
        check_numbered(output_.path, "frame", kNumbered);
        const std::string one_or_two = "in_####.vtu, or one mesh and --to another";
        if (asked_.to.empty()) {
            check_numbered(input_, "frame", one_or_two);
        } else if (has_number(input_)) {
            throw Error(ErrorCode::InvalidInput, "has a # for a number, but --to is given", input_, one_or_two);
        }
    }

    void refuse_with_memory() const {
        if (asked_.from == "points") throw Error(ErrorCode::InvalidInput, "works with a mesh only", "--memory");
        if (output_.nano) throw Error(ErrorCode::InvalidInput, "works with one file only, not with parts", "--nano");
    }

    std::string input_;
    VdbArguments asked_;
    VdbOutput output_;
    RefineArguments refine_;
    ShareArgument share_;
};

}  // namespace

std::unique_ptr<Verb> make_vdb_verb(CLI::App& program) {
    return std::make_unique<VdbVerb>(program);
}

}  // namespace subvol::cli
