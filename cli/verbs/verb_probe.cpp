// SPDX-License-Identifier: Apache-2.0
// The verb `probe`: it evaluates the limit. Three kinds of questions can be asked of one body:
//
//     places    values, gradients, cell and parameters at points, along a line, or at the rows of a table
//     stats     integrals, means, extremes and a histogram, of the whole and of each block and set
//     patches   area and means over parts of the boundary, and the flow of a vector field out through them
//
// Regions of --only that choose whole cells are taken as flags of cells in the whole mesh, so that the limit stays that of the
// whole; regions of space are cut out of the limit itself. With a scheme of tetrahedra the volume is that of a refined level,
// linear between its vertices. Of a series, one of these questions is asked at each step, and a table shows the answers over
// time.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "body_input.h"
#include "common_options.h"
#include "input.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "places_input.h"
#include "probe_output.h"
#include "probe_series.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/error.h"
#include "subvol/hex_mesh.h"
#include "subvol/measure.h"
#include "subvol/mesh_io.h"
#include "subvol/mixed_probe.h"
#include "subvol/option.h"
#include "subvol/part_places.h"
#include "subvol/patch_measure.h"
#include "subvol/probe.h"
#include "subvol/quantity.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// The parts of a mesh that are measured beside the whole: its blocks in the order of the file, its other sets, and "(others)"
/// where cells are in none of them. None if a block or set is the whole.
///
/// chosen: a flag for each cell that is measured; empty: all
std::vector<CellSet> parts_of(const std::vector<MeshBlock>& blocks, const std::vector<CellSet>& sets,
                              const std::vector<std::uint8_t>& chosen, std::size_t cells) {
    std::vector<CellSet> parts;
    std::vector<std::uint8_t> in_part(cells, 0);
    const auto all = chosen.empty() ? cells : static_cast<std::size_t>(std::ranges::count(chosen, 1));
    for (const CellSet& set : sets) {
        if (set.cells.empty()) continue;
        parts.push_back(set);
        for (const Index cell : set.cells) in_part[cell] = 1;
    }
    const auto place = [&](const CellSet& set) {
        return std::ranges::find(blocks, set.name, &MeshBlock::name) - blocks.begin();
    };
    std::ranges::stable_sort(parts, {}, place);
    if (parts.empty() || (parts.size() == 1 && parts.front().cells.size() == all)) return {};
    CellSet others{"(others)", {}};
    for (Index cell = 0; cell < cells; ++cell) {
        if (in_part[cell] == 0 && (chosen.empty() || chosen[cell] != 0)) others.cells.push_back(cell);
    }
    if (!others.cells.empty()) parts.push_back(std::move(others));
    return parts;
}

