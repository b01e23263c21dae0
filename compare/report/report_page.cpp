// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "canvas.h"
#include "report_parts.h"
#include "report_texts.h"
#include "subvol/detail/text_codes.h"
#include "subvol/picture_metrics.h"
#include "subvol/study_report.h"

namespace subvol {

using namespace detail;

namespace {

std::string_view embedded(std::string_view name) {
    return std::ranges::find(kTexts, name, &EmbeddedText::name)->text;
}

/// As of tables: NAME_plot, NAME_plot_2 and so on.
std::string plot_name(const Study& study, std::size_t number) {
    return study.name + "_plot" + (number == 1 ? "" : "_" + std::to_string(number));
}

std::string heading(const Study& study, const std::string& key) {
    for (const StudyTableSpec& table : study.tables) {
        if (const auto found = table.headings.find(key); found != table.headings.end()) return found->second;
    }
    return key;
}

Judgement judged(const StudyResults& results, const StudyDemand& demand) {
    Judgement judgement;
    std::optional<double> worst;
    double worst_excess = -INFINITY;
    std::string worst_case;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        const StudyCase& study_case = results.study.cases[i];
        if (!matches(study_case, results.results[i], demand.where)) continue;
        const auto found = results.results[i].metrics.find(demand.metric);
        if (found == results.results[i].metrics.end() && results.results[i].failure.empty()) continue;
        ++judgement.cases;
        const double value = found == results.results[i].metrics.end() ? NAN : found->second;
        double excess = std::isnan(value) ? INFINITY : -INFINITY;
        if (demand.least) excess = std::max(excess, *demand.least - value);
        if (demand.most) excess = std::max(excess, value - *demand.most);
        if (excess <= 0) ++judgement.met;
        if (!worst || excess > worst_excess) {
            worst = value;
            worst_excess = excess;
            worst_case = study_case.has("input") ? spaced(study_case.text("input")) : study_case.text("label");
        }
    }
    judgement.words = heading(results.study, demand.metric);
    if (demand.least) judgement.words += " at least " + as_text(*demand.least);
    if (demand.most) judgement.words += (demand.least ? " and at most " : " at most ") + as_text(*demand.most);
    for (const auto& [key, value] : demand.where) judgement.words += ", " + value;
    judgement.words += ": " + std::to_string(judgement.met) + " of " + std::to_string(judgement.cases);
    if (worst && judgement.cases > 1) judgement.words += "; the worst is " + worst_case + " with " + readable(*worst);
    if (worst && judgement.cases == 1) judgement.words += "; the value is " + readable(*worst);
    return judgement;
}

std::string demands_html(const StudyResults& results) {
    const auto judgements = judge(results);
    if (judgements.empty()) return {};
    std::string html = "<ul class=\"demands\">\n";
    for (const Judgement& judgement : judgements) {
        html += judgement.all_met() ? "<li><span class=\"met\">✓</span>" : "<li><span class=\"unmet\">✗</span>";
        html += escaped(judgement.words) + "</li>\n";
    }
    return html + "</ul>\n";
}

std::string count(std::size_t number, const std::string& one, const std::string& many) {
    return std::to_string(number) + " " + (number == 1 ? one : many);
}

std::string summary_html(std::span<const StudyResults> studies) {
    std::size_t cases = 0, failed = 0, demands = 0, met = 0;
    std::string rows;
    for (const StudyResults& results : studies) {
        cases += results.results.size();
        failed += results.failed;
        std::size_t judged = 0, judged_met = 0;
        for (const Judgement& judgement : judge(results)) {
            ++judged;
            judged_met += judgement.all_met() ? 1 : 0;
        }
        demands += judged;
        met += judged_met;
        rows += "<tr><td class=\"words\"><a href=\"#" + escaped(results.study.name) + "\">" + escaped(results.study.title) +
                "</a>" + demands_html(results) + "</td><td>" + std::to_string(results.results.size()) + "</td><td>" +
                std::to_string(results.failed) + "</td><td>" +
                (judged == 0 ? "–" : std::to_string(judged_met) + " of " + std::to_string(judged)) + "</td></tr>\n";
    }
    std::string verdict = count(studies.size(), "study", "studies") + ", " + count(cases, "case", "cases") + ": ";
    verdict += failed == 0 ? "all finished" : count(failed, "case", "cases") + " failed";
    if (demands > 0) verdict += "; " + std::to_string(met) + " of " + count(demands, "demand", "demands") + " met";
    std::string html = "<p class=\"verdict\">" + escaped(verdict) + ".</p>\n";
    return html +
           "<div class=\"wide\"><table>\n<thead><tr><th class=\"words\">study</th><th>cases</th><th>failed</th><th>demands met"
           "</th></tr></thead>\n<tbody>\n" +
           rows + "</tbody></table></div>\n";
}

/// The value of a fact; "" if there is none.
std::string fact(const ReportFacts& facts, const std::string& name) {
    const auto found = std::ranges::find(facts, name, &std::pair<std::string, std::string>::first);
    return found == facts.end() ? "" : found->second;
}

std::string program_words(const ReportOptions& options) {
    std::string words = "OpenSubVol " + fact(options.versions, "subvol");
    if (const std::string commit = fact(options.versions, "commit"); !commit.empty()) words += ", commit " + commit;
    return words;
}

std::string setup_html(const StudyResults& results, const ReportOptions& options) {
    const auto setup = setup_table(results);
    if (!setup) return {};
    const std::string methods = methods_text(results, program_words(options), fact(options.host, "processor"));
    return table_html(*setup) +
           (methods.empty() ? "" : "<h3>Methods, for a paper</h3>\n<p class=\"methods\">" + escaped(methods) + "</p>\n");
}

/// What the metrics of a study are.
std::string metrics_html(const StudyResults& results) {
    std::string rows;
    for (const PictureMetric& metric : picture_metrics()) {
        const bool used = std::ranges::any_of(results.study.cases, [&](const StudyCase& one) {
            return one.has("metrics") &&
                   ("," + one.text("metrics") + ",").find("," + std::string(metric.study)) != std::string::npos;
        });
        if (!used) continue;
        rows += "<dt>" + escaped(metric.study) + "</dt><dd>" + escaped(metric.quantity) +
                (metric.unit.empty() ? "" : ", " + escaped(metric.unit)) + ": " + escaped(metric.formula) +
                (metric.source.empty() ? "" : " [" + escaped(metric.source) + "]") + "</dd>\n";
    }
    return rows.empty() ? "" : "<h3>Metrics</h3>\n<dl>\n" + rows + "</dl>\n";
}

std::string citation_html(const ReportOptions& options) {
    const std::string date = fact(options.versions, "date");
    std::string entry =
        "@software{opensubvol,\n  title   = {OpenSubVol: subdivision volumes},\n  author  = {{The OpenSubVol developers}},\n  "
        "version = {" +
        fact(options.versions, "subvol") + "}";
    if (date.size() >= 4) entry += ",\n  year    = {" + date.substr(0, 4) + "}";
    entry += ",\n  note    = {" + program_words(options) + "}\n}";
    return "<h3>How to cite</h3>\n<pre>" + escaped(entry) +
           "</pre>\n<p class=\"soft\">The method: McDonnell, Neophytou, Mueller and Qin, <em>Subdivision Volume "
           "Splatting</em>, EuroVis "
           "2007. The sources contain <code>CITATION.cff</code>.</p>\n";
}

std::string study_html(const StudyResults& results, const std::filesystem::path& folder, const ReportOptions& options) {
    const Study& study = results.study;
    std::string html = "<section id=\"" + escaped(study.name) + "\">\n<h2>" + escaped(study.title) + "</h2>\n";
    if (!study.about.empty()) html += "<p>" + escaped(study.about) + "</p>\n";
    html += demands_html(results) + failures_html(results);
    for (const ReferenceState& one : reference_states(results)) {
        if (!one.converged)
            html += "<p class=\"warning\">The reference of " + escaped(one.name) +
                    " did not converge: figures of it are bounds.</p>\n";
    }
    for (const StudyTable& table : make_tables(results)) html += table_html(table);
    std::size_t plots = 0;
    for (const StudyPlotSpec& plot : study.plots) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < plot_panels(results, plot).size(); ++i) names.push_back(plot_name(study, ++plots));
        html += plots_html(results, plot, names);
    }
    html += setup_html(results, options) + metrics_html(results);
    if (study.pictures) html += pictures_html(results, folder);
    return html + "<p class=\"soft\">All numbers: <code>" + escaped(study.name) + "/results.csv</code>, <code>" +
           escaped(study.name) + "/costs.csv</code>.</p>\n</section>\n";
}

