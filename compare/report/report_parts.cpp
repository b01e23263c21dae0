// SPDX-License-Identifier: Apache-2.0
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
#include "subvol/detail/text_codes.h"
#include "subvol/error.h"
#include "subvol/picture_metrics.h"
#include "subvol/plot.h"
#include "subvol/study_run.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

/// A value of a case as text; "" if it has none.
std::string value_of(const StudyCase& one, const std::string& key) {
    const auto found = one.values.find(key);
    return found == one.values.end() ? "" : as_text(found->second);
}

bool is_number(const StudyCase& one, const std::string& key) {
    const auto found = one.values.find(key);
    return found != one.values.end() && std::holds_alternative<double>(found->second);
}

/// The keys whose values differ among the cases; those that are only shown do not count.
std::map<std::string, std::size_t> varying(const Study& study, std::span<const std::size_t> cases) {
    std::map<std::string, std::set<std::string>> values;
    for (const std::size_t c : cases) {
        for (const auto& [key, value] : study.cases[c].values) {
            if (key != "label" && !key.starts_with("given.")) values[key].insert(as_text(value));
        }
    }
    std::map<std::string, std::size_t> counts;
    for (const auto& [key, different] : values) {
        const bool everywhere =
            std::ranges::all_of(cases, [&, &name = key](std::size_t c) { return study.cases[c].has(name); });
        if (different.size() + (everywhere ? 0 : 1) > 1) counts[key] = different.size() + (everywhere ? 0 : 1);
    }
    return counts;
}

/// "" if no number differs.
std::string swept_key(const Study& study, std::span<const std::size_t> cases, const std::string& x) {
    const auto numeric = [&](const std::string& key) {
        return std::ranges::all_of(cases, [&](std::size_t c) { return is_number(study.cases[c], key); });
    };
    if (!cases.empty() && numeric(x)) return x;
    std::string best;
    std::size_t most = 1;
    for (const auto& [key, count] : varying(study, cases)) {
        if (key == "seed" || count <= most || !numeric(key)) continue;
        best = key;
        most = count;
    }
    return best;
}

/// Whether a key has one value only for each value of the sweep, as a distance that shrinks with the spacing.
bool follows(const Study& study, std::span<const std::size_t> cases, const std::string& key, const std::string& sweep) {
    std::map<std::string, std::string> values;
    return std::ranges::all_of(cases, [&](std::size_t c) {
        const std::string value = value_of(study.cases[c], key);
        return values.try_emplace(value_of(study.cases[c], sweep), value).first->second == value;
    });
}

/// Cases that a line joins, in its order: they differ in the option that is swept, and in what follows from it.
///
/// cases: indices of a study's cases, those of one series of a plot
/// x:     the key of the horizontal axis; if it is an option of the cases it is the one that is swept, else that is the number
///        with the most values
std::vector<std::vector<std::size_t>> strands_of(const Study& study, std::span<const std::size_t> cases, const std::string& x) {
    const std::string sweep = swept_key(study, cases, x);
    std::vector<std::string> apart;
    for (const auto& [key, count] : varying(study, cases)) {
        if (key != sweep && (sweep.empty() || !follows(study, cases, key, sweep))) apart.push_back(key);
    }
    std::vector<std::string> groups;
    std::vector<std::vector<std::size_t>> strands;
    for (const std::size_t c : cases) {
        std::string group;
        for (const std::string& key : apart) group += value_of(study.cases[c], key) + '\n';
        const auto found = std::ranges::find(groups, group);
        if (found == groups.end()) {
            groups.push_back(group);
            strands.push_back({c});
        } else {
            strands[static_cast<std::size_t>(found - groups.begin())].push_back(c);
        }
    }
    if (sweep.empty()) return strands;
    for (auto& strand : strands) {
        std::ranges::stable_sort(strand, {}, [&](std::size_t c) { return std::get<double>(study.cases[c].values.at(sweep)); });
    }
    return strands;
}

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

std::string heading(const StudyPlotSpec& spec, const std::string& key) {
    const auto found = spec.headings.find(key);
    if (found != spec.headings.end()) return found->second;
    return spaced(key);
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

Plot plot_of(const StudyResults& results, const StudyPlotSpec& spec, const std::string& panel, const Series& series) {
    Plot plot{.title = spec.title + (panel.empty() ? "" : ": " + panel),
              .x_label = heading(spec, spec.x),
              .y_label = heading(spec, spec.y),
              .log_x = spec.log_x,
              .log_y = spec.log_y,
              .fit = spec.fit,
              .lines = {}};
    for (const auto& [name, cases] : series) {
        PlotLine& line = plot.lines.emplace_back();
        line.name = name;
        for (const auto& strand : strands_of(results.study, cases, spec.x)) {
            if (!line.x.empty()) line.breaks.push_back(line.x.size());
            for (const std::size_t c : strand) {
                line.x.push_back(*number_of(results.study.cases[c], results.results[c], spec.x));
                line.y.push_back(*number_of(results.study.cases[c], results.results[c], spec.y));
            }
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

std::string triple_html(const fs::path& ours, const fs::path& reference, const fs::path& difference, const std::string& title) {
    return "<div class=\"triple\">\n<figure class=\"both ours\">" + image_html(ours, title) +
           "<figcaption>ours</figcaption></figure>\n" + "<figure class=\"both reference\">" +
           image_html(reference, title + ", reference") + "<figcaption>reference</figcaption></figure>\n" +
           "<div class=\"slide\"><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
           "aria-label=\"Part of the picture, from the left, that shows "
           "ours\"><label><span>ours</span><span>reference</span></label></div>\n" +
           "<figure class=\"difference\">" + image_html(difference, title + ", difference") +
           "<figcaption>difference (largest channel)</figcaption></figure>\n</div>\n";
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
    html += "<div class=\"wide\"><table>\n<thead><tr>";
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
        html += "<code>" + escaped(files[i]) + ".svg</code>, <code>.pdf</code></figcaption></figure>\n";
    }
    return html + "</div>\n";
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
        html += triple_html(ours, reference, study_folder / result.files.at("difference"), title);
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
