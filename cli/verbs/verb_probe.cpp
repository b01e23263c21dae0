// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>

#include "block_cells.h"
#include "bricks_input.h"
#include "input.h"
#include "outputs.h"
#include "places_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "subvol/brick_measure.h"
#include "subvol/brick_probe.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/measure.h"
#include "subvol/plot.h"
#include "subvol/probe.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr std::size_t kMostLines = 30;  // places that people see; the others are in files

Json numbers(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

/// One number, or an array of the channels.
template <class Value>
Json each_channel(const ProbedField& field, const Value& value) {
    if (field.channels == 1) return value(0);
    Json all = Json::array();
    for (std::size_t c = 0; c < field.channels; ++c) all.push_back(value(c));
    return all;
}

class ProbeVerb : public Verb {
public:
    explicit ProbeVerb(CLI::App& program)
        : Verb(program, "probe", "Values and gradients of the limit at places, along a line, or summed up.",
               "  subvol probe part.vtu --at 0.1,0.2,0.3 --at 1,0,0\n"
               "  subvol probe part.vtu --line -1,0,0,1,0,0 --count 500 -o line.svg\n"
               "  subvol probe part.vtu --points bolts.csv -o values.csv --json\n"
               "  subvol probe part.vtu --stats --field Temp\n"
               "\n"
               "JSON: values, one for each place: at, inside, value and gradient of the chosen field, cell, parameters, "
               "fields with value and gradient of each. Outside there is nothing: null. stats: whole and parts, with "
               "volume and for each field integral, mean, min, max, their places, and a histogram.") {
        app().add_option("FILE", input_, input_help())->required();
        app().add_option("--at", at_, "a place in world units (repeatable)")->type_name("X,Y,Z")->allow_extra_args(false);
        auto* line = app().add_option("--line", line_, "places on a line, from its first end to its second");
        line->type_name("X0,Y0,Z0,X1,Y1,Z1");
        app()
            .add_option("--count", count_, "how many places on the line (default 200)")
            ->type_name("N")
            ->check(CLI::Range(2, 100000000))
            ->needs(line);
        app().add_option("--points", points_, "a table of places: three numbers a line, or columns x, y, z")->type_name("FILE");
        auto* stats = app().add_flag("--stats", stats_, "integral, mean, extremes with their places, histogram; by block too");
        app()
            .add_option("--bins", bins_, "intervals of the histogram (default 32)")
            ->type_name("N")
            ->check(CLI::Range(1, 100000))
            ->needs(stats);
        app()
            .add_option("-o,--output", output_, "a table of all fields (.csv), or a plot along the line (.svg)")
            ->type_name("FILE");
        scheme_.add_scheme_to(app());
        set_essentials({"--at", "--line", "--count", "--points", "--stats", "--output", "--field", "--json"});
    }

    int run(Report& report) override {
        const std::vector<Vec3> places = collect_places();
        check_outputs();
        const LimitOptions limit{.scheme = scheme_.options(0, report).scheme, .progress = report.progress()};
        if (is_bricks_input(input_)) {
            probe_the_bricks(places, limit, report);
            return 0;
        }
        ReadResult read = read_input(input_, common(), report);
        warn_of_sheets(read.sheets, report);
        const HexMesh mesh = used_mesh(std::move(read.mesh), common());
        const HexMesh chosen = with_chosen_first(mesh, report);
        report["cells"] = mesh.cells.size();
        if (!places.empty()) probe(chosen, places, limit, report);
        if (stats_) measure(chosen, read.blocks, limit.scheme, report);
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

    /// The selected field first, then all others as they are.
    [[nodiscard]] HexMesh with_chosen_first(const HexMesh& mesh, Report& report) const {
        HexMesh chosen = with_selected_field(mesh, common(), report);
        for (const Attribute& attribute : mesh.attributes) {
            if (attribute.name != chosen.attributes.front().name) chosen.attributes.push_back(attribute);
        }
        return chosen;
    }

    void probe_the_bricks(const std::vector<Vec3>& places, const LimitOptions& limit, Report& report) {
        const Bricks bricks = open_bricks_input(input_, app(), report);
        (void)select_brick_field(bricks, common(), report);
        const auto chosen_first = [&](HexMesh brick) {
            const std::string first = report.json().at("field");
            (void)std::ranges::stable_partition(brick.attributes, [&](const Attribute& field) { return field.name == first; });
            if (brick.attributes.empty()) brick.attributes.push_back(select_field(brick, {}).scalar);
            return brick;
        };
        if (!places.empty()) {
            const ProbeResult found = report.timed("probe", [&] {
                LimitOptions quiet = limit;
                quiet.progress = nullptr;
                return probe_bricks(bricks, places, {.limit = quiet}, chosen_first, report.progress());
            });
            show(found, places, report);
        }
        if (stats_) {
            say_stats(report.timed("measure",
                                   [&] {
                                       return measure_limit(
                                           bricks, {.scheme = limit.scheme, .bins = bins_, .progress = report.progress()},
                                           chosen_first);
                                   }),
                      report);
        }
        if (!output_.empty()) report["output"] = output_;
    }

    void probe(const HexMesh& mesh, const std::vector<Vec3>& places, const LimitOptions& limit, Report& report) const {
        const auto probe = report.timed("prepare", [&] { return LimitProbe(mesh, {.limit = limit}); });
        show(report.timed("probe", [&] { return probe.at(places, report.progress()); }), places, report);
    }

    void show(const ProbeResult& found, const std::vector<Vec3>& places, Report& report) const {
        std::size_t inside = 0;
        for (std::size_t p = 0; p < places.size(); ++p) inside += found.inside(p) ? 1 : 0;
        report["places"] = places.size();
        report["inside"] = inside;
        Json values = Json::array();
        if (common().json) {
            for (std::size_t p = 0; p < places.size(); ++p) values.push_back(as_json(found, p, places[p]));
            report["values"] = std::move(values);
        }
        say(found, places, report);
        if (inside < places.size()) {
            report.note(
                text(count_text(places.size() - inside), " of ", counted(places.size(), "place"), " lie outside the volume"));
        }
        if (output_.ends_with(".csv")) write_csv(found, places);
        if (output_.ends_with(".svg")) write_plot(found, places);
    }

    static Json as_json(const ProbeResult& found, std::size_t p, const Vec3& at) {
        Json one;
        one["at"] = numbers(at);
        one["inside"] = found.inside(p);
        if (!found.inside(p)) {
            for (const char* key : {"value", "gradient", "cell", "parameters", "fields"}) one[key] = nullptr;
            return one;
        }
        const auto value = [&](const ProbedField& field) {
            return each_channel(field, [&](std::size_t c) -> Json { return field.values[p * field.channels + c]; });
        };
        const auto gradient = [&](const ProbedField& field) {
            return each_channel(field, [&](std::size_t c) { return numbers(field.gradients[p * field.channels + c]); });
        };
        one["value"] = value(found.fields.front());
        one["gradient"] = gradient(found.fields.front());
        one["cell"] = found.cells[p];
        one["parameters"] = numbers(found.parameters[p]);
        for (const ProbedField& field : found.fields) {
            one["fields"][field.name] = {{"value", value(field)}, {"gradient", gradient(field)}};
        }
        return one;
    }

    static void say(const ProbeResult& found, const std::vector<Vec3>& places, Report& report) {
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

    void write_csv(const ProbeResult& found, const std::vector<Vec3>& places) const {
        using detail::exact_text;
        std::string table = "x,y,z,inside,cell,u,v,w";
        for (const ProbedField& field : found.fields) {
            for (std::size_t c = 0; c < field.channels; ++c) {
                const std::string name = field.name + (field.channels > 1 ? text(".", c) : "");
                for (const char* end : {"", "_dx", "_dy", "_dz"}) table += "," + quoted(name + end);
            }
        }
        table += "\n";
        const auto put = [&](const Vec3& v) { table += exact_text(v.x) + "," + exact_text(v.y) + "," + exact_text(v.z); };
        for (std::size_t p = 0; p < places.size(); ++p) {
            put(places[p]);
            table += found.inside(p) ? text(",1,", found.cells[p], ",") : ",0,,,,";
            if (found.inside(p)) put(found.parameters[p]);
            for (const ProbedField& field : found.fields) {
                for (std::size_t c = 0; c < field.channels; ++c) {
                    table += found.inside(p) ? "," + exact_text(field.values[p * field.channels + c]) + "," : ",,,,";
                    if (found.inside(p)) put(field.gradients[p * field.channels + c]);
                }
            }
            table += "\n";
        }
        detail::write_text_file(output_, table);
    }

    static std::string quoted(const std::string& name) {
        if (name.find_first_of(",\"\n") == std::string::npos) return name;
        std::string words = "\"";
        for (const char c : name) words += c == '"' ? std::string("\"\"") : std::string(1, c);
        return words + "\"";
    }

    /// The chosen field over the distance from the line's first end, with gaps where the line is outside.
    void write_plot(const ProbeResult& found, const std::vector<Vec3>& places) const {
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
        detail::write_text_file(output_, plot_svg_file({.title = "",
                                                        .x_label = "distance along the line",
                                                        .y_label = field.name,
                                                        .log_x = false,
                                                        .log_y = false,
                                                        .lines = {line}}));
    }

    void measure(const HexMesh& mesh, const std::vector<MeshBlock>& blocks, const SchemeOptions& scheme, Report& report) const {
        const BlockCells parts =
            report.timed("blocks", [&] { return cells_of_blocks(input_, blocks, mesh, common(), report); });
        const LimitMeasure found = report.timed("measure", [&] {
            return measure_limit(
                mesh,
                {.scheme = scheme, .bins = bins_, .groups = parts.groups, .names = parts.names, .progress = report.progress()});
        });
        say_stats(found, report);
    }

    static void say_stats(const LimitMeasure& found, Report& report) {
        report["stats"] = {{"whole", as_json(found.whole)}, {"parts", Json::array()}, {"pieces", found.pieces}};
        for (const PartMeasure& part : found.parts) report["stats"]["parts"].push_back(as_json(part));
        say(found.whole, "", report);
        for (const PartMeasure& part : found.parts) say(part, part.name, report);
        report.all_said();
    }

    static Json as_json(const PartMeasure& part) {
        Json one;
        if (!part.name.empty()) one["name"] = part.name;
        one["cells"] = part.cells;
        one["volume"] = part.volume;
        one["fields"] = Json::array();
        for (const FieldMeasure& field : part.fields) {
            one["fields"].push_back({{"name", field.name},
                                     {"integral", field.integral},
                                     {"mean", field.mean},
                                     {"min", field.min.value},
                                     {"min_at", numbers(field.min.place)},
                                     {"min_cell", field.min.cell},
                                     {"max", field.max.value},
                                     {"max_at", numbers(field.max.place)},
                                     {"max_cell", field.max.cell},
                                     {"histogram", field.histogram}});
        }
        return one;
    }

    static void say(const PartMeasure& part, const std::string& name, Report& report) {
        using detail::number_text;
        Lines lines{{"volume", number_text(part.volume)}};
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

    std::string input_, line_, points_, output_;
    std::vector<std::string> at_;
    std::size_t count_ = 200;
    int bins_ = 32;
    bool stats_ = false;
    RefineArguments scheme_;
};

}  // namespace

std::unique_ptr<Verb> make_probe_verb(CLI::App& program) {
    return std::make_unique<ProbeVerb>(program);
}

}  // namespace subvol::cli
