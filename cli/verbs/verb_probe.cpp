// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "body_input.h"
#include "common_options.h"
#include "input.h"
#include "mesh_figures.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "places_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "report.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/measure.h"
#include "subvol/mesh_io.h"
#include "subvol/mixed_probe.h"
#include "subvol/plot.h"
#include "subvol/probe.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// The block of each cell of a mesh, as a number among `names`. Both are empty if the mesh has fewer than two blocks.
struct BlockCells {
    std::vector<Index> groups;
    std::vector<std::string> names;
};

/// The sum of a cell's corners and one corner, which are the same wherever the cell is read.
using Key = std::array<double, 6>;

Key key_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    Vec3 sum(0.0);
    for (const Index p : cell) sum += mesh.points[p];
    const Vec3& first = mesh.points[cell[0]];
    return {sum.x, sum.y, sum.z, first.x, first.y, first.z};
}

/// Reads the blocks of the input one by one, and looks for their cells in the mesh. Cells that are in no block, such as curved
/// ones that are split in another way alone, belong to one more part, "(others)", with a warning.
WithFacts<BlockCells> cells_of_blocks(const std::string& input, const std::vector<MeshBlock>& blocks, const HexMesh& mesh,
                                      const CommonOptions& options) {
    WithFacts<BlockCells> result;
    BlockCells& found = result.value;
    if (blocks.size() < 2) return result;
    std::map<Key, Index> cells;
    for (Index c = 0; c < mesh.cells.size(); ++c) cells.emplace(key_of(mesh, mesh.cells[c]), c);
    const auto others = static_cast<Index>(blocks.size());
    found.groups.assign(mesh.cells.size(), others);
    for (Index b = 0; b < blocks.size(); ++b) {
        found.names.push_back(blocks[b].name);
        CommonOptions one = options;
        one.read.blocks = {blocks[b].name};
        const HexMesh part = read_input(input, one, nullptr).value.mesh;
        for (const auto& cell : part.cells) {
            const auto at = cells.find(key_of(part, cell));
            if (at != cells.end()) found.groups[at->second] = b;
        }
    }
    const auto lost = static_cast<std::size_t>(std::count(found.groups.begin(), found.groups.end(), others));
    if (lost > 0) {
        found.names.emplace_back("(others)");
        result.facts.warn(text(counted(lost, "cell"), " could not be assigned to a block"));
    }
    return result;
}

constexpr std::size_t kMostLines = 30;  // places that people see; the others are in files

/// One number, or an array of the channels.
template <class Value>
Json each_channel(const ProbedField& field, const Value& value) {
    if (field.channels == 1) return value(0);
    Json all = Json::array();
    for (std::size_t c = 0; c < field.channels; ++c) all.push_back(value(c));
    return all;
}

Json as_json(const ProbeResult& found, std::size_t p, const Vec3& at) {
    Json one;
    one["at"] = json_of(at);
    one["inside"] = found.inside(p);
    if (!found.inside(p)) {
        for (const char* key : {"value", "gradient", "cell", "parameters", "fields"}) one[key] = nullptr;
        return one;
    }
    const auto value = [&](const ProbedField& field) {
        return each_channel(field, [&](std::size_t c) -> Json { return field.values[p * field.channels + c]; });
    };
    const auto gradient = [&](const ProbedField& field) {
        return each_channel(field, [&](std::size_t c) { return json_of(field.gradients[p * field.channels + c]); });
    };
    one["value"] = value(found.fields.front());
    one["gradient"] = gradient(found.fields.front());
    one["cell"] = found.cells[p];
    one["parameters"] = found.parameters.empty() ? Json() : json_of(found.parameters[p]);
    for (const ProbedField& field : found.fields) {
        one["fields"][field.name] = {{"value", value(field)}, {"gradient", gradient(field)}};
    }
    return one;
}

