// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>

#include "grid_input.h"
#include "input.h"
#include "options.h"
#include "outputs.h"
#include "points_input.h"
#include "quantities.h"
#include "steps.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/picture_look.h"
#include "subvol/usd_file.h"
#include "text.h"
#include "vdb_functions.h"
#include "vdb_output.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class UsdVerb : public Verb {
public:
    explicit UsdVerb(CLI::App& program)
        : Verb(program, "usd", "Write OpenUSD text: a volume of .vdb files, or kernels as Gaussian splats.",
               "  subvol usd part.vtk -o part.usda --resolution 400          and part.vdb beside it\n"
               "  subvol usd run.pvd -o run.usda --step all                  run_0000.vdb …, a time sample for each step\n"
               "  subvol usd a.vdb b.vdb -o ab.usda                          of files that are there\n"
               "  subvol points part.vtk -o part.svk && subvol usd part.svk -o splats.usda\n"
               "\n"
               "JSON: output, files, codes; grids of volumes, points (of each time sample) and channels of splats.") {
        show_limit_of_parts();
        add_input(app(), "FILE", inputs_,
                  text(input_help(), "; or .vdb files of grids, or points (.ply, .vtp, .svk, .vdb), one for each time"))
            ->required();
        add_option(app(), Option("output", output_).also("o").help("FILE", "the stage to write (.usda)"))->required();
        for (const Option& option : options_of(voxels_)) {
            if (option.name == "resolution" || option.name == "half") add_option(app(), option);
        }
        for (const Option& option : options_of(look_)) {
            if (option.name == "tf" || option.name == "range" || option.name == "opacity" || option.name == "opacity-unit")
                add_option(app(), option);
        }
        add_option(
            app(),
            Option("up", volume_.up)
                .help("AXIS", "the axis of the data that is up, which the stage says: y or z; the data stay as they are"));
        add_crease_angle();
        set_essentials({"--output", "--resolution", "--field", "--step", "--tf", "--up", "--json"});
    }

    int run(Report& report) override {
        check_output(output_, {".usda"});
        if (volume_.up == UpAxis::X)
            throw Error(ErrorCode::InvalidInput, "OpenUSD has no stages whose x is up", "--up", "y or z");
        (void)optics(Box{Vec3(0.0), Vec3(1.0)}, {0, 1});  // a mistake is found before anything is written
        const InputKind kind = kind_of(inputs_.front());
        for (const std::string& input : inputs_) {
            if (kind_of(input) != kind || (kind != InputKind::Mesh && kind != InputKind::Grid && kind != InputKind::Points)) {
                if (!is_model(input)) detail::refuse_missing(input);
                throw Error(ErrorCode::InvalidInput, "is neither a mesh nor a .vdb file or points, or not as the first", input,
                            "one mesh, or several .vdb files, or several files of points");
            }
        }
        if (kind == InputKind::Mesh) {
            write_meshes(report);
        } else {
            refuse_mesh_options(app(), "needs a mesh");
            refuse_options(app(), {"--field"}, "needs a mesh; of other files all grids or channels are taken");
            refuse_options(app(), {"--resolution", "--half"}, "needs a mesh, which becomes voxels");
            kind == InputKind::Grid ? write_grids(report) : write_splats(report);
        }
        report["output"] = output_;
        return 0;
    }

