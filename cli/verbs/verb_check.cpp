// SPDX-License-Identifier: Apache-2.0
// The verb `check`: whether the limit folds, at one step, at all steps of a series and between them, and the mesh that is
// mended.
//
//     mesh ─► verdict of each cell ─► mended mesh
//     steps ─► verdicts of each step ─► and of the time from the step before, where the cells are the same
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

#include "input.h"
#include "mesh_figures.h"
#include "mesh_output.h"
#include "options.h"
#include "outputs.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/cell.h"
#include "subvol/mend_folds.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_series.h"
#include "subvol/option.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class CheckVerb : public Verb {
public:
    explicit CheckVerb(CLI::App& program)
        : Verb(
              program, "check", "Check whether the limit folds: a proof that it does not, or places where it does.",
              "  subvol check part.vtu\n"
              "  subvol check part.vtu --scheme cc --json\n"
              "  subvol check part.vtu --mend -o sound.vtu\n"
              "  subvol check run.pvd --series                  all steps, and all times between them\n"
              "\n"
              "The exit code is 1 if the limit folds. Cells at irregular edges are refined; near the edges those of "
              "mcq stay undecided. Undecided cells are sampled: a negative determinant is a fold, but without one nothing is "
              "proved. "
              "With --mend control points move, as little as it takes, until no regular cell folds; the figures are "
              "then of the mended mesh, whose fields stay with their points.\n"
              "With --series the points move straight from each step to the next, and cells are proved for all times; between "
              "steps nothing is sampled.\n"
              "JSON: verdict (sound, folded or undecided), cells {proved, folded, undecided, irregular: those of the "
              "undecided that are at irregular edges}, undecided_kinds {kind: cells}, open_volume (of undecided cells, in "
              "cells), sampled {cells: that no "
              "test "
              "decided; places; folded: cells with a negative determinant; least: determinant, as a part of the mean}, places, "
              "one for each folded cell: cell, parameters, at, determinant, sampled (found by sampling); with --mend also mend "
              "{folded, open: before; moved, "
              "farthest_edges, boundary_edges, rounds, left: cells with reasons}; with --series verdict, steps and between: a "
              "list "
              "with step (from and to), time (times), and the members above without tests; places between steps have a time.") {
        add_input(app(), "FILE", input_, input_help())->required();
        scheme_.add_scheme_to(app());
        add_options(app(), options_of(options_));
        CLI::Option* mend = add_option(app(), Option("mend", mend_).help("move control points until the limit does not fold"));
        mend->needs(add_option(app(), Option("output", output_)
                                          .also("o")
                                          .help("FILE", "the mended mesh (.vtu, .vtkhdf, .msh, .e, .foam, .inp, .mesh)"))
                        ->needs(mend));
        add_options(app(), options_of(mending_));
        for (const char* name : {"--boundary-move", "--rounds"}) app().get_option(name)->needs(mend);
        CLI::Option* series = add_option(
            app(), Option("series", series_).help("check all steps, or those of --step, and all times between them"));
        series->excludes(mend);
        add_options(app(), options_of(motion_));
        app().get_option("--time-levels")->needs(series);
        set_essentials({"--scheme", "--levels", "--irregular-levels", "--mend", "--series", "--output", "--json"});
    }

    int run(Report& report) override {
        refuse_options(app(), {"--field"}, "has no effect: folds are those of the shape, whatever its fields");
        FoldOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.progress = report.progress();
        options.names = OptionNames::Flags;
        if (mend_) check_output(output_, writable_mesh_extensions());
        report["input"] = input_;
        report.if_long("fewer --irregular-levels");
        if (series_) return check_series(options, report);
        MeshSets sets;
        HexMesh mesh = report.unpack(load_mesh(input_, common(), report.progress(), sets));
        if (mend_) return mend(std::move(mesh), sets, options, report);
        const FoldCheck found = report.timed("check", [&] { return check_folds(mesh, options); });
        put(found, options.scheme.kind, mesh.cells.size(), report);
        return found.report.folded > 0 ? 1 : 0;
    }