void say(const ProbeResult& found, const std::vector<Vec3>& places, Report& report) {
    using detail::number_text;
    Lines lines;
    for (std::size_t p = 0; p < std::min(places.size(), kMostLines); ++p) {
        std::string words = found.inside(p) ? "" : "outside";
        if (found.inside(p)) {
            for (const ProbedField& field : found.fields) {
                words += (words.empty() ? "" : "  ") + field.name + " ";
                for (std::size_t c = 0; c < field.channels; ++c) {
                    words += (c == 0 ? "" : ",") + number_text(field.values[p * field.channels + c]);
                }
            }
            words += text("  (cell ", found.cells[p], ")");
        }
        const Vec3& x = places[p];
        lines.emplace_back(number_text(x.x) + "," + number_text(x.y) + "," + number_text(x.z), words);
    }
    report.say(aligned(lines));
    if (places.size() > kMostLines) {
        report.say(text("and ", count_text(places.size() - kMostLines), " more (--json or -o FILE.csv has all)"));
    }
    report.all_said();
}

std::string quoted(const std::string& name) {
    if (name.find_first_of(",\"\n") == std::string::npos) return name;
    std::string words = "\"";
    for (const char c : name) words += c == '"' ? std::string("\"\"") : std::string(1, c);
    return words + "\"";
}

void write_csv(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file) {
    using detail::exact_text;
    std::string table = "x,y,z,inside,cell,u,v,w";
    for (const ProbedField& field : found.fields) {
        for (std::size_t c = 0; c < field.channels; ++c) {
            const std::string name = field.name + (field.channels > 1 ? text(".", c) : "");
            for (const char* end : {"", "_dx", "_dy", "_dz"}) table += "," + quoted(detail::printable(name + end));
        }
    }
    table += "\n";
    const auto put = [&](const Vec3& v) { table += exact_text(v.x) + "," + exact_text(v.y) + "," + exact_text(v.z); };
    for (std::size_t p = 0; p < places.size(); ++p) {
        put(places[p]);
        table += found.inside(p) ? text(",1,", found.cells[p], ",") : ",0,,";
        if (found.inside(p) && !found.parameters.empty()) {
            put(found.parameters[p]);
        } else {
            table += ",,";
        }
        for (const ProbedField& field : found.fields) {
            for (std::size_t c = 0; c < field.channels; ++c) {
                table += found.inside(p) ? "," + exact_text(field.values[p * field.channels + c]) + "," : ",,,,";
                if (found.inside(p)) put(field.gradients[p * field.channels + c]);
            }
        }
        table += "\n";
    }
    detail::write_text_file(file, table);
}

/// The chosen field over the distance from the line's first end, with gaps where the line is outside.
void write_plot(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file) {
    const ProbedField& field = found.fields.front();
    PlotLine line{field.name, {}, {}};
    bool gap = false;
    for (std::size_t p = 0; p < places.size(); ++p) {
        if (!found.inside(p)) {
            gap = true;
            continue;
        }
        if (gap && !line.x.empty()) line.breaks.push_back(line.x.size());
        gap = false;
        line.x.push_back(glm::distance(places[p], places.front()));
        line.y.push_back(field.values[p * field.channels]);
    }
    if (line.x.empty()) throw Error(ErrorCode::InvalidInput, "all of the line is outside the volume", "--line");
    detail::write_text_file(file, plot_svg_file({.title = "",
                                                 .x_label = "distance along the line",
                                                 .y_label = field.name,
                                                 .log_x = false,
                                                 .log_y = false,
                                                 .lines = {line}}));
}

Json as_json(const PartMeasure& part) {
    Json one;
    if (!part.name.empty()) one["name"] = part.name;
    one["cells"] = part.cells;
    one["volume"] = part.volume;
    one["error"] = part.error;
    one["fields"] = Json::array();
    for (const FieldMeasure& field : part.fields) {
        one["fields"].push_back({{"name", field.name},
                                 {"integral", field.integral},
                                 {"mean", field.mean},
                                 {"min", field.min.value},
                                 {"min_at", json_of(field.min.place)},
                                 {"min_cell", field.min.cell},
                                 {"max", field.max.value},
                                 {"max_at", json_of(field.max.place)},
                                 {"max_cell", field.max.cell},
                                 {"extreme_error", field.extreme_error},
                                 {"histogram", field.histogram}});
    }
    return one;
}

