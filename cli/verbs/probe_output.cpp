// SPDX-License-Identifier: Apache-2.0
// What is found at places, over parts of the body and over patches, as JSON, as lines for people, as a table and as a plot.
//
//     places    value and gradient of each field and channel; outside the volume null in JSON, and empty in a table
//     parts     volume, and for each field its mean, integral, extremes with their places, and a histogram
//     patches   area, the same figures of fields, and the flow out through the patch
//
// Figures are those of the limit, each with how far it may be off; beside them stand those of the cells as the file has them,
// after "file". Warnings say where the two differ. A plot along a line has gaps where the line is outside. A table has all
// digits of its numbers; lines for people are limited in number.
#include "probe_output.h"

#include <algorithm>
#include <cmath>

#include "limit_warning.h"
#include "mesh_figures.h"
#include "outputs.h"
#include "quantities.h"
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
            table += "," + csv_text(name);
            if (field.gradients.empty()) continue;
            for (const char* end : {"_dx", "_dy", "_dz"}) table += "," + csv_text(name + end);
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
                table += ",";
                if (found.inside(p)) table += exact_text(field.values[p * field.channels + c]);
                if (field.gradients.empty()) continue;
                table += found.inside(p) ? "," : ",,,";
                if (found.inside(p)) put(field.gradients[p * field.channels + c]);
            }
        }
        table += "\n";
    }
    detail::write_text_file(file, table);
}

/// A field over the distance from the line's first end, with gaps where the line is outside.
PlotLine curve_of(const ProbedField& field, const ProbeResult& found, const std::vector<Vec3>& places) {
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
    return line;
}

/// fields: how many of the first ones have a curve
void write_plot(const ProbeResult& found, const std::vector<Vec3>& places, std::size_t fields, const std::string& file) {
    std::vector<PlotLine> lines;
    for (std::size_t f = 0; f < fields; ++f) lines.push_back(curve_of(found.fields[f], found, places));
    detail::write_text_file(file, plot_svg_file({.title = "",
                                                 .x_label = "distance along the line",
                                                 .y_label = fields == 1 ? lines.front().name : "value",
                                                 .log_x = false,
                                                 .log_y = false,
                                                 .lines = lines}));
}

/// The values of some fields, in their order, without gradients.
ProbeResult values_of(const ProbeResult& found, const std::vector<std::string>& names) {
    ProbeResult some{found.cells, found.parameters, found.distances, {}, found.rounds};
    for (const std::string& name : names) {
        const auto field = std::ranges::find(found.fields, name, &ProbedField::name);
        some.fields.push_back({field->name, field->channels, field->values, {}});
    }
    return some;
}

/// How far beyond the least and largest value the limit may go.
std::string within(double extreme_error) {
    return "  within " + detail::number_text(extreme_error, 2);
}

Json cell_of(const LimitExtreme& extreme) {
    return extreme.cell == kNone ? Json() : Json(extreme.cell);
}

/// field: a FieldMeasure or a PatchField
template <class Field>
Json json_of_field(const Field& field) {
    return {{"name", field.name},
            {"integral", field.integral},
            {"mean", field.mean},
            {"min", field.min.value},
            {"min_at", place_of(field.min)},
            {"min_cell", cell_of(field.min)},
            {"max", field.max.value},
            {"max_at", place_of(field.max)},
            {"max_cell", cell_of(field.max)},
            {"extreme_error", field.extreme_error},
            {"file_integral", field.given.integral},
            {"file_mean", field.given.mean},
            {"file_min", field.given.min.value},
            {"file_min_at", place_of(field.given.min)},
            {"file_max", field.given.max.value},
            {"file_max_at", place_of(field.given.max)}};
}

/// Where the bins of a histogram begin and end: between the extremes of the whole, evenly.
std::vector<double> edges_of(const FieldMeasure& whole) {
    const std::size_t bins = whole.histogram.size();
    std::vector<double> edges(bins + 1, whole.max.value);
    for (std::size_t k = 0; k < bins; ++k) {
        edges[k] = whole.min.value + (whole.max.value - whole.min.value) * static_cast<double>(k) / static_cast<double>(bins);
    }
    return edges;
}

