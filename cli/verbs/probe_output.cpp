// SPDX-License-Identifier: Apache-2.0
#include "probe_output.h"

#include <algorithm>
#include <cmath>

#include "mesh_figures.h"
#include "outputs.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/plot.h"
#include "subvol/quantity.h"
#include "text.h"

namespace subvol::cli {
namespace {

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
        lines.emplace_back(place_text(places[p]), words);
    }
    report.answer(aligned(lines));
    if (places.size() > kMostLines) {
        report.say(text("and ", count_text(places.size() - kMostLines), " more (--json or -o FILE.csv has all)"));
    }
    report.all_said();
}

void write_csv(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file) {
    using detail::exact_text;
    std::string table = "x,y,z,inside,cell,u,v,w";
    for (const ProbedField& field : found.fields) {
        for (const std::string& name : channel_names(field)) {
            for (const char* end : {"", "_dx", "_dy", "_dz"}) table += "," + csv_text(name + end);
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

/// How far beyond the least and largest value the limit may go.
std::string within(double extreme_error) {
    return "  within " + detail::number_text(extreme_error, 2);
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
        lines.emplace_back("", "min " + at(field.min) + "  max " + at(field.max) + within(field.extreme_error));
    }
    report.answer(aligned(lines));
}

/// NaN is null in JSON, so it is said.
void warn_of_overflow(const PartMeasure& part, Report& report) {
    for (const FieldMeasure& field : part.fields) {
        if (std::isfinite(field.integral) && std::isfinite(field.mean)) continue;
        report.warn(text("the integral of ", field.name, " is larger than a number can be"));
    }
}

}  // namespace

Json json_of(const ProbeResult& found, const std::vector<Vec3>& places) {
    Json values = Json::array();
    for (std::size_t p = 0; p < places.size(); ++p) values.push_back(as_json(found, p, places[p]));
    return values;
}

Json json_of(const LimitMeasure& found) {
    Json stats{{"whole", as_json(found.whole)}, {"parts", Json::array()}, {"pieces", found.pieces}};
    for (const PartMeasure& part : found.parts) stats["parts"].push_back(as_json(part));
    return stats;
}

std::vector<std::string> channel_names(const ProbedField& field) {
    if (field.channels == 1) return {field.name};
    std::vector<std::string> names = component_names(static_cast<int>(field.channels));
    for (std::string& name : names) name = field.name + "." + name;
    return names;
}

std::string place_text(const Vec3& place) {
    using detail::number_text;
    return number_text(place.x) + "," + number_text(place.y) + "," + number_text(place.z);
}

std::string csv_text(const std::string& text) {
    const std::string name = detail::printable(text);
    if (name.find_first_of(",\"\n") == std::string::npos) return name;
    std::string words = "\"";
    for (const char c : name) words += c == '"' ? std::string("\"\"") : std::string(1, c);
    return words + "\"";
}

void show_probed(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file,
                 const CommonOptions& options, Report& report) {
    std::size_t inside = 0;
    for (std::size_t p = 0; p < places.size(); ++p) inside += found.inside(p) ? 1 : 0;
    report["places"] = places.size();
    report["inside"] = inside;
    if (options.json) report["values"] = json_of(found, places);
    if (!options.quiet || file.empty()) say(found, places, report);
    if (inside < places.size()) {
        report.note(
            text(count_text(places.size() - inside), " of ", counted(places.size(), "place"), " lie outside the volume"));
    }
    if (file.ends_with(".csv")) write_csv(found, places, file);
    if (file.ends_with(".svg")) write_plot(found, places, file);
}

Json json_of(const std::vector<PatchMeasure>& found) {
    Json patches = Json::array();
    for (const PatchMeasure& patch : found) {
        Json one{{"name", patch.name}, {"faces", patch.sides}, {"area", patch.area}, {"error", patch.error}};
        one["normal"] = json_of(patch.normal);
        if (patch.flux) {
            one["flux"] = *patch.flux;
            one["throughput"] = *patch.throughput;
        }
        one["fields"] = Json::array();
        for (const PatchField& field : patch.fields) {
            one["fields"].push_back({{"name", field.name},
                                     {"integral", field.integral},
                                     {"mean", field.mean},
                                     {"min", field.min},
                                     {"max", field.max},
                                     {"extreme_error", field.extreme_error}});
        }
        patches.push_back(std::move(one));
    }
    return patches;
}

void show_patches(const std::vector<PatchMeasure>& found, Report& report) {
    using detail::number_text;
    report["patches"] = json_of(found);
    double flux = 0, throughput = 0;
    for (const PatchMeasure& patch : found) {
        Lines lines{{"patch", text(patch.name, " (", counted(patch.sides, "face"), ")")},
                    {"area", number_text(patch.area) + "  within " + number_text(patch.error, 2) + " of it"}};
        for (const PatchField& field : patch.fields) {
            lines.emplace_back(field.name, "mean " + number_text(field.mean) + "  min " + number_text(field.min) + "  max " +
                                               number_text(field.max) + within(field.extreme_error));
        }
        if (patch.flux) {
            lines.emplace_back("flow out", number_text(*patch.flux));
            flux += *patch.flux;
            throughput += *patch.throughput;
        }
        report.answer(aligned(lines));
    }
    if (found.size() > 1 && found.front().flux) {
        report["flux_sum"] = flux;
        report.answer(text("flow out of all: ", number_text(flux), " of ", number_text(throughput), " in both directions"));
    }
    report.all_said();
}

void show_measured(const LimitMeasure& found, Report& report) {
    report["stats"] = json_of(found);
    warn_of_overflow(found.whole, report);
    say(found.whole, "", report);
    for (const PartMeasure& part : found.parts) say(part, part.name, report);
    report.all_said();
}

}  // namespace subvol::cli