private:
    [[nodiscard]] Optics optics(const Box& box, const Range& range) const {
        return picture_optics(look_options(look_, Look::Volume, range, OptionNames::Flags), box, range, range);
    }

    /// Takes the grids of a file as the next step.
    void add_step(std::span<const VdbGrid> grids, const std::string& file, double code) {
        std::vector<UsdGrid> names;
        for (const VdbGrid& grid : grids) {
            const GridReport& found = grid.report();
            if (found.active_voxels == 0 || (found.kind != "float" && found.kind != "vector")) continue;
            names.push_back({found.name, found.kind == "vector"});
            if (names.size() > 1) continue;
            volume_.steps.push_back({code, file, found.frame});
            range_.min = volume_.steps.size() == 1 ? found.min : std::min(range_.min, found.min);
            range_.max = volume_.steps.size() == 1 ? found.max : std::max(range_.max, found.max);
        }
        if (names.empty()) throw Error(ErrorCode::InvalidInput, "has no grid of floats or vectors with active voxels", file);
        if (volume_.grids.empty()) volume_.grids = names;
        if (volume_.grids != names) throw Error(ErrorCode::InvalidInput, "has other grids than the first file", file);
    }

    void write_volume(Report& report) {
        const Optics shown = optics(volume_.steps.front().extent, range_);
        volume_.colors = shown.function();
        volume_.opacity_unit_world = shown.opacity_unit();
        write_usd(output_, volume_);
        report["files"] = Json::array();
        report["codes"] = Json::array();
        report["grids"] = Json::array();
        for (const UsdStep& step : volume_.steps) {
            report["files"].push_back(step.file.string());
            report["codes"].push_back(step.code);
        }
        for (const UsdGrid& grid : volume_.grids) report["grids"].push_back(grid.name);
    }

    void write_meshes(Report& report) {
        if (inputs_.size() > 1)
            throw Error(ErrorCode::InvalidInput, "is a second mesh", inputs_[1], "one mesh, or a series with --step all");
        const std::string base = std::filesystem::path(output_).replace_extension().string();
        if (!asks_for_steps(common())) {
            write_mesh_grid(common(), base + ".vdb", 0, report);
        } else {
            const MeshSeries series = open_series(inputs_[0]);
            const FrameRange range = chosen_steps(series, common());
            const CommonOptions all = report.unpack(for_steps(inputs_[0], common(), range, report.progress()));
            StepsWithFields taken(report);
            for (int step = range.first; step <= range.last; ++step) {
                const std::string file = with_number(base + "_####.vdb", step);
                taken.take(step, [&] { write_mesh_grid(of_step(all, step), file, step, report); });
            }
            taken.finish();
        }
        report["input"] = inputs_[0];
        write_volume(report);
    }

    void write_mesh_grid(const CommonOptions& options, const std::string& file, double code, Report& report) {
        report["input"] = inputs_[0];
        HexMesh mesh = report.unpack(load_mesh(inputs_[0], options, report.progress()));
        mesh = report.unpack(with_selected_field(std::move(mesh), options));
        RasterizeOptions voxels = voxels_;
        voxels.progress = report.progress();
        const std::vector<std::string> fields{mesh.attributes.front().name};
        const LimitGrids made = report.timed("rasterize", [&] { return vdb().rasterize_limit(mesh, fields, voxels); });
        if (!has_voxels(made.grids)) throw no_voxels(inputs_[0], finer_voxels(mesh));
        vdb().write_vdb(file, made.grids, VdbCompression::Blosc);
        add_step(made.grids, file, code);
    }

    void write_grids(Report& report) {
        for (std::size_t k = 0; k < inputs_.size(); ++k)
            add_step(vdb().read_vdb_contents(inputs_[k]).grids, inputs_[k], static_cast<double>(k));
        write_volume(report);
    }

    void write_splats(Report& report) {
        refuse_options(app(), {"--opacity-unit"}, "needs grids; the opacities of splats are those of the colour map");
        std::vector<RbfVolume> steps;
        std::vector<double> codes;
        Range range;
        Json points = Json::array();
        for (const std::string& input : inputs_) {
            steps.push_back(report.unpack(read_points_input(input, report.progress())));
            codes.push_back(static_cast<double>(codes.size()));
            const Range found = channel_range(steps.back(), 0);
            range.min = steps.size() == 1 ? found.min : std::min(range.min, found.min);
            range.max = steps.size() == 1 ? found.max : std::max(range.max, found.max);
            points.push_back(steps.back().size());
        }
        write_usd(output_, steps, codes, optics(box_of(steps.front()), range).function(), volume_.up);
        report["files"] = inputs_;
        report["codes"] = codes;
        report["points"] = std::move(points);
        report["channels"] = Json::array();
        for (const RbfChannel& channel : steps.front().channels) report["channels"].push_back(channel.name);
    }

    std::vector<std::string> inputs_;
    std::string output_;
    RasterizeOptions voxels_{.resolution = 200};
    LookChoices look_;
    UsdVolume volume_;
    Range range_;
};

}  // namespace

std::unique_ptr<Verb> make_usd_verb(CLI::App& program) {
    return std::make_unique<UsdVerb>(program);
}

}  // namespace subvol::cli
