// SPDX-License-Identifier: Apache-2.0
// Parts of the report of a study as HTML: tables, plots, pictures and failures. The page needs no other file: pictures are
// data URIs, plots are SVG. Cases of a plot are grouped by the panel that they are shown in, then by the line that they belong
// to. A line joins cases that differ in the option that is swept; those that differ only in what is averaged are one place
// with a bar for the deviation. Figures beyond the floor of their reference are bounds, drawn hollow, and the area beyond the
// worst floor is grey. A table's letters are counted to choose how small it is printed.
#include "report_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "canvas.h"
#include "subvol/detail/study_strands.h"
#include "subvol/detail/text_codes.h"
#include "subvol/error.h"
#include "subvol/picture_metrics.h"
#include "subvol/plot.h"
#include "subvol/study_measures.h"
#include "subvol/study_run.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

/// A PNG as a data URI.
///
/// throws: Error(Io) if it cannot be read, Error(InvalidInput) if it is larger than 16 MiB
std::string png_uri(const std::filesystem::path& file) {
    constexpr std::uintmax_t kMaxBytes = 16 << 20;
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file.string());
    if (bytes > kMaxBytes) throw Error(ErrorCode::InvalidInput, "is too large for a report (16 MiB)", file.string());
    std::ifstream in(file, std::ios::binary);
    std::ostringstream content;
    content << in.rdbuf();
    if (!in) throw Error(ErrorCode::Io, "cannot be read", file.string());
    return "data:image/png;base64," + base64(content.str());
}

std::optional<double> number_of(const StudyCase& one, const CaseResult& result, const std::string& key) {
    const auto value = find_value(one, result, key);
    const double* number = value ? std::get_if<double>(&*value) : nullptr;
    return number != nullptr && std::isfinite(*number) ? std::optional(*number) : std::nullopt;
}

/// The element of a name, appended if it is new.
template <class T>
T& named(std::vector<std::pair<std::string, T>>& all, const std::string& name) {
    for (auto& [known, value] : all) {
        if (known == name) return value;
    }
    return all.emplace_back(name, T{}).second;
}

using Series = std::vector<std::pair<std::string, std::vector<std::size_t>>>;  // names and cases

/// The values of the horizontal axis, if they are few options.
std::vector<double> option_ticks(const StudyResults& results, const std::string& key, const Series& series) {
    constexpr std::size_t kFew = 8;
    std::set<double> values;
    for (const auto& [name, cases] : series) {
        for (const std::size_t c : cases) {
            const StudyCase& one = results.study.cases[c];
            const auto found = one.values.find(key);
            const double* const number = found == one.values.end() ? nullptr : std::get_if<double>(&found->second);
            if (number == nullptr) return {};
            values.insert(*number);
        }
    }
    return values.size() <= kFew ? std::vector(values.begin(), values.end()) : std::vector<double>();
}

/// The floor that all figures of a plot have in common: the worst of those that their references have.
void add_floor(const StudyResults& results, const std::string& key, const Series& series, Plot& plot) {
    const PictureMetric* const metric = find_metric(key);
    if (metric == nullptr) return;
    plot.floor_above = metric->more_is_better;
    for (const auto& [name, cases] : series) {
        for (const std::size_t c : cases) {
            const auto known = accuracy(results.results[c], key);
            if (!known || !std::isfinite(*known)) continue;
            const double worst = plot.floor.value_or(*known);
            plot.floor = plot.floor_above ? std::min(worst, *known) : std::max(worst, *known);
        }
    }
    plot.floor_name = "beyond the floor of a reference; hollow: bounds";
}

/// Adds the place of some cases to a line: their means, if there are several.
void add_place(const StudyResults& results, const StudyPlotSpec& spec, std::span<const std::size_t> cases, PlotLine& line) {
    std::vector<double> x, y;
    bool bound = false;
    for (const std::size_t c : cases) {
        x.push_back(*number_of(results.study.cases[c], results.results[c], spec.x));
        y.push_back(*number_of(results.study.cases[c], results.results[c], spec.y));
        bound = bound || is_beyond_floor(results.results[c], spec.y);
    }
    const Spread mean = mean_and_spread(y);
    if (bound) line.bounds.push_back(line.x.size());
    line.x.push_back(mean_and_spread(x).mean);
    line.y.push_back(mean.mean);
    line.spreads.push_back(mean.deviation);
}