/// A row for each bin of each field, of the whole and of each part.
void write_histograms(const LimitMeasure& found, const std::string& file) {
    using detail::exact_text;
    std::string table = "part,field,from,to,volume\n";
    const auto add = [&](const PartMeasure& part, const std::string& name) {
        for (std::size_t f = 0; f < part.fields.size(); ++f) {
            const std::vector<double> edges = edges_of(found.whole.fields[f]);
            const FieldMeasure& field = part.fields[f];
            for (std::size_t k = 0; k < field.histogram.size(); ++k) {
                table += csv_text(name) + "," + csv_text(field.name) + "," + exact_text(edges[k]) + "," +
                         exact_text(edges[k + 1]) + "," + exact_text(field.histogram[k]) + "\n";
            }
        }
    };
    add(found.whole, "");
    for (const PartMeasure& part : found.parts) add(part, part.name);
    detail::write_text_file(file, table);
}

/// The volume over the value, in steps: of the whole, or a line for each part.
void write_histogram_plot(const LimitMeasure& found, const std::string& file) {
    if (found.whole.fields.size() != 1) {
        throw Error(ErrorCode::InvalidInput,
                    "a plot of a histogram has one field, and here there are " + std::to_string(found.whole.fields.size()),
                    file, "--field NAME, or a .csv file, which takes all");
    }
    const FieldMeasure& whole = found.whole.fields.front();
    const std::vector<double> edges = edges_of(whole);
    std::vector<PlotLine> lines;
    const auto add = [&](const FieldMeasure& field, const std::string& name) {
        PlotLine line{name, {edges.front()}, {0}};
        line.marked = false;
        for (std::size_t k = 0; k < field.histogram.size(); ++k) {
            line.x.insert(line.x.end(), {edges[k], edges[k + 1]});
            line.y.insert(line.y.end(), 2, field.histogram[k]);
        }
        line.x.push_back(edges.back());
        line.y.push_back(0);
        lines.push_back(std::move(line));
    };
    if (found.parts.empty()) add(whole, whole.name);
    for (const PartMeasure& part : found.parts) add(part.fields.front(), part.name);
    detail::write_text_file(file,
                            plot_svg_file({.title = "",
                                           .x_label = whole.name,
                                           .y_label = "volume in each of " + std::to_string(whole.histogram.size()) + " ranges",
                                           .log_x = false,
                                           .log_y = false,
                                           .lines = lines}));
}

Json as_json(const PartMeasure& part) {
    Json one;
    if (!part.name.empty()) one["name"] = part.name;
    one["cells"] = part.cells;
    one["volume"] = part.volume;
    one["error"] = part.error;
    one["file_volume"] = part.given_volume;
    one["fields"] = Json::array();
    for (const FieldMeasure& field : part.fields) {
        one["fields"].push_back(json_of_field(field));
        one["fields"].back()["histogram"] = field.histogram;
    }
    return one;
}

/// The figure of the cells as the file has them, for the end of a figure of the limit.
std::string beside(double of_file) {
    return std::isfinite(of_file) ? " · file " + detail::number_text(of_file) : "";
}

/// mesh: null if the cells are not in memory
std::string beside(const LimitExtreme& of_file, const HexMesh* mesh) {
    if (!std::isfinite(of_file.value)) return "";
    std::string words = beside(of_file.value);
    if (of_file.cell == kNone) return words;
    const auto corner = of_file.corner();
    if (corner && mesh != nullptr) return words + text(" at point ", mesh->cells[of_file.cell][*corner]);
    return words + text(" in cell ", of_file.cell);
}

/// The value and where it is.
std::string at_place(const LimitExtreme& extreme) {
    using detail::number_text;
    const Vec3& x = extreme.place;
    return number_text(extreme.value) + " at " + number_text(x.x, 4) + "," + number_text(x.y, 4) + "," + number_text(x.z, 4);
}

void say(const PartMeasure& part, const std::string& name, const HexMesh* mesh, Report& report) {
    using detail::number_text;
    Lines lines{
        {"volume", number_text(part.volume) + "  within " + number_text(part.error, 2) + " of it" + beside(part.given_volume)}};
    if (!name.empty()) lines.insert(lines.begin(), {"part", text(name, " (", counted(part.cells, "cell"), ")")});
    for (const FieldMeasure& field : part.fields) {
        if (part.volume == 0) continue;  // without means and extremes
        const GivenFigures& given = field.given;
        lines.emplace_back(field.name, "mean " + number_text(field.mean) + beside(given.mean) + "  integral " +
                                           number_text(field.integral) + beside(given.integral));
        lines.emplace_back("", "min " + at_place(field.min) + within(field.extreme_error) + beside(given.min, mesh));
        lines.emplace_back("", "max " + at_place(field.max) + within(field.extreme_error) + beside(given.max, mesh));
    }
    report.answer(aligned(lines));
}

