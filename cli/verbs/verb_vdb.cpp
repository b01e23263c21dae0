// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "bricks_input.h"
#include "bricks_vdb.h"
#include "choices.h"
#include "grid_fields.h"
#include "input.h"
#include "mesh_frames.h"
#include "outputs.h"
#include "part_note.h"
#include "points_input.h"
#include "quantities.h"
#include "rank_report.h"
#include "refine_arguments.h"
#include "share.h"
#include "steps.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/field_expression.h"
#include "subvol/field_range.h"
#include "subvol/grid_error.h"
#include "subvol/join_grids.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_report.h"
#include "subvol/nanovdb.h"
#include "subvol/rasterize.h"
#include "subvol/spread_vectors.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/version.h"
#include "tet_refinement.h"
#include "text.h"
#include "vdb_arguments.h"
#include "vdb_output.h"
#include "verb.h"
#include "voxels_of_points.h"

namespace subvol::cli {
namespace {

constexpr double kBytesOfChannel = 5.5;     // a voxel's float in leaves that are not all full, with their masks
constexpr double kMostCellsOfTables = 8e6;  // refined cells, about 200 bytes each
constexpr const char* kVelocity = "vel";
// Velocities are written beyond the volume as far as it moves in this time: renderers open the shutter for a frame at most,
// usually centred on the frame's time.
constexpr double kShutter_frames = 0.5;
// In voxels. With more, the grid of a volume 200 voxels wide would have more voxels outside the volume than inside.
constexpr int kMostVelocityLayers = 64;

std::vector<std::string> names_of(const HexMesh& mesh) {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
    return names;
}

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
        app().add_option("FILE", input_, text(input_help(), "; or points (.ply, .vtp, .vdb)"))->required();
        app().add_option("-o,--output", output_.path, "the file to write (.vdb)")->type_name("FILE")->required();
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
        group("Grids", {"--fields", "--cell-ids", "--mask", "--coverage", "--error", "--sdf", "--half-width", "--half"});
        group("Files", {"--compression", "--memory", "--part", "--nano"});
        group("Sequences", {"--frames", "--to", "--velocity", "--fps"});
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        if (const auto one = asked_.level_set()) output_.level_set = one->name;
        check_choice("--from", asked_.from, {"mesh", "points"});
        check_choice("--up", asked_.up, {"z", "y"});
        fields_wanted_ = parse_grid_fields(asked_.fields);
        tets_ = TetRefinement(refine_);
        for (const std::string& remap : asked_.remaps) parsed_remaps_.push_back(parse_remap(remap));
        if (asked_.nano && !has_nanovdb()) {
            throw Error(ErrorCode::MissingCapability, "this build has no NanoVDB", "--nano",
                        "configure again where libnanovdb-dev is installed");
        }
        output_.memory_bytes = asked_.memory_bytes;
        output_.nano = asked_.nano;
        output_.compression = compression_named(asked_.compression);
        report.if_long("a lower --resolution, or --levels 1");
        check_output(output_.path, {".vdb"});
        const Share share = share_of(share_);
        if (!asked_.like.empty()) like_grids_ = read_vdb(asked_.like);
        if (is_bricks_input(input_)) {
            run_bricks(share, report);
        } else if (asks_for_steps(common())) {
            run_steps(share, report);
        } else if (!asked_.frames.empty() || !asked_.to.empty() || has_number(input_)) {
            run_frames(share, report);
        } else if (holds_points(input_)) {
            if (shares(share_)) {
                throw Error(ErrorCode::InvalidInput, "works with a mesh only, not with points",
                            ranks() != nullptr ? "vdb in several processes" : "--part");
            }
            run_points(report);
        } else if (shares(share_)) {
            run_share(share, report);
        } else {
            run_one(report);
        }
        return 0;
    }

private:
    [[nodiscard]] HexMesh load(const std::string& input, const CommonOptions& options, Report& report) const {
        HexMesh mesh = with_written_fields(tets_.hexes(load_mesh(input, options, report), 2, report), report);
        for (const Remap& remap : parsed_remaps_) apply(remap, mesh);
        if (asked_.up == "y") turn_y_up(mesh);
        if (asked_.scale != 1) scale_points(mesh, asked_.scale);
        return mesh;
    }