Plot plot_of(const StudyResults& results, const StudyPlotSpec& spec, const std::string& panel, const Series& series) {
    const auto label = [&](const std::string& key) {
        return spec.headings.contains(key) ? spec.headings.at(key) : axis_label(results.study, key);
    };
    Plot plot{.title = spec.title + (panel.empty() ? "" : ": " + panel),
              .x_label = label(spec.x),
              .y_label = label(spec.y),
              .log_x = spec.log_x,
              .log_y = spec.log_y,
              .fit = spec.fit,
              .lines = {},
              .x_ticks = option_ticks(results, spec.x, series)};
    add_floor(results, spec.y, series, plot);
    for (const auto& [name, cases] : series) {
        PlotLine& line = plot.lines.emplace_back();
        line.name = name;
        for (const StudyStrand& strand : strands_of(results.study, cases, spec.x, spec.average)) {
            if (!line.x.empty()) line.breaks.push_back(line.x.size());
            for (const auto& place : strand) add_place(results, spec, place, line);
        }
    }
    return plot;
}

/// An image, or a sentence if it is missing.
std::string image_html(const fs::path& file, const std::string& alternative) {
    try {
        return "<img alt=\"" + escaped(alternative) + "\" src=\"" + png_uri(file) + "\">";
    } catch (const Error&) {
        return "<p>The picture is missing: " + escaped(file.filename().string()) + "</p>";
    }
}

/// A title for a case. If the case has no label, the options that are lists in the study distinguish it from others of its
/// method; the case's name contains them.
std::string case_title(const StudyCase& study_case) {
    const std::string input = spaced(study_case.text("input")), label = study_case.text("label");
    std::string title = input.empty() ? label : input + ", " + label;
    if (label != study_case.text("method")) return title;
    for (const char* key : {"per_edge", "spacing_voxels", "levels", "sheets", "kernel", "correction", "resolution"}) {
        const std::string value = study_case.has(key) ? as_text(study_case.values.at(key)) : "";
        if (study_case.name.find("_" + std::string(key) + "-" + value) != std::string::npos)
            title += ", " + spaced(key) + " " + value;
    }
    return title;
}

std::string figures(const CaseResult& result) {
    std::string words;
    if (result.notes.contains("own_reference")) return result.notes.at("own_reference");
    for (const auto& [key, name] :
         {std::pair{"psnr", "PSNR"}, {"psnr_interior", "interior"}, {"flip", "FLIP"}, {"rmse", "RMSE"}}) {
        const auto found = result.metrics.find(key);
        if (found == result.metrics.end()) continue;
        const PictureMetric* const metric = find_metric(key);
        const std::string unit = metric == nullptr || metric->unit.empty() ? "" : " " + std::string(metric->unit);
        const auto mark = mark_of(result, key);
        words += (words.empty() ? "" : ", ") + std::string(name) + " " + (mark ? *mark : readable(found->second)) + unit;
    }
    return words;
}

std::string triple_html(const fs::path& ours, const fs::path& reference,
                        const std::vector<std::pair<fs::path, std::string>>& maps, const std::string& title) {
    std::string differences;
    for (const auto& [file, caption] : maps)
        differences += image_html(file, title + ", " + caption) + "<figcaption>" + caption + "</figcaption>";
    return "<div class=\"triple\">\n<figure class=\"both ours\">" + image_html(ours, title) +
           "<figcaption>ours</figcaption></figure>\n" + "<figure class=\"both reference\">" +
           image_html(reference, title + ", reference") + "<figcaption>reference</figcaption></figure>\n" +
           "<div class=\"slide\"><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
           "aria-label=\"Part of the picture, from the left, that shows "
           "ours\"><label><span>ours</span><span>reference</span></label></div>\n" +
           "<figure class=\"difference\">" + differences + "</figure>\n</div>\n";
}

/// How small a table is to be printed, by the letters that lie side by side: numbers are not broken, words are. A sheet of A4
/// is 538 pt wide between its margins, and a digit .64 of its size.
const char* paper_class(const StudyTable& table, const std::vector<bool>& words) {
    constexpr std::size_t kPadding = 1, kWord = 7;  // in letters, of each column: style.css has their sum
    std::size_t letters = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        std::size_t longest = kWord;
        for (std::size_t r = 0; r < table.rows.size() && !words[c]; ++r) longest = std::max(longest, shown(table, r, c).size());
        letters += kPadding + longest;
    }
    return letters <= 112   ? "wide"
           : letters <= 140 ? "wide dense"
           : letters <= 168 ? "wide denser"
           : letters <= 210 ? "wide densest"
                            : "wide densest broken";
}

}  // namespace

