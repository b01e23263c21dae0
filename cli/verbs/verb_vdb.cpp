// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "choices.h"
#include "grid_fields.h"
#include "input.h"
#include "mesh_frames.h"
#include "outputs.h"
#include "points_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/field_expression.h"
#include "subvol/field_range.h"
#include "subvol/grid_error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_report.h"
#include "subvol/nanovdb.h"
#include "subvol/rasterize.h"
#include "subvol/spread_vectors.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/version.h"
#include "text.h"
#include "vdb_output.h"
#include "verb.h"
#include "voxels_of_points.h"

namespace subvol::cli {
namespace {

constexpr double kBytesOfChannel = 5.5;     // a voxel's float in leaves that are not all full, with their masks
constexpr double kMostCellsOfTables = 8e6;  // refined cells, about 200 bytes each
constexpr const char* kDefaultLevelSet = "sdf";
constexpr const char* kVelocity = "vel";
// Velocities are written beyond the volume as far as it moves in this time: renderers open the shutter for a frame at most,
// usually centred on the frame's time.
constexpr double kShutter_frames = 0.5;
// In voxels. With more, the grid of a volume 200 voxels wide would have more voxels outside the volume than inside.
constexpr int kMostVelocityLayers = 64;

VdbCompression compression_named(const std::string& name) {
    return name == "zip" ? VdbCompression::Zip : name == "none" ? VdbCompression::None : VdbCompression::Blosc;
}

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
               "  subvol vdb model:pawn -o pawn.vdb --resolution 1600 --memory 2G") {
        app().add_option("FILE", input_, text(input_help(), "; or points (.ply, .vtp, .vdb)"))->required();
        app().add_option("-o,--output", output_.path, "the file to write (.vdb)")->type_name("FILE")->required();
        add_size_options();
        refine_.add_to(app(), "rasterize the refined mesh of this level; omitted: the limit");
        add_grid_options();
        add_file_options();
        add_frame_options();
        set_essentials({"--output", "--resolution", "--voxel-size", "--fields", "--levels", "--sdf", "--half", "--frames",
                        "--to", "--velocity", "--memory", "--nano"});
        group("Voxels", {"--voxel-size", "--resolution", "--like", "--budget"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle", "--from", "--per-edge"});
        group("Grids", {"--fields", "--cell-ids", "--mask", "--coverage", "--error", "--sdf", "--half-width", "--half"});
        group("Files", {"--compression", "--memory", "--nano"});
        group("Sequences", {"--frames", "--to", "--velocity", "--fps"});
    }

    int run(Report& report) override {
        check_choice("--from", from_, {"mesh", "points"});
        check_choice("--up", up_, {"z", "y"});
        fields_wanted_ = parse_grid_fields(fields_);
        for (const std::string& remap : remaps_) parsed_remaps_.push_back(parse_remap(remap));
        if (output_.nano && !has_nanovdb()) {
            throw Error(ErrorCode::MissingCapability, "this build has no NanoVDB", "--nano",
                        "configure again where libnanovdb-dev is installed");
        }
        output_.compression = compression_named(compression_);
        report.if_long("a lower --resolution, or --levels 1");
        check_output(output_.path, {".vdb"});
        if (!like_.empty()) like_grids_ = read_vdb(like_);
        if (asks_for_steps(common())) {
            run_steps(report);
        } else if (!frames_.empty() || !to_.empty() || has_number(input_)) {
            run_frames(report);
        } else if (holds_points(input_)) {
            run_points(report);
        } else {
            run_one(report);
        }
        return 0;
    }

private:
    void add_size_options() {
        auto* size = app().add_option("--voxel-size", voxel_size_, "edge of a voxel in world units");
        size->type_name("H")->check(CLI::PositiveNumber);
        auto* resolution =
            app().add_option("--resolution", resolution_, "voxels along the longest side of the bounding box (default 200)");
        resolution->type_name("N")->check(CLI::Range(1, 1 << 20))->excludes(size);
        auto* like = app().add_option("--like", like_, "use the transform of the first grid in this .vdb file");
        like->type_name("FILE")->excludes(size)->excludes(resolution);
        app()
            .add_option("--budget", budget_bytes_, "choose voxels so that the grids take about this much memory, e.g. 500M")
            ->type_name("BYTES")
            ->transform(CLI::AsSizeValue(false))
            ->excludes(size)
            ->excludes(resolution)
            ->excludes(like);
    }

    void add_grid_options() {
        app()
            .add_option(
                "--fields", fields_,
                "fields to write, the first as fog volume; a field with three components becomes a grid of vectors, "
                "NAME.k is its component k. GRID=FIELD names the grid; GRID=EXPRESSION computes it from x, y, z and the "
                "fields, e.g. \"heat=(Temp-293)/620,speed=length(V)\"")
            ->type_name("A,B=C");
        app()
            .add_option(
                "--remap", remaps_,
                "values from LO to HI become 0 to 1, or A to B, what is beyond becomes the nearer of these; of the first "
                "field or of GRID (repeatable)")
            ->type_name("[GRID=]LO,HI[:A,B]")
            ->allow_extra_args(false);
        app().add_flag("--clamp", clamp_, "keep values within the range of the field: interpolating schemes overshoot");
        app()
            .add_option("--up", up_, "the axis that is up: z, or y as in most programs for pictures (default z)")
            ->type_name("AXIS");
        app().add_option("--scale", scale_, "multiply all coordinates by this")->type_name("S")->check(CLI::PositiveNumber);
        app().add_flag("--cell-ids", cell_numbers_, "also write a grid: the number of the control cell");
        app().add_flag("--mask", mask_, "also write a grid: a mask of the volume");
        app().add_flag("--error", error_,
                       "also write for each field a grid NAME_error: an upper bound of |value - limit| at each voxel");
        app().add_flag("--coverage", coverage_, "also write a grid: the part of each voxel that the volume fills");
        level_set_option_ =
            app().add_option("--sdf", level_set_.name,
                             "also write a level set, named NAME or sdf: the distance to the boundary, negative "
                             "inside, in a narrow band");
        level_set_option_->type_name("[NAME]")->expected(0, 1);
        app()
            .add_option("--half-width", level_set_.half_width_voxels, "the band's reach to either side, in voxels (default 3)")
            ->type_name("N")
            ->check(CLI::Range(1.0, 1000.0))
            ->needs(level_set_option_);
        app().add_flag("--half", half_, "store floats in 16 bits");
        app()
            .add_option(
                "--from", from_,
                "what is rasterized: mesh, or points: kernels sampled from it, summed at the voxels of the mesh; not needed "
                "for a FILE of points (.ply, .vtp, .vdb)")
            ->type_name("WHAT")
            ->check(offered({"mesh", "points"}));
        app()
            .add_option("--per-edge", per_edge_, "with --from points: sample intervals per edge")
            ->type_name("N")
            ->check(CLI::Range(1, 64));
    }

    void add_file_options() {
        app()
            .add_option("--compression", compression_, "blosc (the default), zip, none")
            ->type_name("NAME")
            ->check(one_of({"blosc", "zip", "none"}));
        app()
            .add_option("--memory", output_.memory_bytes,
                        "write parts whose grids take no more than this, e.g. 2G: NAME_0000.vdb and so on, and NAME.json, "
                        "which lists them")
            ->type_name("BYTES")
            ->transform(CLI::AsSizeValue(false));
        app().add_flag("--nano", output_.nano, "also write a NanoVDB file, NAME.nvdb; needs a build with NanoVDB");
    }

    void add_frame_options() {
        app()
            .add_option(
                "--frames", frames_,
                "a sequence: A-B, or N for 1-N. In FILE and --output a row of # is replaced by the number of the frame, "
                "padded with zeros to that many digits")
            ->type_name("A-B");
        app()
            .add_option("--to", to_,
                        "a sequence from FILE to this mesh of the same cells: points and values are interpolated linearly")
            ->type_name("FILE");
        auto* velocity =
            app().add_flag("--velocity", velocity_,
                           "also write a grid of vectors, named vel: the velocity of the volume, in world units per frame; of "
                           "steps per unit of their time");
        app()
            .add_option("--fps", frames_per_second_,
                        "with --velocity: in world units per second, at this many frames per second")
            ->type_name("F")
            ->check(CLI::PositiveNumber)
            ->needs(velocity);
    }

    [[nodiscard]] HexMesh load(const std::string& input, Report& report) const {
        HexMesh mesh = with_written_fields(load_mesh(input, common(), report), report);
        for (const Remap& remap : parsed_remaps_) apply(remap, mesh);
        if (up_ == "y") turn_y_up(mesh);
        if (scale_ != 1) scale_points(mesh, scale_);
        return mesh;
    }

    void run_one(Report& report) {
        if (velocity_) throw Error(ErrorCode::InvalidInput, "needs a sequence", "--velocity", "--frames A-B");
        const HexMesh mesh = load(input_, report);
        const RasterizeOptions options = set_up(mesh, report);
        if (output_.memory_bytes > 0) {
            if (error_) throw Error(ErrorCode::InvalidInput, "works with one file only, not with parts", "--error");
            refuse_with_memory();
            write_parts(input_, mesh, names_of(mesh), options, output_, report,
                        [&](std::vector<VdbGrid>& grids) { clamp_grids(mesh, grids); });
            return;
        }
        std::vector<VdbGrid> grids = grids_of(mesh, options, report);
        if (!has_voxels(grids)) throw no_voxels(input_, finer_voxels(mesh));
        note_overshoot(mesh, grids, report);
        const auto errors = error_ ? add_errors(mesh, options, grids, report) : std::vector<GridErrorFigures>();
        write_reported(grids, output_, report);
        for (const auto& [grid, max, rms] : errors) {
            report["grids"][grid]["error_max"] = max;
            report["grids"][grid]["error_rms"] = rms;
        }
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
                                  {.scheme = options.refine.scheme, .half = half_, .progress = report.progress()});
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
        if (error_) throw Error(ErrorCode::InvalidInput, "needs a mesh; these are points", "--error");
        if (velocity_) throw Error(ErrorCode::InvalidInput, "needs a sequence", "--velocity", "--frames A-B");
        from_ = "points";
        RasterizeOptions options = options_of_grids(report);
        options.voxel_size_world = voxel_size_;
        options.resolution = resolution_;
        options.level_set = level_set();
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

    void run_frames(Report& report) {
        if (error_) throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--error");
        check_frame_names();
        const FrameRange range = parse_frames(frames_);
        if (to_.empty()) check_frames(input_, range);
        MeshFrames frames(input_, to_.empty() ? std::nullopt : std::optional(to_), range,
                          [&](const std::string& name) { return load(name, report); });
        write_frames(range, frames, {}, report);
    }

    void run_steps(Report& report) {
        if (error_) throw Error(ErrorCode::InvalidInput, "works with one step only", "--error", "--step N");
        if (!frames_.empty() || !to_.empty()) {
            throw Error(ErrorCode::InvalidInput, "a series has steps", frames_.empty() ? "--to" : "--frames", "--step A-B");
        }
        if (app().count("--fps") > 0) {
            throw Error(ErrorCode::InvalidInput, "the velocity of steps follows from their times", "--fps");
        }
        check_numbered(output_.path);
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        MeshFrames frames(range, series.times, [&](int step) {
            return with_written_fields(load_mesh(input_, of_step(common(), step), report), report);
        });
        report["times"] = std::vector(series.times.begin() + range.first, series.times.begin() + range.last + 1);
        write_frames(range, frames, series.times, report);
    }

    /// The first frame determines the voxel size and the level of all frames. times: of the steps of a series; else empty
    void write_frames(const FrameRange& range, MeshFrames& frames, const std::vector<double>& times, Report& report) {
        if (output_.memory_bytes > 0)
            throw Error(ErrorCode::InvalidInput, "works with one mesh only, not with frames", "--memory");
        const HexMesh first = frames.mesh(range.first);
        RasterizeOptions options = set_up(first, report);
        const auto metadata = options.metadata;
        std::optional<RefinementTables> tables;
        const int levels = options.limit ? finest_level(limit_) : options.refine.levels;
        if (!refine_.crease_angle_deg &&
            std::ldexp(static_cast<double>(first.cells.size()), 3 * levels) <= kMostCellsOfTables) {
            tables = report.timed("tables", [&] { return rasterization_tables(first, options); });
        }
        std::size_t active_voxels = 0;
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
                if (velocity_) frames_per_second_ = 1 / std::abs(times[step] - times.at(other));
            }
            if (velocity_) add_velocity(frames.velocity(frame), mesh, times.empty() ? frames_per_second_ : 1);
            LimitCells of_frame;  // with tables the first limit serves all meshes with the same cells
            if (options.limit && !options.tables && (velocity_ || frame > range.first)) {
                of_frame = find_limit(mesh, options.refine, options.voxel_size_world, report);
                options.limit = &of_frame;
            } else if (options.limit) {
                options.limit = &limit_;
            }
            VdbOutput output = output_;
            output.path = with_number(output_.path, frame);
            std::vector<VdbGrid> grids = grids_of(mesh, options, report);
            if (velocity_) spread_velocity(frame, grids, report);
            report["voxel_size"] = grids.front().report().voxel_size_world;
            report["active_voxels"] = active_voxels += grids.front().report().active_voxels;
            if (!has_voxels(grids)) {
                report.warn(text("frame ", frame, ": no voxel centre lies inside: ", finer_voxels(mesh)));
            }
            write_frame(frame, grids, output, report);
        }
        report["input"] = input_;
        report["output"] = output_.path;
    }