/// What a user of the file's cells must know: the limit is another body, or has other values.
void warn_of_difference(const PartMeasure& part, Report& report) {
    LimitBody body;
    body.volume = part.volume;
    body.given_volume = part.given_volume;
    report.warn(limit_warning(body));
    for (const FieldMeasure& field : part.fields) {
        report.warn(
            range_warning(field.name, {field.given.min.value, field.given.max.value}, {field.min.value, field.max.value}));
    }
}

/// NaN is null in JSON, so it is said.
void warn_of_overflow(const PartMeasure& part, Report& report) {
    for (const FieldMeasure& field : part.fields) {
        if (std::isfinite(field.integral) && (std::isfinite(field.mean) || part.volume == 0)) continue;
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
    for (std::size_t f = 0; f < found.whole.fields.size(); ++f)
        stats["whole"]["fields"][f]["histogram_edges"] = edges_of(found.whole.fields[f]);
    stats["folded_cells"] = found.folds.cells;
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

void show_probed(const ProbeResult& found, const std::vector<Vec3>& places, const std::vector<std::string>& chosen,
                 const std::string& file, const CommonOptions& options, Report& report) {
    std::size_t inside = 0;
    for (std::size_t p = 0; p < places.size(); ++p) inside += found.inside(p) ? 1 : 0;
    report["places"] = places.size();
    report["inside"] = inside;
    if (options.json) report["values"] = json_of(found, places);
    const ProbeResult shown = chosen.empty() ? found : values_of(found, chosen);
    if (!options.quiet || file.empty()) say(shown, places, report);
    if (inside < places.size()) {
        report.note(
            text(count_text(places.size() - inside), " of ", counted(places.size(), "place"), " lie outside the volume"));
    }
    if (file.ends_with(".csv")) write_csv(shown, places, file);
    if (file.ends_with(".svg")) write_plot(shown, places, chosen.empty() ? 1 : shown.fields.size(), file);
}

Json json_of(const std::vector<PatchMeasure>& found) {
    Json patches = Json::array();
    for (const PatchMeasure& patch : found) {
        Json one{{"name", patch.name},
                 {"faces", patch.sides},
                 {"area", patch.area},
                 {"error", patch.error},
                 {"file_area", patch.given_area}};
        one["normal"] = json_of(patch.normal);
        if (patch.flux) {
            one["flux"] = *patch.flux;
            one["throughput"] = *patch.throughput;
            one["file_flux"] = patch.given_flux.value_or(std::nan(""));
            one["file_throughput"] = patch.given_throughput.value_or(std::nan(""));
        }
        one["fields"] = Json::array();
        for (const PatchField& field : patch.fields) one["fields"].push_back(json_of_field(field));
        patches.push_back(std::move(one));
    }
    return patches;
}

void show_patches(const std::vector<PatchMeasure>& found, const HexMesh& mesh, bool of_file, Report& report) {
    using detail::number_text;
    report["patches"] = json_of(found);
    double flux = 0, throughput = 0;
    for (const PatchMeasure& patch : found) {
        Lines lines{{"patch", text(patch.name, " (", counted(patch.sides, "face"), ")")},
                    {"area", number_text(patch.area) + "  within " + number_text(patch.error, 2) + " of it" +
                                 beside(patch.given_area)}};
        for (const PatchField& field : patch.fields) {
            const GivenFigures& given = field.given;
            lines.emplace_back(field.name, "mean " + number_text(field.mean) + beside(given.mean) + "  integral " +
                                               number_text(field.integral) + beside(given.integral));
            lines.emplace_back("", "min " + at_place(field.min) + within(field.extreme_error) + beside(given.min, &mesh));
            lines.emplace_back("", "max " + at_place(field.max) + within(field.extreme_error) + beside(given.max, &mesh));
            if (!of_file) continue;
            std::string warning =
                range_warning(field.name, {given.min.value, given.max.value}, {field.min.value, field.max.value});
            if (!warning.empty()) report.warn("patch " + patch.name + ": " + warning);
        }
        if (patch.flux) {
            lines.emplace_back("flow out", number_text(*patch.flux) + beside(patch.given_flux.value_or(std::nan(""))));
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

void show_measured(const LimitMeasure& found, const HexMesh* mesh, bool of_file, const std::string& file, Report& report) {
    if (file.ends_with(".csv")) write_histograms(found, file);
    if (file.ends_with(".svg")) write_histogram_plot(found, file);
    report["stats"] = json_of(found);
    warn_of_overflow(found.whole, report);
    if (of_file) warn_of_difference(found.whole, report);
    if (of_file) report.warn(fold_warning(found.folds));
    say(found.whole, "", mesh, report);
    for (const PartMeasure& part : found.parts) say(part, part.name, mesh, report);
    report.all_said();
}

}  // namespace subvol::cli
