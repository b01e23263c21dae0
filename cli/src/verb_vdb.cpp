#include <algorithm>
#include <cmath>

#include "input.h"
#include "refine_arguments.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_report.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"
#include "subvol/vdb.h"
#include "subvol/version.h"
#include "text.h"
#include "vdb_output.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr double kPositionTolerance_voxels = 0.1;
constexpr double kBytesOfChannel = 5.5;  // a voxel's float in leaves that are not all full, with their masks

VdbCompression compression_named(const std::string& name) {
    return name == "zip" ? VdbCompression::Zip : name == "none" ? VdbCompression::None : VdbCompression::Blosc;
}

class VdbVerb : public Verb {
public:
    explicit VdbVerb(CLI::App& program)
        : Verb(program, "vdb", "Turn a mesh into an OpenVDB file: a grid a field.",
               "  subvol vdb model:ball -o ball.vdb\n"
               "  subvol vdb flow.vtk -o flow.vdb --fields Temp,V --resolution 400 --half\n"
               "  subvol vdb model:pawn -o pawn.vdb --resolution 1600 --memory 2G") {
        app().add_option("FILE", input_, kInputHelp)->required();
        app().add_option("-o,--output", output_.path, "the file to write (.vdb)")->type_name("FILE")->required();
        add_size_options();
        refine_.add_to(app(), "rasterize the refined mesh of this level; omitted: the level that stands for the limit");
        add_grid_options();
        app()
            .add_option("--compression", compression_, "blosc (the default), zip, none")
            ->type_name("NAME")
            ->check(CLI::IsMember({"blosc", "zip", "none"}));
        app()
            .add_option("--memory", output_.memory_bytes,
                        "write parts whose grids take no more than this, e.g. 2G: NAME_0000.vdb and so on, and NAME.json, "
                        "which lists them")
            ->type_name("BYTES")
            ->transform(CLI::AsSizeValue(false));
        app().add_flag("--nano", nano_, "write a NanoVDB file beside it; needs a build with NanoVDB");
    }