    void run_one(Report& report) {
        if (asked_.velocity) throw Error(ErrorCode::InvalidInput, "needs a sequence", "--velocity", "--frames A-B");
        const HexMesh mesh = load(input_, common(), report);
        const RasterizeOptions options = set_up(mesh, report);
        if (output_.memory_bytes > 0) {
            if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one file only, not with parts", "--error");
            refuse_with_memory();
            write_parts(input_, mesh, names_of(mesh), options, output_, report,
                        [&](std::vector<VdbGrid>& grids) { clamp_grids(mesh, grids); });
            return;
        }
        std::vector<VdbGrid> grids = grids_of(mesh, options, report);
        if (!has_voxels(grids)) throw no_voxels(input_, finer_voxels(mesh));
        note_overshoot(mesh, grids, report);
        const auto errors = asked_.error ? add_errors(mesh, options, grids, report) : std::vector<GridErrorFigures>();
        write_reported(grids, output_, report);
        for (const auto& [grid, max, rms] : errors) {
            report["grids"][grid]["error_max"] = max;
            report["grids"][grid]["error_rms"] = rms;
        }
    }

    /// Block by block of voxels, each from the cells about it.
    void run_bricks(const Share& share, Report& report) {
        refuse_options(app(),
                       {"--budget", "--remap", "--clamp", "--up", "--scale", "--cell-ids", "--error", "--coverage", "--sdf",
                        "--from", "--nano", "--frames", "--to", "--velocity"},
                       "needs the whole mesh in memory; this is a folder of bricks");
        const Bricks bricks = open_bricks_input(input_, app(), report);
        const Vec3 size = bricks.bounds.size();
        RasterizeOptions options = options_of_grids(report);
        options.voxel_size_world = !like_grids_.empty()    ? like_grids_.front().report().voxel_size_world
                                   : asked_.voxel_size > 0 ? asked_.voxel_size
                                                           : std::max({size.x, size.y, size.z}) / asked_.resolution;
        options.refine = refine_.options(0, report);
        options.on_limit = !interpolates(options.refine.scheme.kind);
        options.metadata.emplace_back("subvol_scheme", refine_.scheme);
        std::vector<StreamedField> fields;
        for (const auto& [name, source] : fields_wanted_) {
            if (name != source)
                throw Error(ErrorCode::InvalidInput, "of bricks, fields are written as they are", "--fields", source);
            fields.push_back(named_brick_field(bricks, name, true));
        }
        if (fields.empty()) fields.push_back(select_brick_field(bricks, common(), report));
        const BricksToVoxels what{bricks, fields, options, !refine_.levels.has_value()};
        if (!shares(share_)) {
            write_bricks_vdb(what, output_, report);
            return;
        }
        const std::vector<VdbGrid> all =
            of_all_shares(grids_of_bricks(what, output_.memory_bytes, share, report), share, report);
        if (all.empty()) return;
        if (!has_voxels(all)) throw no_voxels(input_, "try a smaller --voxel-size");
        write_reported(all, output_, report);
    }

    /// One slab of the voxels, as a file of its own.
    void run_share(const Share& share, Report& report) {
        refuse_options(app(), {"--velocity", "--error", "--memory", "--nano"},
                       ranks() != nullptr ? "does not work in several processes of MPI" : "does not work with --part");
        if (asked_.from == "points") throw Error(ErrorCode::InvalidInput, "is not done in shares", "--from points");
        const HexMesh mesh = load(input_, common(), report);
        const RasterizeOptions options = set_up(mesh, report);
        std::vector<VdbGrid> grids =
            report.timed("rasterize", [&] { return rasterize_share(mesh, names_of(mesh), options, share.part, share.of); });
        clamp_grids(mesh, grids);
        grids = of_all_shares(std::move(grids), share, report);
        if (grids.empty()) return;
        if (!has_voxels(grids)) throw no_voxels(input_, finer_voxels(mesh));
        note_overshoot(mesh, grids, report);
        write_reported(grids, output_, report);
    }

