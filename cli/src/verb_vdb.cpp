#include <algorithm>

#include "input.h"
#include "limit_level.h"
#include "refine_arguments.h"
#include "subvol/vdb.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class VdbVerb : public Verb {
public:
    explicit VdbVerb(CLI::App& program)
        : Verb(program, "vdb", "Turn a mesh into an OpenVDB file: one float grid a field.",
               "  subvol vdb model:ball -o ball.vdb\n"
               "  subvol vdb flow.vtk -o flow.vdb --fields Temp,Pres --resolution 400 --half") {
        app().add_option("FILE", input_, kInputHelp)->required();
        app().add_option("-o,--output", output_, "the file to write (.vdb)")->type_name("FILE")->required();
        auto* size = app().add_option("--voxel-size", voxel_size_, "edge of a voxel in world units");
        size->type_name("H")->check(CLI::PositiveNumber);
        app()
            .add_option("--resolution", resolution_, "voxels along the longest side of the bounding box (default 200)")
            ->type_name("N")
            ->check(CLI::Range(1, 1 << 20))
            ->excludes(size);
        refine_.add_to(app(), "rasterize the refined mesh of this level; omitted: the level that stands for the limit");
        app().add_option("--fields", fields_, "fields to write, the first as fog volume")->type_name("A,B")->delimiter(',');
        app().add_flag("--half", half_, "store values as 16-bit floats");
        app().add_option("--from", from_, "what is rasterized: mesh")->type_name("WHAT");
    }

    int run(Report& report) override {
        check_choice("--from", from_, {"mesh"}, {"points"});
        const RefineOptions refinement = refine_.options(0, report);
        check_output(output_, {".vdb"});
        HexMesh mesh = with_written_fields(load_mesh(input_, common(), report), report);
        const double voxel_size = voxel_size_world(bounds(mesh));
        mesh = refine_.levels ? refine_reported(mesh, refinement, Vertices::OnTheLimit, report)
                              : limit(std::move(mesh), refinement, voxel_size, report);

        std::vector<std::string> names;
        for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
        const auto grids = report.timed("rasterize", [&] {
            return rasterize(mesh, names, {.voxel_size_world = voxel_size, .half = half_, .progress = report.progress()});
        });
        report.timed("write", [&] { write_vdb(output_, grids); });
        report["output"] = output_;
        report["active_voxels"] = grids.front().report().active_voxels;
        report["voxel_size"] = voxel_size;
        for (const VdbGrid& grid : grids) {
            const GridReport& about = grid.report();
            report["grids"].push_back({{"name", about.name}, {"min", about.min}, {"max", about.max}, {"bytes", about.bytes}});
        }
        return 0;
    }

private:
    [[nodiscard]] HexMesh with_written_fields(HexMesh mesh, Report& report) const {
        if (fields_.empty()) return with_selected_field(std::move(mesh), common(), report);
        std::vector<Attribute> chosen;
        for (const std::string& name : fields_) {
            SelectedField selected = select_field(mesh, name);
            report.warn(selected.warning);
            chosen.push_back(std::move(selected.scalar));
        }
        mesh.attributes = std::move(chosen);
        return mesh;
    }

    [[nodiscard]] double voxel_size_world(const Box& box) const {
        const Vec3 size = box.size();
        return voxel_size_ > 0 ? voxel_size_ : std::max({size.x, size.y, size.z}) / resolution_;
    }

    [[nodiscard]] static HexMesh limit(HexMesh mesh, const RefineOptions& options, double voxel_size, Report& report) {
        LimitMesh limit = report.timed("refine", [&] { return refine_to_limit(std::move(mesh), options, voxel_size); });
        report["levels"] = limit.level;
        report["cells"] = limit.mesh.cells.size();
        report["limit_deviation"] = {{"voxels", limit.position_voxels}, {"of_range", limit.value_range}};
        if (!limit.converged) {
            report.warn(text("level ", limit.level, " was the finest within limits; the last step still moved points by ",
                             limit.position_voxels, " voxels and values by ", limit.value_range, " of their range"));
        }
        return std::move(limit.mesh);
    }

    std::string input_;
    std::string output_;
    double voxel_size_ = 0;
    int resolution_ = 200;
    std::vector<std::string> fields_;
    bool half_ = false;
    std::string from_ = "mesh";
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_vdb_verb(CLI::App& program) {
    return std::make_unique<VdbVerb>(program);
}

}  // namespace subvol::cli