private:
    int check_series(const FoldOptions& folds, Report& report) {
        const auto refuse_one = [&] {
            throw Error(ErrorCode::InvalidInput, "it has one step", input_, "a series of steps for --series");
        };
        if (is_model(input_)) refuse_one();
        const MeshSeries series = open_series(input_);
        if (series.size() < 2) refuse_one();
        CommonOptions options = common();
        if (options.read.time)
            throw Error(ErrorCode::InvalidInput, "nothing moves at one time", "--time", "--step 2-5, or all");
        if (!options.step) options.step = "all";
        const FrameRange range = chosen_steps(series, options);
        if (range.count() < 2) throw Error(ErrorCode::InvalidInput, "nothing moves in one step", "--step", "2-5, or all");
        const CommonOptions all = report.unpack(for_steps(input_, options, range, report.progress()));
        FoldMotionOptions motion = motion_;
        motion.folds = folds;
        Json steps = Json::array(), between = Json::array();
        std::optional<HexMesh> before;
        report.begin_series();
        for (int step = range.first; step <= range.last; ++step) {
            report.begin_part("step", static_cast<std::size_t>(step - range.first), static_cast<std::size_t>(range.count()));
            const double time = series.times[static_cast<std::size_t>(step)];
            MeshSets sets;
            HexMesh mesh = report.unpack(load_mesh(input_, of_step(all, step), report.progress(), sets));
            const FoldCheck found = report.timed("check", [&] { return check_folds(mesh, folds); });
            steps.push_back({{"step", step}, {"time", time}});
            add(found, steps.back());
            say(found, text("step ", step, ", time ", time), false, report);
            if (before) {
                const double from = series.times[static_cast<std::size_t>(step) - 1];
                HexMesh after = mesh;
                turn_as(*before, after);
                if (!moved_cells(*before, after)) {
                    report.warn(
                        text("the cells change between the steps ", step - 1, " and ", step, ": nothing is said between them"));
                    any_undecided_ = true;
                } else {
                    if (!same_cells(*before, after)) {
                        report.warn(text("the sharp edges change between the steps ", step - 1, " and ", step,
                                         ": between them those of the first are kept"));
                        after.creases = before->creases;
                        after.sharp_faces = before->sharp_faces;
                    }
                    FoldCheck moving = report.timed("between", [&] { return check_folds_between(*before, after, motion); });
                    for (FoldPlace& at : moving.places) at.time = from + at.time * (time - from);
                    between.push_back({{"from", step - 1}, {"to", step}, {"times", {from, time}}});
                    add(moving, between.back());
                    for (std::size_t k = 0; k < moving.places.size(); ++k)
                        between.back()["places"][k]["time"] = moving.places[k].time;
                    say(moving, text("between ", step - 1, " and ", step), true, report);
                }
            }
            before = std::move(mesh);
        }
        report.end_series();
        report.begin_part("", 0, 0);
        report["verdict"] = any_folded_ ? "folded" : any_undecided_ ? "undecided" : "sound";
        report["steps"] = std::move(steps);
        report["between"] = std::move(between);
        report.say(text("verdict       ", report["verdict"].get<std::string>()));
        report.all_said();
        return any_folded_ ? 1 : 0;
    }

    /// Cells that a reader has turned round in one step alone, where they are left-handed, get their corners in the order of
    /// the step before: they have the same edges.
    static void turn_as(const HexMesh& before, HexMesh& mesh) {
        if (before.points.size() != mesh.points.size() || before.cells.size() != mesh.cells.size()) return;
        for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
            if (edges_of(mesh.cells[c]) == edges_of(before.cells[c])) mesh.cells[c] = before.cells[c];
        }
    }

    static std::array<std::array<Index, 2>, 12> edges_of(const std::array<Index, 8>& cell) {
        std::array<std::array<Index, 2>, 12> edges{};
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const Index a = cell[kCellEdges[e][0]], b = cell[kCellEdges[e][1]];
            edges[e] = {std::min(a, b), std::max(a, b)};
        }
        std::ranges::sort(edges);
        return edges;
    }

    /// The figures of one step, or between two.
    void add(const FoldCheck& found, Json& entry) {
        entry.update(json_of(facts_of(found.report)));
        entry["places"] = places_of(found);
        any_folded_ = any_folded_ || found.report.folded > 0;
        any_undecided_ = any_undecided_ || found.report.open + found.report.irregular > 0;
    }

    static void say(const FoldCheck& found, const std::string& where, bool between, Report& report) {
        const FoldReport& all = found.report;
        std::string line = where + ": ";
        if (all.folded > 0) {
            const FoldPlace& at = found.places.front();
            line += text(counted(all.folded, "cell"), " folded, one of them ", at.cell, " at ", at.position.x, ", ",
                         at.position.y, ", ", at.position.z);
            if (between) line += text(", time ", at.time);
            line += "; ";
        }
        if (all.open + all.irregular > 0) line += text(counted(all.open + all.irregular, "cell"), " undecided; ");
        report.say(line + text(all.proved, " proved"));
    }

    int mend(HexMesh mesh, const MeshSets& sets, const FoldOptions& folds, Report& report) {
        MendOptions options = mending_;
        options.folds = folds;
        const Mended mended = report.timed("mend", [&] { return mend_folds(std::move(mesh), options); });
        report.merge(write_reported(output_, mended.mesh, {}, sets, report.progress()));
        const MendReport& done = mended.report;
        Facts found;
        found["mend"] = facts_of(done);
        report.merge(found);
        report["output"] = output_;
        report.say(text("before        ", counted(done.before.folded, "folded cell"), ", ", done.before.open, " undecided"));
        report.say(text("moved         ", counted(done.moved, "point"), ", at most by ", done.farthest_edges,
                        " of their shortest edge (", done.boundary_edges, " on the boundary)"));
        put(mended.check, folds.scheme.kind, mended.mesh.cells.size(), report);
        constexpr std::size_t kShown = 5;
        for (std::size_t k = 0; k < std::min(kShown, done.left.size()); ++k) {
            report.warn(text("cell ", done.left[k].cell, " could not be mended: ", done.left[k].reason));
        }
        if (done.left.size() > kShown) report.warn(text("nor could ", counted(done.left.size() - kShown, "more cell")));
        return mended.check.report.folded > 0 ? 1 : 0;
    }

    static void put(const FoldCheck& found, Scheme scheme, std::size_t cells, Report& report) {
        const FoldReport& all = found.report;
        report.merge(facts_of(all));
        report["tests"] = all.tests;
        report["places"] = places_of(found);
        say(found, scheme, cells, report);
    }

    static Json places_of(const FoldCheck& found) {
        Json places = Json::array();
        for (const FoldPlace& at : found.places) {
            places.push_back(Json{{"cell", at.cell},
                                  {"parameters", {at.uvw.x, at.uvw.y, at.uvw.z}},
                                  {"at", {at.position.x, at.position.y, at.position.z}},
                                  {"determinant", at.determinant},
                                  {"sampled", at.sampled}});
        }
        return places;
    }

    static void say(const FoldCheck& found, Scheme scheme, std::size_t cells, Report& report) {
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
            line(k == 0 ? "folded" : "",
                 text("cell ", at.cell, " at ", at.position.x, ", ", at.position.y, ", ", at.position.z, " (determinant ",
                      at.determinant, at.sampled ? ", found to fold by sampling)" : ")"));
        }
        if (all.folded > kShown) line("", text("and ", counted(all.folded - kShown, "more cell")));
        if (all.open > 0) {
            line("undecided", text(counted(all.open, "cell"), ", of which the volume of ", all.open_volume,
                                   " cells is open (more --levels or --tests decide more)"));
        }
        if (all.irregular > 0) {
            line("irregular",
                 text(counted(all.irregular, "cell"), " near irregular edges, of which the volume of ", all.irregular_volume,
                      " cells is open", scheme == Scheme::Mcq ? "; only limits of cc and bsxw are decided there" : ""));
        }
        if (all.sampled.cells > 0) line("sampled", text(counted(all.sampled.cells, "undecided cell"), ": ", sample_text(all)));
        line("verdict", report["verdict"].get<std::string>());
        report.all_said();
    }

    std::string input_, output_;
    RefineArguments scheme_;
    FoldOptions options_;
    MendOptions mending_;
    FoldMotionOptions motion_;
    bool mend_ = false, series_ = false;
    bool any_folded_ = false, any_undecided_ = false;  // of a series
};

}  // namespace

std::unique_ptr<Verb> make_check_verb(CLI::App& program) {
    return std::make_unique<CheckVerb>(program);
}

}  // namespace subvol::cli