std::string table_html(const StudyTable& table) {
    std::vector<bool> words(table.columns.size(), false);
    for (const auto& row : table.rows) {
        for (std::size_t c = 0; c < row.size(); ++c) words[c] = words[c] || std::holds_alternative<std::string>(row[c]);
    }
    const auto cell = [&](const char* tag, std::size_t c, const std::string& text) {
        return std::string("<") + tag + (words[c] ? " class=\"words\">" : ">") + escaped(text) + "</" + tag + ">";
    };
    std::string html = "<h3>" + escaped(table.title) + "</h3>\n";
    if (!table.caption.empty()) html += "<p class=\"soft\">" + escaped(table.caption) + "</p>\n";
    html += "<div class=\"" + std::string(paper_class(table, words)) + "\"><table>\n<thead><tr>";
    for (std::size_t c = 0; c < table.columns.size(); ++c) html += cell("th", c, table.columns[c]);
    html += "</tr></thead>\n<tbody>\n";
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        html += "<tr>";
        for (std::size_t c = 0; c < table.rows[r].size(); ++c) html += cell("td", c, shown(table, r, c));
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n<p class=\"files\"><code>" + escaped(table.name) +
           ".csv</code>, <code>.tex</code></p>\n";
}

std::vector<PlotPanel> plot_panels(const StudyResults& results, const StudyPlotSpec& spec) {
    std::vector<std::pair<std::string, Series>> panels;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        const StudyCase& study_case = results.study.cases[i];
        const CaseResult& result = results.results[i];
        const auto x = number_of(study_case, result, spec.x), y = number_of(study_case, result, spec.y);
        if (!x || !y || !matches(study_case, result, spec.where)) continue;
        std::string name;
        for (const std::string& key : spec.series) name += (name.empty() ? "" : ", ") + value_text(study_case, result, key);
        Series& series = named(panels, spec.panels.empty() ? "" : spaced(value_text(study_case, result, spec.panels)));
        named(series, name).push_back(i);
    }
    std::vector<PlotPanel> all;
    for (const auto& [panel, series] : panels) all.push_back({panel, plot_of(results, spec, panel, series)});
    return all;
}

std::string plots_html(const StudyResults& results, const StudyPlotSpec& spec, const std::vector<std::string>& files) {
    std::string html = "<h3>" + escaped(spec.title) + "</h3>\n";
    if (!spec.caption.empty()) html += "<p class=\"soft\">" + escaped(spec.caption) + "</p>\n";
    html += "<div class=\"plots\">\n";
    const auto panels = plot_panels(results, spec);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        html += "<figure>" + plot_svg(panels[i].plot) + "<figcaption>";
        if (!panels[i].name.empty()) html += escaped(panels[i].name) + " · ";
        html += "<code>" + escaped(files[i]) +
                ".svg</code>, <code>.pdf</code>, <code>.tex</code>, <code>.csv</code></figcaption></figure>\n";
    }
    html += "</div>\n<p class=\"files\">For print: <code>_84mm.pdf</code>, <code>_174mm.pdf</code>.";
    if (!spec.average.empty()) html += " Points are means, bars their standard deviation.";
    return html + " Hollow points are bounds: the grey area is beyond what the reference can tell.</p>\n";
}

std::string pictures_html(const StudyResults& results, const fs::path& folder) {
    std::string html;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        const StudyCase& study_case = results.study.cases[i];
        const CaseResult& result = results.results[i];
        if (!result.files.contains("picture") || !matches(study_case, result, results.study.pictures_where)) continue;
        const fs::path study_folder = folder / results.study.name;
        const fs::path ours = study_folder / result.files.at("picture");
        const std::string title = case_title(study_case);
        html += "<div class=\"case\"><h4>" + escaped(title) + "</h4>\n";
        if (!result.files.contains("difference")) {
            html += "<div class=\"single\">" + image_html(ours, title) + "</div></div>\n";
            continue;
        }
        const fs::path reference = result.files.contains("reference")
                                       ? study_folder / result.files.at("reference")
                                       : folder / "references" / (result.notes.at("reference") + ".png");
        std::vector<std::pair<fs::path, std::string>> maps{
            {study_folder / result.files.at("difference"), "difference (largest channel)"}};
        if (result.files.contains("sign"))
            maps.emplace_back(study_folder / result.files.at("sign"), "its sign (orange: too bright, blue: too dark)");
        html += triple_html(ours, reference, maps, title);
        html += "<p class=\"soft\">" + escaped(figures(result)) + "</p></div>\n";
    }
    return html.empty() ? html : "<h3>Pictures</h3>\n<div class=\"cases\">\n" + html + "</div>\n";
}

std::string failures_html(const StudyResults& results) {
    if (results.failed == 0) return {};
    std::string html = "<h3>Cases that failed</h3>\n<ul>\n";
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        if (results.results[i].failure.empty()) continue;
        html += "<li>" + escaped(results.study.cases[i].name) + ": " + escaped(results.results[i].failure) + "</li>\n";
    }
    return html + "</ul>\n";
}

}  // namespace subvol::detail