    /// The grids of all ranks at rank 0, to be written. With --part those of the share are written here. Nothing elsewhere.
    std::vector<VdbGrid> of_all_shares(std::vector<VdbGrid> own, const Share& share, Report& report) {
        for (VdbGrid& grid : own) store_in_half(grid, false);  // whoever has all voxels rounds them
        if (ranks() != nullptr) return gathered(std::move(own), report);
        const std::string note =
            text_of(make_note(app(), input_, share, {{"half", asked_.half}, {"compression", asked_.compression}}));
        for (VdbGrid& grid : own) set_text_of_grid(grid, kPartNote, note);
        report["part"] = share.name();
        write_share(own, output_, report);
        return {};
    }

    /// The grids of all ranks, joined, at rank 0; nothing elsewhere.
    std::vector<VdbGrid> gathered(std::vector<VdbGrid> own, Report& report) const {
        return report.timed("gather", [&] {
            std::string bytes = detail::bytes_of_grids(own);
            own.clear();
            std::vector<std::vector<VdbGrid>> of_ranks;
            for (std::string& one : ranks()->gather(std::move(bytes))) {
                of_ranks.push_back(detail::grids_from_bytes(one));
                one = {};
            }
            std::vector<VdbGrid> joined;
            for (std::size_t g = 0; !of_ranks.empty() && g < of_ranks.front().size(); ++g) {
                std::vector<VdbGrid> parts;
                for (std::vector<VdbGrid>& grids : of_ranks) parts.push_back(std::move(grids.at(g)));
                joined.push_back(join_grids(std::move(parts)));
                store_in_half(joined.back(), asked_.half);
            }
            return joined;
        });
    }

    struct GridErrorFigures {
        std::size_t grid;
        double max, rms;
    };

    /// Adds a grid of errors for each grid of a scalar field.
    std::vector<GridErrorFigures> add_errors(const HexMesh& mesh, const RasterizeOptions& options, std::vector<VdbGrid>& grids,
                                             Report& report) const {
        std::vector<GridErrorFigures> figures;
        const std::size_t count = grids.size();
        std::size_t outside = 0;
        for (std::size_t g = 0; g < count; ++g) {
            const Attribute* field = mesh.find_attribute(grids[g].report().name);
            if (field == nullptr || field->channels != 1) continue;
            GridError error = report.timed("error", [&] {
                return grid_error(grids[g], mesh, field->name,
                                  {.scheme = options.refine.scheme, .half = asked_.half, .progress = report.progress()});
            });
            figures.push_back({g, error.max, error.rms});
            outside = std::max(outside, error.outside);
            grids.push_back(std::move(error.grid));
        }
        if (outside > 0) {
            report.note(text(count_text(outside), " voxels' centres lie outside the limit, by less than the grid resolves"));
        }
        return figures;
    }