class ProbeVerb : public Verb {
public:
    explicit ProbeVerb(CLI::App& program)
        : Verb(program, "probe", "Evaluate the limit at points or along a line, or integrate it.",
               "  subvol probe part.vtu --at 0.1,0.2,0.3 --at 1,0,0\n"
               "  subvol probe part.vtu --line -1,0,0,1,0,0 --count 500 -o line.svg\n"
               "  subvol probe part.vtu --line 0,0,0,1,0,0 --field T --field U.x -o two.svg\n"
               "  subvol probe part.vtu --points bolts.csv -o values.csv --json\n"
               "  subvol probe part.vtu --stats --field 'mises(STRESS)' --only box:0,0,0,1,1,2\n"
               "  subvol probe part.vtu --stats --field T --bins 50 -o histogram.svg\n"
               "  subvol probe run.exo --at 0,0,1 --step all -o history.csv\n"
               "  subvol probe case --patch inlet --patch outlet --flux U\n"
               "\n"
               "JSON: values, one for each place: at, inside, value and gradient of the chosen field, cell, parameters, "
               "fields with value and gradient of each. Outside there is nothing: null. stats: folded_cells as far as seen, "
               "whole and parts, with "
               "volume, error (of the volume and of means, in parts of them and of ranges), and for each field, or for "
               "the one that --field names, integral, mean, min, max, their places, extreme_error, and a histogram (volumes; "
               "of the "
               "whole with histogram_edges); with file_ "
               "before the name the same of the cells as the file has them. With "
               "--step all or A-B: steps, each with step, time and values, stats or patches. patches: name, faces, area, "
               "error, normal (its integral), flux and throughput (of --flux, outward and without sign), fields with "
               "integral, mean, min, max, extreme_error; flux_sum of several.",
               Reads::SeveralFields) {
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(app(), Option("at", at_).help("X,Y,Z", "a place in world units (repeatable)"))
            ->transform(number_list(3, "1,2,3"));
        add_option(app(), Option("line", line_).help("X0,Y0,Z0,X1,Y1,Z1", "places on a line, from its first end to its second"))
            ->transform(number_list(6, "0,0,0,1,1,1: its two ends"));
        add_option(app(),
                   Option("count", count_).between(2, 10000000).help("N", "how many places on the line").only_with("line"));
        add_option(app(),
                   Option("points", points_).help("FILE", "a table of places: three numbers a line, or columns x, y, z"));
        add_option(
            app(),
            Option("stats", stats_).help("integral, mean, extremes with their places, histogram; of each block and set, too"));
        add_option(app(), options_of(measured_).back().only_with("stats"));
        add_option(app(),
                   Option("patch", patches_)
                       .help("NAME", "area and means over a patch of the boundary, as info lists them; all (repeatable)"));
        add_option(app(),
                   Option("flux", flux_).help("EXPR", "the flow of this vector out through the patches").only_with("patch"));
        add_option(app(), Option("output", output_)
                              .also("o")
                              .help("FILE",
                                    "a table (.csv) of all fields with gradients, or of the values of --field; or a plot along "
                                    "the line (.svg); of --stats the histogram"));
        scheme_.add_to(app(), "tetoct, boxspline: the level whose volume is probed (default 2)");
        set_essentials(
            {"--at", "--line", "--count", "--points", "--stats", "--patch", "--flux", "--output", "--field", "--json"});
    }

    int run(Report& report) override {
        const std::vector<Vec3> places = collect_places();
        check_outputs();
        const TetRefinement tets(scheme_);
        if (scheme_.levels) {
            throw Error(ErrorCode::InvalidInput, "the limit of " + scheme_.scheme + " is probed, not a level", "--levels",
                        "--scheme tetoct or boxspline, whose volume is that of a level");
        }
        const int kinds = (places.empty() ? 0 : 1) + (stats_ ? 1 : 0) + (patches_.empty() ? 0 : 1);
        if (asks_for_steps(common()) && (kinds > 1 || tets.asked())) {
            throw Error(ErrorCode::InvalidInput, "a table of steps is about places, patches or the whole of hexahedra",
                        "--step", "either --stats, or --patch, or --at, --line and --points");
        }
        const LimitOptions limit{.scheme = scheme_.options(0, report.progress()).scheme, .progress = report.progress()};
        report["input"] = input_;
        CommonOptions reading = with_whole_cells(common(), regions_);
        reading.parts_in_whole = !tets.asked();
        if (!patches_.empty() && (tets.asked() || !regions_.empty())) {
            throw Error(ErrorCode::InvalidInput, "patches are those of the limit of hexahedra, of whole cells", "--patch",
                        "--only block:, set:, nodes:, fold: or where:, and no scheme of tetrahedra");
        }
        if (!flux_.empty()) reading.at_rest.push_back(flux_);
        if (regions_.size() < regions_of(common()).size() && stats_)
            report.note("whole cells are measured where a quantity, a set or a verdict decides");
        if (asks_for_steps(common())) {
            probe_steps(reading, places, limit, report);
        } else {
            const BodyInput body = open(reading, places, report);
            report["cells"] =
                body.in_part.empty() ? body.source().cells() : static_cast<std::uint64_t>(std::ranges::count(body.in_part, 1));
            if (tets.asked()) {
                if (!regions_.empty()) {
                    throw Error(ErrorCode::InvalidInput, "is cut from the limit of hexahedra",
                                "--only " + regions_.front().text(),
                                "block:, set:, nodes:, fold: or where:, which choose whole cells");
                }
                probe_tets(tets, body.mesh_for(tets), places, report);
                if (stats_ && body.sets.sets.size() > 1) report.warn("tetoct and boxspline measure the whole, not its parts");
            } else {
                if (!places.empty())
                    show_probed(probe(body, places, limit, report), places, chosen_, output_, common(), report);
                if (stats_) {
                    show_measured(measure(body, limit.scheme, report), body.source().mesh(), !is_model(input_),
                                  histogram_file(), report);
                }
                if (!patches_.empty()) {
                    const std::vector<PatchMeasure> found = patches_of(body, limit.scheme, report);
                    show_patches(found, *body.source().mesh(), !is_model(input_), report);
                }
            }
        }
        if (!output_.empty()) report["output"] = output_;
        return 0;
    }

private:
    [[nodiscard]] std::vector<Vec3> collect_places() const {
        std::vector<Vec3> places;
        for (const std::string& at : at_) places.push_back(parse_vector("--at", at));
        if (!line_.empty()) {
            const auto ends = parse_numbers("--line", line_, 6, "0,0,0,1,1,1");
            const auto more = places_on_line({ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}, count_);
            places.insert(places.end(), more.begin(), more.end());
        }
        if (!points_.empty()) {
            const auto more = read_places(points_);
            places.insert(places.end(), more.begin(), more.end());
        }
        if (places.empty() && !stats_ && patches_.empty()) {
            throw Error(ErrorCode::InvalidInput, "nothing is asked for", "probe", "--at, --line, --points, --stats or --patch");
        }
        return places;
    }