    int run(Report& report) override {
        check_choice("--from", from_, {"mesh", "points"});
        if (nano_) throw Error(ErrorCode::MissingCapability, "this build has no NanoVDB", "--nano");
        output_.compression = compression_named(compression_);
        RefineOptions refinement = refine_.options(0, report);
        check_output(output_.path, {".vdb"});
        const HexMesh mesh = with_written_fields(load_mesh(input_, common(), report), report);
        const std::vector<VdbGrid> like = like_.empty() ? std::vector<VdbGrid>() : read_vdb(like_);
        const double voxel_size = like.empty() ? voxel_size_world(mesh) : like.front().report().voxel_size_world;
        if (!refine_.levels) refinement.levels = limit_level(mesh, refinement, voxel_size, report);
        report["levels"] = refinement.levels;
        report["cells"] = mesh.cells.size() << (3 * refinement.levels);

        std::vector<std::string> names;
        for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
        const RasterizeOptions options{.voxel_size_world = voxel_size,
                                       .like = like.empty() ? nullptr : &like.front(),
                                       .refine = refinement,
                                       .on_limit = !interpolates(refinement.scheme),
                                       .half = half_,
                                       .cell_numbers = cell_numbers_,
                                       .mask = mask_,
                                       .coverage = coverage_,
                                       .metadata = {{"subvol_input", input_},
                                                    {"subvol_from", from_},
                                                    {"subvol_scheme", refine_.scheme},
                                                    {"subvol_level", std::to_string(refinement.levels)},
                                                    {"subvol_version", SUBVOL_VERSION}},
                                       .progress = report.progress()};
        if (from_ == "points") {
            write_from_points(mesh, names, options, report);
        } else if (output_.memory_bytes > 0) {
            write_parts(mesh, names, options, output_, report);
        } else {
            write_one_piece(mesh, names, options, output_, report);
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
        auto* like = app().add_option("--like", like_, "a .vdb file whose first grid's transform is taken over");
        like->type_name("FILE")->excludes(size)->excludes(resolution);
        app()
            .add_option("--budget", budget_bytes_, "voxels so small that the grids take about this much memory, e.g. 500M")
            ->type_name("BYTES")
            ->transform(CLI::AsSizeValue(false))
            ->excludes(size)
            ->excludes(resolution)
            ->excludes(like);
    }

    void add_grid_options() {
        app()
            .add_option("--fields", fields_,
                        "fields to write, the first as fog volume; one with three components becomes a grid of vectors, v.k is "
                        "its component k")
            ->type_name("A,B")
            ->delimiter(',');
        app().add_flag("--cell-ids", cell_numbers_, "one more grid: the number of the control cell");
        app().add_flag("--mask", mask_, "one more grid: where the volume is");
        app().add_flag("--coverage", coverage_, "one more grid: the part of each voxel that the volume fills");
        app().add_flag("--half", half_, "store floats in 16 bits");
        app()
            .add_option("--from", from_,
                        "what is rasterized: mesh, or points: kernels sampled from it, summed at the voxels of the mesh")
            ->type_name("WHAT");
        app()
            .add_option("--per-edge", per_edge_, "with --from points: sample intervals an edge")
            ->type_name("N")
            ->check(CLI::Range(1, 64));
    }

    [[nodiscard]] HexMesh with_written_fields(HexMesh mesh, Report& report) const {
        if (fields_.empty()) return with_selected_field(std::move(mesh), common(), report);
        std::vector<Attribute> chosen;
        for (const std::string& name : fields_) {
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

    [[nodiscard]] static int limit_level(const HexMesh& mesh, const RefineOptions& refinement, double voxel_size,
                                         Report& report) {
        const LimitLevel limit = report.timed("limit level", [&] {
            return find_limit_level(mesh, refinement, {.position_world = kPositionTolerance_voxels * voxel_size});
        });
        report["limit_deviation"] = {{"voxels", limit.position_world / voxel_size}, {"of_range", limit.value_of_range}};
        if (!limit.converged) {
            report.warn(text("level ", limit.level, " was the finest within limits; the last step still moved points by ",
                             limit.position_world / voxel_size, " voxels and values by ", limit.value_of_range,
                             " of their range"));
        }
        return limit.level;
    }

    /// The kernels' sums at the voxels of the mesh, and how far they are from the mesh's own values.
    void write_from_points(const HexMesh& mesh, std::span<const std::string> names, const RasterizeOptions& options,
                           Report& report) const {
        if (output_.memory_bytes > 0) throw Error(ErrorCode::InvalidInput, "goes with a mesh only", "--memory");
        auto grids = report.timed("rasterize", [&] { return rasterize(mesh, names, options); });
        const SampleOptions sampling{.scheme = options.refine.scheme, .tension = options.refine.tension, .per_edge = per_edge_};
        const RbfVolume volume = report.timed("sample", [&] { return sample_rbf_points(mesh, sampling).volume; });
        report["points"] = volume.size();
        for (std::size_t f = 0; f < names.size(); ++f) {
            if (mesh.attributes[f].channels != 1) {
                throw Error(ErrorCode::InvalidInput, "has three components; kernels carry one", "field " + names[f]);
            }
            VdbGrid sums = report.timed("kernel sums", [&] {
                const RbfField field(volume, {.channel = f, .least_weight = 0});
                return sample_at_voxels(grids[f], names[f], [&](std::span<const Vec3> x) { return field.evaluate(x); });
            });
            const GridDifference difference = compare_voxels(grids[f], sums);
            report["against_mesh"].push_back(
                {{"name", names[f]}, {"l2", difference.rms}, {"linf", difference.max}, {"voxels", difference.voxels}});
            grids[f] = std::move(sums);
        }
        write_reported(grids, output_, report);
    }

    std::string input_;
    VdbOutput output_;
    double voxel_size_ = 0;
    int resolution_ = 200;
    std::uint64_t budget_bytes_ = 0;
    std::string like_;
    std::vector<std::string> fields_;
    bool half_ = false, cell_numbers_ = false, mask_ = false, coverage_ = false, nano_ = false;
    std::string from_ = "mesh", compression_ = "blosc";
    int per_edge_ = 1;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_vdb_verb(CLI::App& program) {
    return std::make_unique<VdbVerb>(program);
}

}  // namespace subvol::cli