void say(const PartMeasure& part, const std::string& name, Report& report) {
    using detail::number_text;
    Lines lines{{"volume", number_text(part.volume) + "  within " + number_text(part.error, 2) + " of it"}};
    if (!name.empty()) lines.insert(lines.begin(), {"block", text(name, " (", counted(part.cells, "cell"), ")")});
    for (const FieldMeasure& field : part.fields) {
        const auto at = [](const LimitExtreme& extreme) {
            const Vec3& x = extreme.place;
            return number_text(extreme.value) + " at " + number_text(x.x, 4) + "," + number_text(x.y, 4) + "," +
                   number_text(x.z, 4);
        };
        lines.emplace_back(field.name, "mean " + number_text(field.mean) + "  integral " + number_text(field.integral));
        lines.emplace_back("", "min " + at(field.min) + "  max " + at(field.max));
    }
    report.say(aligned(lines));
}

/// NaN is null in JSON, so it is said.
void warn_of_overflow(const PartMeasure& part, Report& report) {
    for (const FieldMeasure& field : part.fields) {
        if (std::isfinite(field.integral) && std::isfinite(field.mean)) continue;
        report.warn(text("the integral of ", field.name, " is larger than a number can be"));
    }
}

/// Places that were probed: into the report, and into a table (.csv) or a plot of the first field over the distance (.svg).
///
/// file: empty: none
/// json: whether the report gets the values of all places
void show_probed(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file, bool json,
                 Report& report) {
    std::size_t inside = 0;
    for (std::size_t p = 0; p < places.size(); ++p) inside += found.inside(p) ? 1 : 0;
    report["places"] = places.size();
    report["inside"] = inside;
    Json values = Json::array();
    if (json) {
        for (std::size_t p = 0; p < places.size(); ++p) values.push_back(as_json(found, p, places[p]));
        report["values"] = std::move(values);
    }
    say(found, places, report);
    if (inside < places.size()) {
        report.note(
            text(count_text(places.size() - inside), " of ", counted(places.size(), "place"), " lie outside the volume"));
    }
    if (file.ends_with(".csv")) write_csv(found, places, file);
    if (file.ends_with(".svg")) write_plot(found, places, file);
}

/// Integrals and extremes, into the report.
void show_measured(const LimitMeasure& found, Report& report) {
    report["stats"] = {{"whole", as_json(found.whole)}, {"parts", Json::array()}, {"pieces", found.pieces}};
    for (const PartMeasure& part : found.parts) report["stats"]["parts"].push_back(as_json(part));
    warn_of_overflow(found.whole, report);
    say(found.whole, "", report);
    for (const PartMeasure& part : found.parts) say(part, part.name, report);
    report.all_said();
}

class ProbeVerb : public Verb {
public:
    explicit ProbeVerb(CLI::App& program)
        : Verb(program, "probe", "Evaluate the limit at points or along a line, or integrate it.",
               "  subvol probe part.vtu --at 0.1,0.2,0.3 --at 1,0,0\n"
               "  subvol probe part.vtu --line -1,0,0,1,0,0 --count 500 -o line.svg\n"
               "  subvol probe part.vtu --points bolts.csv -o values.csv --json\n"
               "  subvol probe part.vtu --stats --field Temp\n"
               "\n"
               "JSON: values, one for each place: at, inside, value and gradient of the chosen field, cell, parameters, "
               "fields with value and gradient of each. Outside there is nothing: null. stats: whole and parts, with "
               "volume, error (of the volume and of means, in parts of them and of ranges), and for each field, or for "
               "the one that --field names, integral, mean, min, max, their places, extreme_error, and a histogram.") {
        app().add_option("FILE", input_, input_help())->required();
        app()
            .add_option("--at", at_, "a place in world units (repeatable)")
            ->type_name("X,Y,Z")
            ->transform(number_list(3, "1,2,3"))
            ->allow_extra_args(false);
        app()
            .add_option("--line", line_, "places on a line, from its first end to its second")
            ->type_name("X0,Y0,Z0,X1,Y1,Z1")
            ->transform(number_list(6, "0,0,0,1,1,1: its two ends"));
        add_option(app(),
                   Option("count", count_).between(2, 10000000).help("N", "how many places on the line").only_with("line"));
        app().add_option("--points", points_, "a table of places: three numbers a line, or columns x, y, z")->type_name("FILE");
        app().add_flag("--stats", stats_, "integral, mean, extremes with their places, histogram; by block too");
        add_option(app(), options_of(measured_).back().only_with("stats"));
        app()
            .add_option("-o,--output", output_, "a table of all fields (.csv), or a plot along the line (.svg)")
            ->type_name("FILE");
        scheme_.add_to(app(), "tetoct, boxspline: the level whose volume is probed (default 2)");
        set_essentials({"--at", "--line", "--count", "--points", "--stats", "--output", "--field", "--json"});
    }

