// SPDX-License-Identifier: Apache-2.0
#include "probe_series.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "probe_output.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/plot.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// A table: the step and its time, which place or part, and numbers. NaN: there is nothing.
struct SeriesTable {
    std::vector<std::string> columns;
    struct SeriesTableRow {
        std::size_t step = 0;
        double time = 0;
        std::string label;
        std::vector<double> numbers;
    };
    std::vector<SeriesTableRow> rows;
};

/// The fields that all steps have.
std::vector<std::string> common_fields(const std::vector<ProbedStep>& steps) {
    std::vector<std::string> names;
    for (const ProbedField& field : steps.front().places->fields) {
        const bool everywhere = std::ranges::all_of(steps, [&](const ProbedStep& step) {
            return std::ranges::find(step.places->fields, field.name, &ProbedField::name) != step.places->fields.end();
        });
        if (everywhere) names.push_back(field.name);
    }
    return names;
}

SeriesTable table_of_places(const std::vector<ProbedStep>& steps, const std::vector<Vec3>& places,
                            const std::vector<std::string>& chosen) {
    SeriesTable table;
    const std::vector<std::string> names = chosen.empty() ? common_fields(steps) : chosen;
    const auto field_in = [](const ProbedStep& step, const std::string& name) -> const ProbedField& {
        return *std::ranges::find(step.places->fields, name, &ProbedField::name);
    };
    for (const std::string& name : names) {
        for (const std::string& channel : channel_names(field_in(steps.front(), name))) table.columns.push_back(channel);
    }
    for (const ProbedStep& step : steps) {
        for (std::size_t p = 0; p < places.size(); ++p) {
            SeriesTable::SeriesTableRow row{step.step, step.time, place_text(places[p]), {}};
            for (const std::string& name : names) {
                const ProbedField& field = field_in(step, name);
                for (std::size_t c = 0; c < field.channels; ++c) {
                    row.numbers.push_back(step.places->inside(p) ? field.values[p * field.channels + c] : kNothing);
                }
            }
            table.rows.push_back(std::move(row));
        }
    }
    return table;
}

SeriesTable table_of_parts(const std::vector<ProbedStep>& steps) {
    SeriesTable table{{"volume"}, {}};
    for (const FieldMeasure& field : steps.front().measure->whole.fields) {
        for (const char* figure : {"mean", "integral", "min", "max"}) table.columns.push_back(field.name + " " + figure);
    }
    const auto add = [&](const ProbedStep& step, const PartMeasure& part, const std::string& name) {
        SeriesTable::SeriesTableRow row{step.step, step.time, name, {part.volume}};
        for (const FieldMeasure& field : part.fields) {
            row.numbers.insert(row.numbers.end(), {field.mean, field.integral, field.min.value, field.max.value});
        }
        table.rows.push_back(std::move(row));
    };
    for (const ProbedStep& step : steps) {
        add(step, step.measure->whole, "whole");
        for (const PartMeasure& part : step.measure->parts) add(step, part, part.name);
    }
    return table;
}

SeriesTable table_of_patches(const std::vector<ProbedStep>& steps) {
    const PatchMeasure& first = steps.front().patches.front();
    SeriesTable table{{"area"}, {}};
    if (first.flux) table.columns.insert(table.columns.begin(), "flow out");
    for (const PatchField& field : first.fields) {
        for (const char* figure : {"mean", "integral", "min", "max"}) table.columns.push_back(field.name + " " + figure);
    }
    for (const ProbedStep& step : steps) {
        for (const PatchMeasure& patch : step.patches) {
            SeriesTable::SeriesTableRow row{step.step, step.time, patch.name, {patch.area}};
            if (patch.flux) row.numbers.insert(row.numbers.begin(), *patch.flux);
            for (const PatchField& field : patch.fields)
                row.numbers.insert(row.numbers.end(), {field.mean, field.integral, field.min.value, field.max.value});
            table.rows.push_back(std::move(row));
        }
    }
    return table;
}

