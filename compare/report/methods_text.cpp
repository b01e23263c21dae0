// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "report_parts.h"
#include "subvol/study_report.h"

namespace subvol::detail {

namespace {

/// "a", "a and b", "a, b and c", in the order of the cases.
std::string listed(const std::vector<std::string>& words) {
    std::string all;
    for (std::size_t i = 0; i < words.size(); ++i) all += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
    return all;
}

std::vector<std::string> different(const StudyResults& results, const std::string& key) {
    std::vector<std::string> all;
    for (const StudyCase& study_case : results.study.cases) {
        if (!study_case.has(key)) continue;
        const std::string value = spaced(as_text(study_case.values.at(key)));
        if (std::ranges::find(all, value) == all.end()) all.push_back(value);
    }
    return all;
}

/// "3", or "3 to 5"; "" if no case has the metric.
std::string range_of(const StudyResults& results, const std::string& key, int digits) {
    double least = INFINITY, most = -INFINITY;
    for (const CaseResult& result : results.results) {
        const auto found = result.metrics.find(key);
        if (found == result.metrics.end()) continue;
        least = std::min(least, found->second);
        most = std::max(most, found->second);
    }
    if (!(least <= most)) return {};
    return readable(least, digits) + (least < most ? " to " + readable(most, digits) : "");
}

/// How many references there are, and how many did not converge.
std::pair<std::size_t, std::size_t> unconverged(const StudyResults& results) {
    const auto references = reference_states(results);
    return {references.size(),
            static_cast<std::size_t>(std::ranges::count_if(references, [](const auto& one) { return !one.converged; }))};
}

std::string method_names(const StudyResults& results) {
    static const std::map<std::string, std::string> kWords{{"splat", "splatting of radial basis functions"},
                                                           {"sheets", "image-aligned sheet buffers"},
                                                           {"footprints", "footprints of kernels that are classified first"},
                                                           {"tets", "rays through tetrahedra"},
                                                           {"pt", "projected tetrahedra"},
                                                           {"dense", "rays through dense grids of the cells"},
                                                           {"grid", "rays through a voxel grid"},
                                                           {"exact", "rays through the closed form of the field"},
                                                           {"file", "other programs"}};
    std::vector<std::string> all;
    for (const std::string& name : different(results, "method")) {
        if (const auto found = kWords.find(name); found != kWords.end()) all.push_back(found->second);
    }
    return listed(all);
}

}  // namespace

std::string methods_text(const StudyResults& results, const std::string& program, const std::string& machine) {
    const std::string changes = range_of(results, "reference_change", 2), methods = method_names(results);
    if (changes.empty() || methods.empty()) return {};
    std::string text = "The control meshes (" + listed(different(results, "input")) + "; " + range_of(results, "cells", 4) +
                       " hexahedra) were drawn with emission and absorption by " + methods + ", at " +
                       listed(different(results, "width")) + " × " + listed(different(results, "height")) + " pixels. ";
    text +=
        "Each picture was compared, in linear RGB with peak 1 over all pixels unless a metric says otherwise, with a "
        "reference: ";
    const std::string levels = range_of(results, "reference_level", 2);  // none of a closed form
    text += levels.empty() ? "rays through the closed form of the field, with steps that were halved"
                           : "rays through the dense grid of the limit volume, refined level by level";
    text += " until the root mean square of the picture's change was below " +
            listed(different(results, "reference.tolerance")) + " (" + (levels.empty() ? "" : "levels " + levels + "; ") +
            "last changes " + changes + "). ";
    const auto [references, open] = unconverged(results);
    if (open > 0) {
        text += std::to_string(open) + " of " + std::to_string(references) +
                " references did not converge: they still changed by more at the last level that was allowed. ";
    }
    text +=
        "The floor of each metric is its value between the reference and the picture of the level before; figures beyond their "
        "floors are given as bounds. ";
    if (results.study.timed) text += "Times are of single runs, one after the other, on " + machine + ". ";
    return text + "All figures were computed by " + program + ".";
}

}  // namespace subvol::detail
