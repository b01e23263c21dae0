// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "choices.h"
#include "grid_fields.h"
#include "grid_input.h"
#include "input.h"
#include "outputs.h"
#include "picture_arguments.h"
#include "points_input.h"
#include "quantities.h"
#include "sampled_points.h"
#include "steps.h"
#include "subvol/clamp_channel.h"
#include "subvol/detail/surface_io.h"
#include "subvol/error.h"
#include "subvol/points_error.h"
#include "subvol/points_io.h"
#include "subvol/vdb_points.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class PointsVerb : public Verb {
public:
    explicit PointsVerb(CLI::App& program)
        : Verb(program, "points", "Turn a mesh or a .vdb grid into radial basis functions.",
               "  subvol points model:ball -o ball.ply\n"
               "  subvol points model:ball -o ball.vtp                 for ParaView\n"
               "  subvol points model:ball -o ball.vdb                 for Houdini\n"
               "  subvol points model:ball -o dense.ply --per-edge 2 --splats\n"
               "  subvol points run.exo -o 'run_####.ply' --step all\n"
               "  subvol points smoke.vdb -o smoke.ply --threshold 0   one kernel per voxel\n"
               "\n"
               "The boundary of NAME.vtp, of NAME.vdb and of a .ply with --splats is in NAME.boundary.vtp.") {
        app().add_option("FILE", input_, text(input_help(), "; or a .vdb grid of floats"))->required();
        app().add_option("-o,--output", output_, "the points to write (.ply, .vtp, .vdb)")->type_name("FILE")->required();
        app().add_flag("--ascii", ascii_, ".ply: write text instead of binary numbers");
        app().add_flag("--splats", splats_,
                       ".ply: also for viewers of Gaussian splats; the boundary is then in a file beside it");
        app()
            .add_option("--up", up_, "with --splats: the axis that these viewers show at the top: x, y or z (default z)")
            ->type_name("AXIS")
            ->check(offered({"x", "y", "z"}));
        sample_.add_to(app());
        app().add_option("--tf", transfer_function_, "the colour map for --threshold, as for `render`")->type_name("FILE|NAME");
        app().add_flag("--clamp", clamp_, "keep the kernels' values within the field's range: interpolating schemes overshoot");
        app().add_flag("--error", error_,
                       "also write a channel NAME_error: about how far the sum of kernels is from the limit near each");
        refine_.add_to(app(), "sample the refined mesh of this level instead of the limit");
        set_essentials({"--output", "--field", "--per-edge", "--spacing", "--tolerance", "--footprint", "--threshold",
                        "--reduce", "--levels", "--scheme"});
        group("Where kernels are", {"--per-edge", "--spacing", "--spacing-voxels", "--tolerance", "--footprint",
                                    "--footprint-size", "--threshold", "--tf", "--reduce", "--refine"});
        group("What kernels are", {"--values", "--kernel", "--value-kernel", "--correction", "--error"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
    }

    int run(Report& report) override {
        check_output(output_, {".ply", ".vtp", ".vdb"});
        const std::string extension = std::filesystem::path(output_).extension().string();
        if (extension != ".ply" && (ascii_ || splats_)) {
            throw Error(ErrorCode::InvalidInput, "only .ply files have it", ascii_ ? "--ascii" : "--splats");
        }
        check_choice("--up", up_, {"x", "y", "z"});
        if (app().count("--up") > 0 && !splats_) {
            throw Error(ErrorCode::InvalidInput, "turns what viewers of splats read; all else keeps its place", "--up",
                        "--splats");
        }
        report.if_long(sample_.reduce_rmse ? "a larger --reduce, and no --refine" : "a larger --spacing or --tolerance");
        if (asks_for_steps(common())) {
            write_steps(report);
            return 0;
        }
        const RbfVolume volume = is_vdb_file(input_) ? points_of_grid(report) : points_of_mesh(common(), report);
        write(output_, volume, report);
        report["output"] = output_;
        const bool inside = extension == ".ply" && !splats_;
        if (!inside && !volume.boundary.triangles.empty()) report["boundary"] = detail::boundary_path(output_).string();
        return 0;
    }

private:
    void write(const std::string& path, const RbfVolume& volume, Report& report) const {
        report.timed("write", [&] {
            if (path.ends_with(".vdb")) {
                write_vdb_points(path, volume);
            } else {
                write_points(path, volume, {.ascii = ascii_, .splats = splats_, .up = up_axis()});
            }
        });
    }

    void write_steps(Report& report) {
        check_numbered(output_);
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, common());
        for (int step = range.first; step <= range.last; ++step) {
            const std::string path = with_number(output_, step);
            write(path, points_of_mesh(of_step(common(), step), report), report);
            report["frames"].push_back({{"frame", step},
                                        {"time", series.times[static_cast<std::size_t>(step)]},
                                        {"points", report["points"]},
                                        {"output", path}});
        }
        report["input"] = input_;
        report["output"] = output_;
    }

    [[nodiscard]] RbfVolume points_of_mesh(const CommonOptions& options, Report& report) {
        HexMesh mesh = with_selected_field(load_mesh(input_, options, report), options, report);
        const HexMesh compared = error_ ? mesh : HexMesh{};
        const Range given = field_range(mesh);
        RbfVolume volume = sample_reported(std::move(mesh), sample_, refine_, seen(given), report);
        if (clamp_) {
            report["clamped"] = clamp_channel(volume.channels.front(), given.min, given.max);
        } else {
            note_beyond(volume.channels.front().name, given, channel_range(volume, 0), report);
        }
        if (error_) add_error(compared, volume, report);
        return volume;
    }

    void add_error(const HexMesh& mesh, RbfVolume& volume, Report& report) const {
        const std::string name = volume.channels.front().name;
        const SchemeOptions scheme = refine_.options(0, report).scheme;
        const PointsError error = report.timed(
            "error", [&] { return points_error(volume, mesh, name, {.scheme = scheme, .progress = report.progress()}); });
        volume.channels.push_back(error_channel(error, name));
        report["error_max"] = error.max;
        report["error_rms"] = error.rms;
        if (error.gaps > 0) {
            report.warn(
                text(count_text(error.gaps), " of ", count_text(error.places), " places inside have no kernel near them"));
        }
    }

    [[nodiscard]] RbfVolume points_of_grid(Report& report) {
        refuse_options(app(), {"--clamp"}, "needs a mesh: the values of voxels are within their range");
        refuse_options(app(), {"--error"}, "needs a mesh; this is a grid of voxels");
        const VdbGrid grid = load_grid(input_, common(), report);
        return sample_reported(grid, sample_, seen({grid.report().min, grid.report().max}), app(), report);
    }

    [[nodiscard]] UpAxis up_axis() const { return up_ == "x" ? UpAxis::X : up_ == "y" ? UpAxis::Y : UpAxis::Z; }

    [[nodiscard]] std::optional<TransferFunction> seen(const Range& range) const {
        if (transfer_function_.empty()) return std::nullopt;
        return find_transfer_function(transfer_function_, range);
    }

    std::string input_;
    std::string output_;
    bool ascii_ = false;
    bool splats_ = false, clamp_ = false, error_ = false;
    std::string up_ = "z", transfer_function_;
    SampleArguments sample_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_points_verb(CLI::App& program) {
    return std::make_unique<PointsVerb>(program);
}

}  // namespace subvol::cli