    void check_outputs() const {
        if (output_.empty()) return;
        check_output(output_, {".csv", ".svg"});
        if (asks_for_steps(common())) return;
        if (!histogram_file().empty()) return;
        if (output_.ends_with(".svg") && (line_.empty() || !at_.empty() || !points_.empty())) {
            throw Error(ErrorCode::InvalidInput, "a plot needs --line, and no other places", output_, "a .csv file takes all");
        }
        if (line_.empty() && at_.empty() && points_.empty()) {
            throw Error(ErrorCode::InvalidInput, "a file of places needs --at, --line or --points", output_,
                        "--patch prints, with --json in full; with --step all there is a table");
        }
    }

    /// The output, if it is that of histograms: places have a table or a plot of their own.
    [[nodiscard]] std::string histogram_file() const {
        return stats_ && patches_.empty() && line_.empty() && at_.empty() && points_.empty() ? output_ : "";
    }

    /// The body with the field of --field first.
    [[nodiscard]] BodyInput open(const CommonOptions& options, const std::vector<Vec3>& places, Report& report) {
        BodyInput body = report.unpack(open_body(input_, options, app(), report.progress()));
        if (!flux_.empty()) flux_vectors_ = flow_of(body);
        // Places have all fields; a field that is named for statistics is measured alone.
        const bool alone = places.empty() && (common().field || common().density);
        (void)report.unpack(body.select(options, alone ? OtherFields::Drop : OtherFields::Keep));
        if (common().field) chosen_ = body.selected();
        return body;
    }

    void probe_steps(const CommonOptions& options, const std::vector<Vec3>& places, const LimitOptions& limit, Report& report) {
        const MeshSeries series = open_series(input_);
        const FrameRange range = chosen_steps(series, options);
        const CommonOptions all = report.unpack(for_steps(input_, options, range, report.progress()));
        std::vector<ProbedStep> steps;
        StepsWithFields taken(report);
        for (int step = range.first; step <= range.last; ++step) {
            const auto number = static_cast<std::size_t>(step);
            report.begin_part("step", number - static_cast<std::size_t>(range.first), static_cast<std::size_t>(range.count()));
            taken.take(step, [&] {
                const BodyInput body = open(of_step(all, step), places, report);
                ProbedStep& found = steps.emplace_back(ProbedStep{number, series.times[number], {}, {}});
                if (stats_) {
                    found.measure = measure(body, limit.scheme, report);
                } else if (!patches_.empty()) {
                    found.patches = patches_of(body, limit.scheme, report);
                } else {
                    found.places = probe(body, places, limit, report);
                }
            });
        }
        taken.finish();
        report.begin_part("", 0, 0);
        show_steps(steps, places, chosen_, output_, common(), report);
    }

