// SPDX-License-Identifier: Apache-2.0
// The verb `points`: it turns a volume into kernels.
//
//     mesh or grid ─► kernels ─► merged, values clamped, a channel of errors added ─► one file
//     bricks       ─► kernels brick by brick, each written as it is made           ─► one file
//     steps        ─► kernels of each step                                         ─► a file for each
//
// Shares are ranges of the kernels in their order, ranges of bricks, or some of the steps; their files, or what ranks make,
// join to what one process would write.
#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "body_input.h"
#include "grid_fields.h"
#include "grid_input.h"
#include "input.h"
#include "limit_warning.h"
#include "mesh_frames.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "part_kinds.h"
#include "picture_arguments.h"
#include "picture_shares.h"
#include "points_input.h"
#include "quantities.h"
#include "sampled_points.h"
#include "share.h"
#include "steps.h"
#include "subvol/clamp_channel.h"
#include "subvol/detail/points_range.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/kernel_file.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/option.h"
#include "subvol/points_error.h"
#include "subvol/points_io.h"
#include "tet_refinement.h"
#include "text.h"
#include "vdb_functions.h"
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
               "  subvol points big.vtu -o part2.ply --part 2/4        a share, for join\n"
               "  subvol points big.vtu -o big.svk                     with levels of detail\n"
               "  subvol points part.vtu -o part.npz                   arrays for numpy\n"
               "  subvol points part.vtu -o part.glb                   splats for viewers\n"
               "\n"
               "The boundary of NAME.vtp, of NAME.vdb and of a .ply with --splats is in NAME.boundary.vtp.") {
        show_limit_of_parts();
        app().add_option("FILE", input_, text(input_help(), "; or a .vdb grid of floats"))->required();
        app()
            .add_option("-o,--output", output_, "the points to write (.ply, .vtp, .svk, .vdb, .npz, .glb)")
            ->type_name("FILE")
            ->required();
        add_options(app(), options_of(written_));
        sample_.add_to(app());
        add_option(app(), Option("tf", transfer_function_)
                              .help("FILE|NAME", "the colour map for --threshold, as for `render`")
                              .only_with("threshold"));
        add_option(
            app(),
            Option("clamp", clamp_).help("keep the kernels' values within the field's range: interpolating schemes overshoot"));
        add_option(app(),
                   Option("error", error_)
                       .help("also write a channel NAME_error: about how far the sum of kernels is from the limit near each"));
        add_option(app(),
                   Option("merge", merge_error_)
                       .positive()
                       .help("ERROR",
                             "merge neighbouring kernels as long as the values at their centres change by at most ERROR, "
                             "in the field's unit: few kernels where the field is smooth"));
        refine_.add_to(app(), "sample the refined mesh of this level instead of the limit");
        share_.add_to(app(), "a range of the points in their order, of bricks, or of the steps");
        set_essentials({"--output", "--field", "--per-edge", "--spacing", "--tolerance", "--footprint", "--threshold",
                        "--reduce", "--levels", "--scheme"});
        group("Where kernels are", {"--per-edge", "--centers", "--spacing", "--spacing-voxels", "--tolerance", "--footprint",
                                    "--footprint-size", "--threshold", "--tf", "--reduce", "--refine", "--merge"});
        group("What kernels are", {"--values", "--kernel", "--value-kernel", "--correction", "--error"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        check_output(output_, {".ply", ".vtp", ".svk", ".vdb", ".npz", ".glb"});
        const std::string extension = std::filesystem::path(output_).extension().string();
        if (extension != ".ply" && (written_.ascii || (written_.splats && extension != ".glb"))) {
            throw Error(ErrorCode::InvalidInput,
                        written_.ascii ? "only .ply files have it" : "only .ply and .glb files have it",
                        written_.ascii ? "--ascii" : "--splats");
        }
        const Share share = share_of(share_);
        tets_ = TetRefinement(refine_);
        report.if_long(sample_.reduction.rmse > 0 ? "a larger --reduce, and no --refine" : "a larger --spacing or --tolerance");
        if (kind_of(input_) == InputKind::Bricks) {
            write_bricks(share, report);
            return 0;
        }
        if (asks_for_steps(common())) {
            write_steps(share, report);
            return 0;
        }
        if (share_.given() && extension == ".vdb") {
            throw Error(ErrorCode::InvalidInput, "a share of points is not written as .vdb, which rounds their places", output_,
                        ".ply or .vtp; `subvol join` writes .vdb");
        }
        if (share_.given() && extension == ".svk") {
            throw Error(ErrorCode::InvalidInput, "the levels of detail of a .svk file are those of all points", output_,
                        ".ply or .vtp; `subvol join` writes .svk");
        }
        if (share_.given() && (extension == ".npz" || extension == ".glb")) {
            throw Error(ErrorCode::InvalidInput,
                        text("a share of points is not written as ", extension, ", which is not read again"), output_,
                        text(".ply or .vtp; `subvol join` writes ", extension));
        }
        RbfVolume volume = is_vdb_file(input_) ? points_of_grid(report) : points_of_mesh(common(), report);
        if (shares(share_)) {
            const auto [begin, end] = share.range(volume.size());
            const ShareRange range{begin, end, volume.size()};
            RbfVolume kernels = detail::kernels_between(volume, begin, end);
            volume = {};
            const Transport to = transport(
                share_, input_, range,
                {{"ascii", written_.ascii}, {"splats", written_.splats}, {"up", std::string(name_of(written_.up))}}, report);
            auto whole = report.unpack(deliver(KernelParts{output_, written_, report.progress()}, std::move(kernels), to));
            if (!whole) return 0;
            volume = std::move(*whole);
        }
        report.merge(write_kernels(output_, volume, written_, report.progress()));
        report.merge(files_of_kernels(output_, volume, written_));
        return 0;
    }

private:
    /// Brick by brick into one file; the memory is that of a brick.
    void write_bricks(const Share& share, Report& report) {
        const bool blocks = output_.ends_with(".svk") && !share_.given();
        if ((!output_.ends_with(".ply") && !blocks) || written_.ascii || written_.splats) {
            const std::string form = share_.given() ? "shares of points of bricks are" : "points of bricks are";
            throw Error(ErrorCode::InvalidInput,
                        form + " written as binary .ply" + (share_.given() ? "" : " or .svk") + " only", output_,
                        "-o NAME.ply without --ascii and --splats");
        }
        refuse_options(app(), {"--levels", "--threshold", "--tf", "--reduce", "--clamp", "--error", "--merge"},
                       "needs the whole mesh in memory; this is a folder of bricks");
        tets_.refuse_bricks(input_);
        report["input"] = input_;
        BodyInput body = report.unpack(open_body(input_, common(), app(), report.progress()));
        const std::string field = report.unpack(body.select(common(), OtherFields::Drop));
        const MeshSource source = body.source();
        const SampleOptions options = sample_.options(source.bounds(), refine_.options(0, report.progress()));
        const std::size_t pieces = source.stored().pieces.size();
        const auto [begin, end] = share.range(pieces);
        BrickShare brick_share{begin, end, {}};
        const Transport to = transport(share_, input_, {begin, end, pieces}, {{"points", source.stored().points}}, report);
        if (to.note) {
            report["part"] = share.name();
            brick_share.note = text_of(*to.note);
        }
        const BrickPointsReport written = report.timed("sample", [&] {
            return ranks() != nullptr
                       ? write_points_ranked(output_, source, options, *ranks())
                       : write_points_of_bricks(output_, source, options, share_.given() ? &brick_share : nullptr);
        });
        if (!speaks()) return;
        if (written.points > 0) say_beyond(report, field, body.range(field), {written.min, written.max}, true);
        report["points"] = written.points;
        report["boundary_triangles"] = written.triangles;
        report["output"] = output_;
    }

    void write_steps(const Share& share, Report& report) {
        check_numbered(output_, "step", "points_####.ply");
        const MeshSeries series = open_series(input_);
        const FrameRange steps = chosen_steps(series, common()), range = frames_of(share, steps);
        const CommonOptions all = report.unpack(for_steps(input_, common(), steps, report.progress()));
        if (share_.given()) report["part"] = share.name();
        report["frames"] = Json::array();
        StepsWithFields taken(report);
        for (int step = range.first; step <= range.last; ++step) {
            const std::string path = with_number(output_, step);
            const bool there = taken.take(step, [&] {
                report.merge(write_kernels(path, points_of_mesh(of_step(all, step), report), written_, report.progress()));
            });
            if (!there) continue;
            report["frames"].push_back({{"frame", step},
                                        {"time", series.times[static_cast<std::size_t>(step)]},
                                        {"points", report["points"]},
                                        {"output", path}});
        }
        taken.finish();
        if (ranks() != nullptr) report["frames"] = ranks()->gather_list(report["frames"]);
        report["input"] = input_;
        report["output"] = output_;
    }

    [[nodiscard]] RbfVolume points_of_mesh(const CommonOptions& options, Report& report) {
        report["input"] = input_;
        HexMesh mesh = report.unpack(load_mesh(input_, options, report.progress()));
        mesh = report.unpack(with_selected_field(std::move(mesh), options));
        if (!tets_.asked() && !std::exchange(said_limit_, true))  // once for all steps
            report.warn(limit_warning(input_, mesh, refine_.options(0, nullptr).scheme, report.progress()));
        const Range given = field_range(mesh);
        const std::optional<FieldRange> bounds = bounds_of(mesh.attributes.front());
        const bool of_file = !is_model(input_) && !mesh.attributes.front().derived;
        mesh = report.unpack(tets_.hexes(std::move(mesh), 1, report.progress()));
        const HexMesh compared = error_ ? mesh : HexMesh{};
        RbfVolume volume =
            report.unpack(tets_.asked() ? sample_tets_reported(mesh, sample_, seen(given), report.progress())
                                        : sample_reported(std::move(mesh), sample_, refine_, seen(given), report.progress()));
        merge(volume, report);
        if (clamp_) {
            report["clamped"] = clamp_channel(volume.channels.front(), given.min, given.max);
        } else if (!bounds) {
            say_beyond(report, volume.channels.front().name, given, channel_range(volume, 0), of_file);
        }
        if (error_) add_error(compared, volume, report);
        return volume;
    }

    void merge(RbfVolume& volume, Report& report) const {
        if (!merge_error_) return;
        report.timed("merge", [&] {
            const KernelHierarchy hierarchy = build_kernel_hierarchy(volume, report.progress());
            const KernelCut cut = choose_cut(hierarchy, *merge_error_);
            report["points_before"] = volume.size();
            report["merge_error"] = cut.error;
            if (!cut.nodes.empty()) volume = kernels_of_cut(hierarchy, volume, cut);
        });
        report["points"] = volume.size();
    }

    void add_error(const HexMesh& mesh, RbfVolume& volume, Report& report) const {
        const std::string name = volume.channels.front().name;
        const SchemeOptions scheme = refine_.options(0, report.progress()).scheme;
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
        report["input"] = input_;
        const VdbGrid grid = report.unpack(load_grid(input_, common(), report.progress()));
        RbfVolume volume = report.unpack(
            sample_reported(grid, sample_, seen({grid.report().min, grid.report().max}), app(), report.progress()));
        merge(volume, report);
        return volume;
    }

    [[nodiscard]] std::optional<TransferFunction> seen(const Range& range) const {
        if (transfer_function_.empty()) return std::nullopt;
        return find_transfer_function(transfer_function_, range);
    }

    std::string input_;
    std::string output_;
    PointsWriteOptions written_;
    bool clamp_ = false, error_ = false, said_limit_ = false;
    std::optional<double> merge_error_;
    std::string transfer_function_;
    ShareArgument share_;
    SampleArguments sample_;
    RefineArguments refine_;
    TetRefinement tets_;
};

}  // namespace

std::unique_ptr<Verb> make_points_verb(CLI::App& program) {
    return std::make_unique<PointsVerb>(program);
}

}  // namespace subvol::cli
