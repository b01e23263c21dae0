// SPDX-License-Identifier: Apache-2.0
// The verb `info`: the figures of what a file holds, by its kind (file_info.h), and the OpenGL devices.
#include <CLI/CLI.hpp>
#include <memory>

#include "choices.h"
#include "file_info.h"
#include "numbers.h"
#include "options.h"
#include "share.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/splat.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

Json device_json(const GlDevice& device) {
    return {{"index", device.index},
            {"renderer", device.renderer},
            {"hardware", device.hardware},
            {"version", device.version},
            {"max_ssbo_bytes", device.max_ssbo_bytes},
            {"memory_bytes", device.memory_bytes > 0 ? Json(device.memory_bytes) : Json(nullptr)}};
}

class InfoVerb : public Verb {
public:
    explicit InfoVerb(CLI::App& program)
        : Verb(program, "info", "Print statistics of a mesh, a .vdb file or a kernel file, and check the mesh for errors.",
               "  subvol info model:ball\n"
               "  subvol info ball.vdb --at 0,0,0 --at .5,0,0\n"
               "  subvol info part.vtu --folds\n"
               "  subvol info wing.bdf      by meshio or VTK, as files of many other programs\n"
               "  subvol info --gl\n"
               "\n"
               "JSON: blocks and sets, each with name, cells (those that it consists of after the splitting; blocks also "
               "elements, as the file counts them) and volume, as of the whole; node_sets with name and nodes; ignored, the "
               "parts "
               "of the file that are not taken, each with kind, name, count and, where the reader knows it, reason. With "
               "--folds: "
               "folds, with verdict, cells "
               "{proved, folded, undecided, irregular} and open_volume, as of "
               "check.") {
        add_input(app(), "FILE", input_, text(input_help(), ", or a .vdb file, or points (.ply, .vtp, .svk)"));
        add_option(app(), Option("list-fields", list_fields_).help("print the names of a mesh's fields only, one a line"));
        add_option(
            app(),
            Option("ignored", ignored_)
                .help("print the parts of a mesh's file that are not taken only, one a line: kind, name, how many, why"));
        add_option(
            app(),
            Option("folds", folds_).help("how many cells are proved not to fold in the limit of MCQ (check: where they fold)"));
        add_option(app(), Option("limit", limit_).help("volume and box of the limit of MCQ, too"));
        add_option(app(), Option("gl", gl_).help("list the OpenGL devices that can splat"));
        add_option(
            app(),
            Option("at", places_)
                .help("X,Y,Z", "print the values of a .vdb file's grids there, or of the one that --field names (repeatable)"))
            ->transform(number_list(3, "1,2,3"));
        refine_.scheme.clear();
        add_option(app(), Option("scheme", refine_.scheme)
                              .offer(tet_schemes())
                              .help("NAME", "figures of the refined tetrahedra, too: of tetoct or boxspline"));
        add_option(app(),
                   Option("levels", refine_.levels).between(0, 8).help("L", "of --scheme (default 2)").only_with("scheme"));
        add_option(app(), refine_.described()[2]);  // --crease-angle
        share_.add_to(app(), "the figures of some cells of a mesh, with --json");
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        if (input_.empty()) {
            describe_devices_alone(report);
            return 0;
        }
        if (ignored_)
            refuse_options(app(), {"--list-fields", "--folds", "--limit", "--scheme", "--gl"}, "has no effect with --ignored");
        InfoRequest request{.app = app(),
                            .common = common(),
                            .input = input_,
                            .lists_fields = list_fields_,
                            .ignored = ignored_,
                            .folds = folds_,
                            .limit = limit_,
                            .devices = gl_,
                            .places = places_,
                            .is_part = share_.given(),
                            .ranks = ranks()};
        if (!refine_.scheme.empty()) {
            check_choice("--scheme", refine_.scheme, tet_schemes());
            request.tets = TetRefinement(refine_);
        }
        if (shares(share_)) request.share = share_of(share_);
        const std::unique_ptr<FileInfo> info = make_file_info(request);
        if (list_fields_) {
            list_fields(request, *info, report);
            return 0;
        }
        if (gl_) describe_devices(report);
        info->describe(report);
        return 0;
    }

private:
    void describe_devices_alone(Report& report) {
        if (ranks() != nullptr)
            throw Error(ErrorCode::InvalidInput, "only the figures of a mesh are found in several processes", "info");
        refuse_options(app(), {"--list-fields", "--ignored", "--folds", "--limit", "--scheme", "--at", "--part"},
                       "is about a FILE");
        if (!gl_) throw Error(ErrorCode::InvalidInput, "a FILE is needed, or --gl", "info");
        describe_devices(report);
    }

    static void describe_devices(Report& report) {
        const std::vector<GlDevice> devices = gl_devices();
        report["gl"] = Json(nullptr);
        if (!devices.empty()) report["gl"] = {{"renderer", devices.front().renderer}, {"hardware", devices.front().hardware}};
        report["gl_devices"] = Json::array();
        for (const GlDevice& device : devices) report["gl_devices"].push_back(device_json(device));
    }

    static void list_fields(const InfoRequest& request, FileInfo& info, Report& report) {
        report["fields"] = Json::array();
        for (const std::string& name : info.field_names(report)) {
            if (!request.shows(name)) continue;
            report["fields"].push_back({{"name", name}});
            report.answer(name);
        }
        if (report.json().at("fields").empty() && request.common.field) {
            throw Error(ErrorCode::InvalidInput, "there is no field '" + *request.common.field + "'", request.input,
                        "--list-fields alone");
        }
        report.all_said();
    }

    std::string input_;
    bool gl_ = false, folds_ = false, limit_ = false, list_fields_ = false, ignored_ = false;
    std::vector<std::string> places_;  // of --at
    RefineArguments refine_;           // of --scheme
    ShareArgument share_;
};

}  // namespace

std::unique_ptr<Verb> make_info_verb(CLI::App& program) {
    return std::make_unique<InfoVerb>(program);
}

}  // namespace subvol::cli