    /// The field whose flow is asked for, before others take its name.
    [[nodiscard]] Attribute flow_of(const BodyInput& body) const {
        const HexMesh* mesh = body.source().mesh();
        if (mesh == nullptr) throw Error(ErrorCode::InvalidInput, "bricks have no patches", "--flux", "the mesh itself");
        return of_option("--flux", [&] { return vector_field_of(*mesh, flux_, common().listener); });
    }

    [[nodiscard]] std::vector<PatchMeasure> patches_of(const BodyInput& body, const SchemeOptions& scheme,
                                                       Report& report) const {
        const HexMesh* mesh = body.source().mesh();
        if (mesh == nullptr) throw Error(ErrorCode::InvalidInput, "bricks have no patches", "--patch", "the mesh itself");
        const std::vector<Patch> patches = patches_of_option(*mesh, body.sets, patches_);
        return report.timed("patches", [&] {
            return measure_patches(*mesh, patches,
                                   {.scheme = scheme, .flux_field = flux_vectors_, .progress = report.progress()});
        });
    }

    [[nodiscard]] ProbeResult probe(const BodyInput& body, const std::vector<Vec3>& places, const LimitOptions& limit,
                                    Report& report) const {
        ProbeResult found =
            report.timed("probe", [&] { return probe_limit(body.source(), places, {.limit = limit}, report.progress()); });
        for (std::size_t p = 0; p < places.size(); ++p) {
            if (depth(regions_, places[p]) < 0) found.cells[p] = kNone;
        }
        if (!body.in_part.empty()) keep_places_in(*body.source().mesh(), body.in_part, found);
        return found;
    }

    /// The volume of a scheme of tetrahedra: linear between the vertices of a level, which are on the limit.
    void probe_tets(const TetRefinement& tets, const HexMesh& mesh, const std::vector<Vec3>& places, Report& report) const {
        std::vector<Index> cells;
        const MixedMesh fine = report.unpack(tets.refined(mesh, 2, Vertices::OnTheLimit, report.progress(), &cells));
        const std::size_t hexes = 4 * fine.tets.size() + 16 * fine.octahedra.size();  // of others it is as many as they are
        check_memory(report.json().at("levels").get<int>(), static_cast<double>(hexes), 1700);
        if (!places.empty()) {
            const auto probe = report.timed("prepare", [&] { return MixedProbe(fine, cells, 0, report.progress()); });
            const ProbeResult found = report.timed("probe", [&] { return probe.at(places, report.progress()); });
            show_probed(found, places, chosen_, output_, common(), report);
        }
        if (!stats_) return;
        const LimitMeasure measured = report.timed(
            "measure", [&] { return measure_limit(fine, cells, {.bins = measured_.bins, .progress = report.progress()}); });
        show_measured(measured, nullptr, false, histogram_file(), report);
    }

    [[nodiscard]] LimitMeasure measure(const BodyInput& body, const SchemeOptions& scheme, Report& report) const {
        const MeshSource source = body.source();
        std::vector<CellSet> parts;
        if (source.mesh() != nullptr)
            parts = report.timed(
                "blocks", [&] { return parts_of(body.blocks, body.sets.sets, body.in_part, source.mesh()->cells.size()); });
        const MeasureOptions asked{
            .scheme = scheme, .bins = measured_.bins, .sets = parts, .cells = body.in_part, .progress = report.progress()};
        return report.timed("measure", [&] {
            return regions_.empty() ? measure_limit(source, asked) : measure_limit_in(*source.mesh(), regions_, asked);
        });
    }

    std::string input_, line_, points_, output_, flux_;
    std::vector<std::string> at_, patches_;
    std::vector<std::string> chosen_{};  // the fields of --field, by the names that they have; empty: all
    std::optional<Attribute> flux_vectors_;
    std::vector<Region> regions_;  // of --only: the parts of space
    std::size_t count_ = 200;
    MeasureOptions measured_;
    bool stats_ = false;
    RefineArguments scheme_;
};

}  // namespace

std::unique_ptr<Verb> make_probe_verb(CLI::App& program) {
    return std::make_unique<ProbeVerb>(program);
}

}  // namespace subvol::cli