    int run(Report& report) override {
        const std::vector<Vec3> places = collect_places();
        check_outputs();
        const TetRefinement tets(scheme_);
        if (scheme_.levels) {
            throw Error(ErrorCode::InvalidInput, "the limit of " + scheme_.scheme + " is probed, not a level", "--levels",
                        "--scheme tetoct or boxspline, whose volume is that of a level");
        }
        const LimitOptions limit{.scheme = scheme_.options(0, report.progress()).scheme, .progress = report.progress()};
        report["input"] = input_;
        BodyInput body = report.unpack(open_body(input_, common(), app(), report.progress()));
        // Places have all fields; a field that is named for statistics is measured alone.
        const bool alone = places.empty() && (common().field || common().density);
        (void)report.unpack(body.select(common(), alone ? OtherFields::Drop : OtherFields::Keep));
        report["cells"] = body.source().cells();
        if (tets.asked()) {
            probe_tets(tets, body.mesh_for(tets), places, report);
            if (stats_ && body.blocks.size() > 1) report.warn("tetoct and boxspline measure the whole, not its blocks");
        } else {
            if (!places.empty()) probe(body.source(), places, limit, report);
            if (stats_) measure(body, limit.scheme, report);
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
        if (places.empty() && !stats_) {
            throw Error(ErrorCode::InvalidInput, "nothing is asked for", "probe", "--at, --line, --points or --stats");
        }
        return places;
    }

    void check_outputs() const {
        if (output_.empty()) return;
        check_output(output_, {".csv", ".svg"});
        if (output_.ends_with(".svg") && (line_.empty() || !at_.empty() || !points_.empty())) {
            throw Error(ErrorCode::InvalidInput, "a plot needs --line, and no other places", output_, "a .csv file takes all");
        }
        if (stats_ && line_.empty() && at_.empty() && points_.empty()) {
            throw Error(ErrorCode::InvalidInput, "a file of places needs --at, --line or --points", output_,
                        "--stats prints, with --json in full");
        }
    }

    void probe(const MeshSource& source, const std::vector<Vec3>& places, const LimitOptions& limit, Report& report) const {
        const ProbeResult found =
            report.timed("probe", [&] { return probe_limit(source, places, {.limit = limit}, report.progress()); });
        show_probed(found, places, output_, common().json, report);
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
            show_probed(found, places, output_, common().json, report);
        }
        if (!stats_) return;
        show_measured(
            report.timed("measure",
                         [&] { return measure_limit(fine, cells, {.bins = measured_.bins, .progress = report.progress()}); }),
            report);
    }

    void measure(const BodyInput& body, const SchemeOptions& scheme, Report& report) const {
        const MeshSource source = body.source();
        BlockCells parts;
        if (source.mesh() != nullptr) {
            parts = report.unpack(
                report.timed("blocks", [&] { return cells_of_blocks(input_, body.blocks, *source.mesh(), common()); }));
        }
        const LimitMeasure found = report.timed("measure", [&] {
            return measure_limit(source, {.scheme = scheme,
                                          .bins = measured_.bins,
                                          .groups = parts.groups,
                                          .names = parts.names,
                                          .progress = report.progress()});
        });
        show_measured(found, report);
    }

    std::string input_, line_, points_, output_;
    std::vector<std::string> at_;
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
