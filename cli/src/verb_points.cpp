#include "input.h"
#include "ply_writer.h"
#include "sample_arguments.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class PointsVerb : public Verb {
public:
    explicit PointsVerb(CLI::App& program)
        : Verb(program, "points", "Turn a mesh into radial basis functions.",
               "  subvol points model:ball -o ball.ply\n"
               "  subvol points model:ball -o dense.ply --per-edge 2 --ascii") {
        app().add_option("FILE", input_, kInputHelp)->required();
        app().add_option("-o,--output", output_, "the points to write (.ply)")->type_name("FILE")->required();
        app().add_flag("--ascii", ascii_, "write text instead of binary numbers");
        sample_.add_to(app());
        refine_.add_to(app(), "sample the refined mesh of this level instead of the limit");
    }

    int run(Report& report) override {
        check_output(output_, {".ply"}, {".vdb", ".vtp"});
        const HexMesh mesh = with_selected_field(load_mesh(input_, common(), report), common(), report);
        const RbfVolume volume = sample_reported(mesh, sample_, refine_, report);
        report.timed("write", [&] { write_ply(output_, volume, ascii_ ? PlyEncoding::Ascii : PlyEncoding::Binary); });
        report["output"] = output_;
        return 0;
    }

private:
    std::string input_;
    std::string output_;
    bool ascii_ = false;
    SampleArguments sample_;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_points_verb(CLI::App& program) {
    return std::make_unique<PointsVerb>(program);
}

}  // namespace subvol::cli
