// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>

#include "input.h"
#include "options.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "subvol/certificate.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class CheckVerb : public Verb {
public:
    explicit CheckVerb(CLI::App& program)
        : Verb(program, "check", "Check whether the limit folds: a proof that it does not, or places where it does.",
               "  subvol check part.vtu\n"
               "  subvol check part.vtu --scheme cc --json\n"
               "\n"
               "The exit code is 1 if the limit folds. Cells at irregular edges are refined; near the edges they stay "
               "undecided.\n"
               "JSON: verdict (sound, folded or undecided), cells {proved, folded, undecided, irregular: those of the "
               "undecided that are at irregular edges}, open_volume (of undecided cells, in cells), places, one for each "
               "folded cell: cell, parameters, at, determinant.") {
        app().add_option("FILE", input_, input_help())->required();
        scheme_.add_scheme_to(app());
        add_options(app(), options_of(options_));
        set_essentials({"--scheme", "--levels", "--irregular-levels", "--json"});
    }

    int run(Report& report) override {
        FoldOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.progress = report.progress();
        options.names = OptionNames::Flags;
        report["input"] = input_;
        report.if_long("fewer --irregular-levels");
        const HexMesh mesh = report.unpack(load_mesh(input_, common(), report.progress()));
        const FoldCheck found = report.timed("check", [&] { return check_folds(mesh, options); });
        put(found, mesh.cells.size(), report);
        return found.report.folded > 0 ? 1 : 0;
    }

private:
    static void put(const FoldCheck& found, std::size_t cells, Report& report) {
        const FoldReport& all = found.report;
        const std::size_t undecided = all.open + all.irregular;
        report["verdict"] = all.folded > 0 ? "folded" : undecided > 0 ? "undecided" : "sound";
        report["cells"] =
            Json{{"proved", all.proved}, {"folded", all.folded}, {"undecided", undecided}, {"irregular", all.irregular}};
        report["open_volume"] = all.open_volume + all.irregular_volume;
        report["tests"] = all.tests;
        Json places = Json::array();
        for (const FoldPlace& at : found.places) {
            places.push_back(Json{{"cell", at.cell},
                                  {"parameters", {at.uvw.x, at.uvw.y, at.uvw.z}},
                                  {"at", {at.position.x, at.position.y, at.position.z}},
                                  {"determinant", at.determinant}});
        }
        report["places"] = std::move(places);
        say(found, cells, report);
    }

    static void say(const FoldCheck& found, std::size_t cells, Report& report) {
        const FoldReport& all = found.report;
        const auto line = [&](std::string name, const std::string& value) {
            constexpr std::size_t kNames = 14;
            name.resize(kNames, ' ');
            report.say(name + value);
        };
        line("proved", text(all.proved, " of ", counted(cells, "cell"), " proved not to fold"));
        constexpr std::size_t kShown = 5;
        for (std::size_t k = 0; k < std::min(kShown, found.places.size()); ++k) {
            const FoldPlace& at = found.places[k];
            line(k == 0 ? "folded" : "", text("cell ", at.cell, " at ", at.position.x, ", ", at.position.y, ", ", at.position.z,
                                              " (determinant ", at.determinant, ")"));
        }
        if (all.folded > kShown) line("", text("and ", counted(all.folded - kShown, "more cell")));
        if (all.open > 0) {
            line("undecided", text(counted(all.open, "cell"), ", of which the volume of ", all.open_volume,
                                   " cells is open (more --levels or --tests decide more)"));
        }
        if (all.irregular > 0) {
            line("irregular", text(counted(all.irregular, "cell"), " near irregular edges, of which the volume of ",
                                   all.irregular_volume, " cells is open"));
        }
        line("verdict", report["verdict"].get<std::string>());
        report.all_said();
    }

    std::string input_;
    RefineArguments scheme_;
    FoldOptions options_;
};

}  // namespace

std::unique_ptr<Verb> make_check_verb(CLI::App& program) {
    return std::make_unique<CheckVerb>(program);
}

}  // namespace subvol::cli