    void check_frame_names() const {
        if (frames_.empty()) throw Error(ErrorCode::InvalidInput, "is needed for a sequence", "--frames", "1-10");
        if (!has_number(output_.path)) {
            throw Error(ErrorCode::InvalidInput, "has no # for the number of the frame", output_.path, "out_####.vdb");
        }
        if (to_.empty() != has_number(input_)) {
            throw Error(ErrorCode::InvalidInput,
                        to_.empty() ? "has no # for the number of the frame" : "has a # for a number, but --to is given",
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
        const double way_voxels = kShutter_frames * about.max / frames_per_second_ / about.voxel_size_world;
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
        options.level_set = level_set();
        if (options.level_set && mesh.find_attribute(options.level_set->name)) {
            throw Error(ErrorCode::InvalidInput, "the mesh has a field of this name", options.level_set->name,
                        "--sdf with another name");
        }
        options.metadata.emplace_back("subvol_scheme", refine_.scheme);
        options.metadata.emplace_back("subvol_level", std::to_string(levels));
        return options;
    }

    /// The options that do not depend on the mesh.
    [[nodiscard]] RasterizeOptions options_of_grids(Report& report) const {
        return {.like = like_grids_.empty() ? nullptr : &like_grids_.front(),
                .half = half_,
                .cell_numbers = cell_numbers_,
                .mask = mask_,
                .coverage = coverage_,
                .metadata = {{"subvol_input", input_}, {"subvol_from", from_}, {"subvol_version", SUBVOL_VERSION}},
                .progress = report.progress()};
    }

    [[nodiscard]] std::optional<LevelSetOptions> level_set() const {
        if (level_set_option_->count() == 0) return std::nullopt;
        LevelSetOptions options = level_set_;
        if (options.name.empty()) options.name = kDefaultLevelSet;
        return options;
    }

    [[nodiscard]] std::vector<VdbGrid> grids_of(const HexMesh& mesh, const RasterizeOptions& options, Report& report) const {
        std::vector<VdbGrid> grids = from_ == "points"
                                         ? kernel_sums(mesh, options, per_edge_, report)
                                         : report.timed("rasterize", [&] { return rasterize(mesh, names_of(mesh), options); });
        clamp_grids(mesh, grids);
        return grids;
    }

    /// Keeps the grids of fields within what --clamp and --remap say.
    void clamp_grids(const HexMesh& mesh, std::vector<VdbGrid>& grids) const {
        for (VdbGrid& grid : grids) {
            const Attribute* field = mesh.find_attribute(grid.report().name);
            if (field == nullptr || field->name == kVelocity) continue;
            if (clamp_) clamp_voxels(grid, range_of(*field));
            for (const Remap& remap : parsed_remaps_) {
                if (remap.grid.empty() ? field == &mesh.attributes.front() : remap.grid == field->name)
                    clamp_voxels(grid, {{std::min(remap.to_low, remap.to_high)}, {std::max(remap.to_low, remap.to_high)}});
            }
        }
    }

    void note_overshoot(const HexMesh& mesh, const std::vector<VdbGrid>& grids, Report& report) const {
        for (const VdbGrid& grid : grids) {
            const Attribute* field = mesh.find_attribute(grid.report().name);
            if (field == nullptr || field->channels != 1 || clamp_) continue;
            const bool mapped = std::ranges::any_of(parsed_remaps_, [&](const Remap& remap) {
                return remap.grid.empty() ? field == &mesh.attributes.front() : remap.grid == field->name;
            });
            if (mapped) continue;
            const FieldRange range = range_of(*field);
            note_beyond(field->name, {range.min[0], range.max[0]}, {grid.report().min, grid.report().max}, report);
        }
    }

    void refuse_with_memory() const {
        if (from_ == "points") throw Error(ErrorCode::InvalidInput, "works with a mesh only", "--memory");
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
        if (voxel_size_ > 0) return voxel_size_;
        if (budget_bytes_ > 0) {
            double channels = cell_numbers_ ? 1 : 0;
            for (const Attribute& attribute : mesh.attributes) channels += attribute.channels;
            return std::cbrt(std::abs(measure_cells(mesh).volume) * kBytesOfChannel * channels /
                             static_cast<double>(budget_bytes_));
        }
        const Vec3 size = bounds(mesh).size();
        return std::max({size.x, size.y, size.z}) / resolution_;
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
    VdbOutput output_;
    double voxel_size_ = 0;
    int resolution_ = 200;
    std::uint64_t budget_bytes_ = 0;
    std::string like_;
    std::vector<VdbGrid> like_grids_;
    std::vector<std::string> fields_, remaps_;
    std::vector<GridField> fields_wanted_;
    std::vector<Remap> parsed_remaps_;
    bool clamp_ = false;
    std::string up_ = "z";
    double scale_ = 1;
    bool half_ = false, cell_numbers_ = false, mask_ = false, coverage_ = false, error_ = false;
    LevelSetOptions level_set_{.name = {}};
    CLI::Option* level_set_option_ = nullptr;
    std::string from_ = "mesh", compression_ = "blosc";
    int per_edge_ = 1;
    std::string frames_, to_;
    bool velocity_ = false;
    double frames_per_second_ = 1;
    LimitCells limit_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_vdb_verb(CLI::App& program) {
    return std::make_unique<VdbVerb>(program);
}

}  // namespace subvol::cli