std::string facts_html(const ReportFacts& facts) {
    std::string html = "<dl>\n";
    for (const auto& [name, value] : facts) html += "<dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd>\n";
    return html + "</dl>\n";
}

/// Links to pages on which the inputs can be turned.
std::string pages_html(const ReportFacts& pages) {
    if (pages.empty()) return {};
    std::string html =
        "<section id=\"inputs\">\n<h2>The inputs, to turn</h2>\n<p>Each page draws its volume in the browser, with the "
        "colours and opacities, a clip plane and values at a click.</p>\n<ul>\n";
    for (const auto& [name, path] : pages) {
        html += "<li><a href=\"" + escaped(path) + "\">" + escaped(spaced(name)) + "</a></li>\n";
    }
    return html + "</ul>\n</section>\n";
}

}  // namespace

std::vector<StudyPlot> make_plots(const StudyResults& results) {
    std::vector<StudyPlot> all;
    for (const StudyPlotSpec& spec : results.study.plots) {
        for (PlotPanel& panel : plot_panels(results, spec)) {
            all.push_back({plot_name(results.study, all.size() + 1), std::move(panel.plot)});
        }
    }
    return all;
}

std::vector<Judgement> judge(const StudyResults& results) {
    std::vector<Judgement> all;
    for (const StudyDemand& demand : results.study.demands) all.push_back(judged(results, demand));
    return all;
}

std::string report_html(std::span<const StudyResults> studies, const std::filesystem::path& folder,
                        const ReportOptions& options) {
    const std::string script = "\n" + std::string(embedded("slider")), style = "\n" + std::string(embedded("style"));
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n" + html_policy(script, style);
    html +=
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n<title>Error studies of subdivision volumes</title>\n<style>";
    html += style + "</style>\n</head>\n<body>\n<header>\n<h1>Error studies of subdivision volumes</h1>\n";
    html += summary_html(studies) + "</header>\n<main>\n";
    for (const StudyResults& results : studies) html += study_html(results, folder, options);
    html += pages_html(options.pages);
    html += "<section id=\"machine\">\n<h2>Machine, versions, and how to reproduce this report</h2>\n<h3>Machine</h3>\n";
    html += facts_html(options.host) + "<h3>Versions</h3>\n" + facts_html(options.versions) + citation_html(options);
    html += "<h3>Command</h3>\n<pre>" + escaped(options.command) +
            "</pre>\n<p class=\"soft\">In the same folder, only unfinished cases are run; <code>--fresh</code> runs all "
            "cases.</p>\n";
    return html + "</section>\n</main>\n<script>" + script + "</script>\n</body>\n</html>\n";
}

}  // namespace subvol