    void run_points(Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "needs a mesh; these are points", "--error");
        if (asked_.velocity) throw Error(ErrorCode::InvalidInput, "needs a sequence", "--velocity", "--frames A-B");
        asked_.from = "points";
        RasterizeOptions options = options_of_grids(report);
        options.voxel_size_world = asked_.voxel_size;
        options.resolution = asked_.resolution;
        options.level_set = asked_.level_set();
        refuse_options(app(), {"--remap", "--clamp", "--up", "--scale"}, "needs a mesh; these are points");
        std::vector<std::string> names;
        for (const GridField& field : fields_wanted_) {
            if (field.name != field.source) {
                throw Error(ErrorCode::InvalidInput, "needs a mesh; points have channels",
                            "--fields " + field.name + "=" + field.source, "--fields with names of channels");
            }
            names.push_back(field.name);
        }
        const std::vector<VdbGrid> grids = grids_of_points(input_, names, common(), app(), options, report);
        if (!has_voxels(grids)) {
            throw no_voxels(input_, text("try --voxel-size below ", grids.front().report().voxel_size_world));
        }
        write_reported(grids, output_, report);
    }

    void run_frames(const Share& share, Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--error");
        check_frame_names();
        const FrameRange range = parse_frames(asked_.frames);
        if (asked_.to.empty()) check_frames(input_, range);
        MeshFrames frames(input_, asked_.to.empty() ? std::nullopt : std::optional(asked_.to), range,
                          [&](const std::string& name) { return load(name, common(), report); });
        write_frames(share, range, frames, {}, report);
    }

    void run_steps(const Share& share, Report& report) {
        if (asked_.error) throw Error(ErrorCode::InvalidInput, "works with one step only", "--error", "--step N");
        if (!asked_.frames.empty() || !asked_.to.empty()) {
            throw Error(ErrorCode::InvalidInput, "a series has steps", asked_.frames.empty() ? "--to" : "--frames",
                        "--step A-B");
        }
        if (app().count("--fps") > 0) {
            throw Error(ErrorCode::InvalidInput, "the velocity of steps follows from their times", "--fps");
        }
        check_numbered(output_.path);
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        MeshFrames frames(range, series.times, [&](int step) { return load(input_, of_step(common(), step), report); });
        const FrameRange own = frames_of(share, range);
        report["times"] = std::vector(series.times.begin() + own.first, series.times.begin() + own.last + 1);
        write_frames(share, range, frames, series.times, report);
    }

    /// The first frame determines the voxel size and the level of all frames. times: of the steps of a series; else empty
    void write_frames(const Share& share, const FrameRange& all, MeshFrames& frames, const std::vector<double>& times,
                      Report& report) {
        if (output_.memory_bytes > 0)
            throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--memory");
        const FrameRange range = frames_of(share, all);
        if (share_.given()) report["part"] = share.name();
        const HexMesh first = frames.mesh(all.first);
        RasterizeOptions options = set_up(first, report);
        const auto metadata = options.metadata;
        std::optional<RefinementTables> tables;
        const int levels = options.limit ? finest_level(limit_) : options.refine.levels;
        if (!refine_.crease_angle_deg &&
            std::ldexp(static_cast<double>(first.cells.size()), 3 * levels) <= kMostCellsOfTables) {
            tables = report.timed("tables", [&] { return rasterization_tables(first, options); });
        }
        std::size_t active_voxels = 0;
        report["frames"] = Json::array();
        for (int frame = range.first; frame <= range.last; ++frame) {
            report.begin_part(text("frame ", frame - range.first + 1, " of ", range.count()),
                              static_cast<std::size_t>(frame - range.first), static_cast<std::size_t>(range.count()));
            HexMesh mesh = frames.mesh(frame);
            const bool same = same_cells(first, mesh);
            options.tables = tables && same ? &*tables : nullptr;
            if (!times.empty()) {
                const auto step = static_cast<std::size_t>(frame);
                options.metadata = metadata;
                options.metadata.emplace_back("subvol_step", std::to_string(frame));
                options.metadata.emplace_back("subvol_time", detail::number_text(times[step], 12));
                const std::size_t other = step == 0 ? 1 : step - 1;
                if (asked_.velocity) asked_.frames_per_second = 1 / std::abs(times[step] - times.at(other));
            }
            if (asked_.velocity) add_velocity(frames.velocity(frame), mesh, times.empty() ? asked_.frames_per_second : 1);
            LimitCells of_frame;  // with tables the first limit serves all meshes with the same cells
            if (options.limit && !options.tables && (asked_.velocity || frame > all.first)) {
                of_frame = find_limit(mesh, options.refine, options.voxel_size_world, report);
                options.limit = &of_frame;
            } else if (options.limit) {
                options.limit = &limit_;
            }
            VdbOutput output = output_;
            output.path = with_number(output_.path, frame);
            std::vector<VdbGrid> grids = grids_of(mesh, options, report);
            if (asked_.velocity) spread_velocity(frame, grids, report);
            report["voxel_size"] = grids.front().report().voxel_size_world;
            report["active_voxels"] = active_voxels += grids.front().report().active_voxels;
            if (!has_voxels(grids)) {
                report.warn(text("frame ", frame, ": no voxel centre lies inside: ", finer_voxels(mesh)));
            }
            write_frame(frame, grids, output, report);
        }
        if (ranks() != nullptr) gather_list(*ranks(), report, "frames");
        report["input"] = input_;
        report["output"] = output_.path;
    }

    void check_frame_names() const {
        if (asked_.frames.empty()) throw Error(ErrorCode::InvalidInput, "is needed for a sequence", "--frames", "1-10");
        if (!has_number(output_.path)) {
            throw Error(ErrorCode::InvalidInput, "has no # for the number of the frame", output_.path, "out_####.vdb");
        }
        if (asked_.to.empty() != has_number(input_)) {
            throw Error(ErrorCode::InvalidInput,
                        asked_.to.empty() ? "has no # for the number of the frame" : "has a # for a number, but --to is given",
                        input_, "in_####.vtu, or one mesh and --to another");
        }
    }

    static void add_velocity(Attribute velocity, HexMesh& mesh, double factor) {
        if (mesh.find_attribute(velocity.name)) {
            throw Error(ErrorCode::InvalidInput, "the mesh has a field of this name", kVelocity, "--fields without it");
        }
        for (double& v : velocity.values) v *= factor;
        mesh.attributes.push_back(std::move(velocity));
    }

    /// Extends the velocities beyond the volume, to where it is at other times while a shutter is open.
    void spread_velocity(int frame, std::vector<VdbGrid>& grids, Report& report) const {
        const auto velocity = std::ranges::find(grids, kVelocity, [](const VdbGrid& grid) { return grid.report().name; });
        if (velocity == grids.end() || velocity->report().kind != "vector" || velocity->report().max == 0) return;
        const GridReport& about = velocity->report();
        const double way_voxels = kShutter_frames * about.max / asked_.frames_per_second / about.voxel_size_world;
        if (way_voxels > kMostVelocityLayers) {
            report.warn(text("frame ", frame, ": in half a frame something moves by ", way_voxels,
                             " voxels; the velocities reach ", kMostVelocityLayers,
                             " voxels beyond the volume, and blur is cut off there"));
        }
        const int layers = static_cast<int>(std::min(std::ceil(way_voxels) + 1, double(kMostVelocityLayers)));
        report.timed("spread", [&] { *velocity = spread_vectors(*velocity, layers); });
    }

    /// The options for a mesh, which depend on its box and its fields.
    [[nodiscard]] RasterizeOptions set_up(const HexMesh& mesh, Report& report) {
        const double voxel_size = like_grids_.empty() ? voxel_size_world(mesh) : like_grids_.front().report().voxel_size_world;
        RefineOptions refinement = refine_.options(0, report);
        int levels = refinement.levels;
        if (refine_.levels) {
            report["levels"] = refinement.levels;
            report["cells"] = mesh.cells.size() << (3 * refinement.levels);
        } else {
            limit_ = find_limit(mesh, refinement, voxel_size, report);
            levels = finest_level(limit_);
        }
        RasterizeOptions options = options_of_grids(report);
        options.voxel_size_world = voxel_size;
        options.refine = refinement;
        options.on_limit = !interpolates(refinement.scheme.kind);
        options.limit = refine_.levels ? nullptr : &limit_;
        options.level_set = asked_.level_set();
        if (options.level_set && mesh.find_attribute(options.level_set->name)) {
            throw Error(ErrorCode::InvalidInput, "the mesh has a field of this name", options.level_set->name,
                        "--sdf with another name");
        }
        options.metadata.emplace_back("subvol_scheme", tets_.asked() ? tets_.name() : refine_.scheme);
        options.metadata.emplace_back("subvol_level", std::to_string(levels));
        return options;
    }

    /// The options that do not depend on the mesh.
    [[nodiscard]] RasterizeOptions options_of_grids(Report& report) const {
        return {.like = like_grids_.empty() ? nullptr : &like_grids_.front(),
                .half = asked_.half,
                .cell_numbers = asked_.cell_numbers,
                .mask = asked_.mask,
                .coverage = asked_.coverage,
                .metadata = {{"subvol_input", input_}, {"subvol_from", asked_.from}, {"subvol_version", SUBVOL_VERSION}},
                .progress = report.progress()};
    }

    [[nodiscard]] std::vector<VdbGrid> grids_of(const HexMesh& mesh, const RasterizeOptions& options, Report& report) const {
        std::vector<VdbGrid> grids = asked_.from == "points"
                                         ? kernel_sums(mesh, options, asked_.per_edge, report)
                                         : report.timed("rasterize", [&] { return rasterize(mesh, names_of(mesh), options); });
        clamp_grids(mesh, grids);
        return grids;
    }

    /// Keeps the grids of fields within what --clamp and --remap say.
    void clamp_grids(const HexMesh& mesh, std::vector<VdbGrid>& grids) const {
        for (VdbGrid& grid : grids) {
            const Attribute* field = mesh.find_attribute(grid.report().name);
            if (field == nullptr || field->name == kVelocity) continue;
            if (asked_.clamp) clamp_voxels(grid, range_of(*field));
            for (const Remap& remap : parsed_remaps_) {
                if (remap.grid.empty() ? field == &mesh.attributes.front() : remap.grid == field->name)
                    clamp_voxels(grid, {{std::min(remap.to_low, remap.to_high)}, {std::max(remap.to_low, remap.to_high)}});
            }
        }
    }

    void note_overshoot(const HexMesh& mesh, const std::vector<VdbGrid>& grids, Report& report) const {
        for (const VdbGrid& grid : grids) {
            const Attribute* field = mesh.find_attribute(grid.report().name);
            if (field == nullptr || field->channels != 1 || asked_.clamp) continue;
            const bool mapped = std::ranges::any_of(parsed_remaps_, [&](const Remap& remap) {
                return remap.grid.empty() ? field == &mesh.attributes.front() : remap.grid == field->name;
            });
            if (mapped) continue;
            const FieldRange range = range_of(*field);
            note_beyond(field->name, {range.min[0], range.max[0]}, {grid.report().min, grid.report().max}, report);
        }
    }

    void refuse_with_memory() const {
        if (asked_.from == "points") throw Error(ErrorCode::InvalidInput, "works with a mesh only", "--memory");
        if (output_.nano) throw Error(ErrorCode::InvalidInput, "works with one file only, not with parts", "--nano");
    }

    [[nodiscard]] HexMesh with_written_fields(HexMesh mesh, Report& report) const {
        if (fields_wanted_.empty()) return with_selected_field(std::move(mesh), common(), report);
        std::vector<Attribute> chosen;
        for (const auto& [name, source] : fields_wanted_) {
            if (name != source) {
                chosen.push_back(field_of(mesh, name, source));
                continue;
            }
            if (const Attribute* vector = mesh.find_attribute(name); vector && vector->channels == 3) {
                chosen.push_back(*vector);
                continue;
            }
            SelectedField selected = select_field(mesh, name);
            report.warn(selected.warning);
            chosen.push_back(std::move(selected.scalar));
        }
        mesh.attributes = std::move(chosen);
        return mesh;
    }

    [[nodiscard]] double voxel_size_world(const HexMesh& mesh) const {
        if (asked_.voxel_size > 0) return asked_.voxel_size;
        if (asked_.budget_bytes > 0) {
            double channels = asked_.cell_numbers ? 1 : 0;
            for (const Attribute& attribute : mesh.attributes) channels += attribute.channels;
            return std::cbrt(std::abs(measure_cells(mesh).volume) * kBytesOfChannel * channels /
                             static_cast<double>(asked_.budget_bytes));
        }
        const Vec3 size = bounds(mesh).size();
        return std::max({size.x, size.y, size.z}) / asked_.resolution;
    }

    /// The report's "levels" is the finest level, its "cells" the number of curved pieces, 27 vertices each.
    [[nodiscard]] static LimitCells find_limit(const HexMesh& mesh, const RefineOptions& refinement, double voxel_size,
                                               Report& report) {
        LimitCells limit = report.timed("limit level", [&] { return limit_for_voxels(mesh, refinement, voxel_size); });
        const int levels = finest_level(limit);
        report["levels"] = levels;
        report["cells"] = limit.piece_count;
        report["limit_deviation"] = {{"voxels", limit.position_world / voxel_size}, {"of_range", limit.value_of_range}};
        if (!limit.converged) {
            report.warn(text("level ", levels, " was the finest within limits; the last step still moved points by ",
                             limit.position_world / voxel_size, " voxels and values by ", limit.value_of_range,
                             " of their range"));
        }
        return limit;
    }

    std::string input_;
    VdbArguments asked_;
    VdbOutput output_;
    std::vector<VdbGrid> like_grids_;
    std::vector<GridField> fields_wanted_;
    std::vector<Remap> parsed_remaps_;
    LimitCells limit_;
    RefineArguments refine_;
    ShareArgument share_;
    TetRefinement tets_;
};

}  // namespace

std::unique_ptr<Verb> make_vdb_verb(CLI::App& program) {
    return std::make_unique<VdbVerb>(program);
}

}  // namespace subvol::cli