void say(const SeriesTable& table, Report& report) {
    constexpr int kDigits = 6;
    for (const SeriesTable::SeriesTableRow& row : table.rows) {
        std::string line = text("step ", row.step, "  time ", detail::number_text(row.time, kDigits), "  ", row.label);
        for (std::size_t c = 0; c < row.numbers.size(); ++c) {
            line += text("  ", table.columns[c], " ");
            line += std::isnan(row.numbers[c]) ? "outside" : detail::number_text(row.numbers[c], kDigits);
        }
        report.answer(line);
    }
}

void write_table(const SeriesTable& table, const std::string& file) {
    std::string lines = "step,time,of";
    for (const std::string& column : table.columns) lines += "," + csv_text(column);
    lines += "\n";
    for (const SeriesTable::SeriesTableRow& row : table.rows) {
        lines += text(row.step, ",", detail::exact_text(row.time), ",", csv_text(row.label));
        for (const double number : row.numbers) lines += std::isnan(number) ? "," : "," + detail::exact_text(number);
        lines += "\n";
    }
    detail::write_text_file(file, lines);
}

/// Over time: a line for each place and field, the flow or area of each patch, or each field's mean, minimum and maximum over
/// the whole.
///
/// fields: how many of the first ones; of patches 1
void write_plot(const SeriesTable& table, bool labelled, std::size_t fields, const std::string& file) {
    std::vector<PlotLine> lines;
    const auto add = [&](const std::string& name, double time, double value) {
        auto line = std::ranges::find(lines, name, &PlotLine::name);
        if (line == lines.end()) line = lines.insert(line, PlotLine{name, {}, {}});
        if (std::isnan(value)) return line->breaks.push_back(line->x.size());
        line->x.push_back(time);
        line->y.push_back(value);
    };
    for (const SeriesTable::SeriesTableRow& row : table.rows) {
        for (std::size_t f = 0; f < fields; ++f) {
            if (labelled) {
                const std::string name = fields == 1 ? row.label : table.columns[f] + " at " + row.label;
                add(name, row.time, row.numbers[f]);
            } else if (row.label == "whole") {
                for (const std::size_t c : {4 * f + 1, 4 * f + 3, 4 * f + 4}) add(table.columns[c], row.time, row.numbers[c]);
            }
        }
    }
    std::erase_if(lines, [](const PlotLine& line) { return line.x.empty(); });
    const std::string label = labelled && fields == 1 ? table.columns[0] : "value";
    detail::write_text_file(
        file,
        plot_svg_file(
            {.title = "", .x_label = "time", .y_label = label, .log_x = false, .log_y = false, .lines = std::move(lines)}));
}

}  // namespace

void show_steps(const std::vector<ProbedStep>& steps, const std::vector<Vec3>& places, const std::vector<std::string>& chosen,
                const std::string& file, const CommonOptions& options, Report& report) {
    Json all = Json::array();
    for (const ProbedStep& step : steps) {
        Json one{{"step", step.step}, {"time", step.time}};
        if (step.places) one["values"] = json_of(*step.places, places);
        if (step.measure) one["stats"] = json_of(*step.measure);
        if (!step.patches.empty()) one["patches"] = json_of(step.patches);
        all.push_back(std::move(one));
    }
    report["steps"] = std::move(all);
    const bool of_places = steps.front().places.has_value();
    const bool of_patches = !steps.front().patches.empty();
    const SeriesTable table = of_places    ? table_of_places(steps, places, chosen)
                              : of_patches ? table_of_patches(steps)
                                           : table_of_parts(steps);
    if (!options.quiet || file.empty()) say(table, report);
    report.all_said();
    if (file.ends_with(".csv")) write_table(table, file);
    const std::size_t fields = of_patches || chosen.empty() ? 1 : chosen.size();
    if (file.ends_with(".svg")) write_plot(table, of_places || of_patches, fields, file);
}

}  // namespace subvol::cli
