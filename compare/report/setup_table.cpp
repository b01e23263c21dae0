// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "subvol/study_report.h"
#include "subvol/study_table.h"

namespace subvol {

namespace {

double metric(const CaseResult& result, const std::string& key) {
    const auto found = result.metrics.find(key);
    return found == result.metrics.end() ? std::nan("") : found->second;
}

std::string camera_words(const StudyCase& study_case) {
    const std::string camera = study_case.has("camera") ? study_case.text("camera") : "";
    return camera.empty() || camera == study_case.text("view") ? study_case.text("view")
                                                               : study_case.text("view") + ": " + camera;
}

std::string size_words(const StudyCase& study_case) {
    if (!study_case.has("width") || !study_case.has("height")) return "";
    return as_text(study_case.values.at("width")) + " × " + as_text(study_case.values.at("height"));
}

std::string light_words(const StudyCase& study_case) {
    std::string words = study_case.has("tf") ? study_case.text("tf") : "";
    if (study_case.has("tf.colors") && study_case.text("tf.colors") != words) words += ": " + study_case.text("tf.colors");
    if (study_case.has("tf.opacity")) words += ", opacity " + study_case.text("tf.opacity");
    if (study_case.has("tf.opacity_unit")) words += " per " + as_text(study_case.values.at("tf.opacity_unit"));
    return words;
}

/// Calls call(case, its result, whether the reference converged) for the first case of each reference.
template <class Call>
void each_reference(const StudyResults& results, const Call& call) {
    std::set<std::string> known;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        const CaseResult& result = results.results[i];
        const auto reference = result.notes.find("reference");
        if (reference == result.notes.end() || !known.insert(reference->second).second) continue;
        const bool converged = !result.metrics.contains("reference_converged") || metric(result, "reference_converged") == 1;
        call(results.study.cases[i], result, converged);
    }
}

}  // namespace

std::vector<ReferenceState> reference_states(const StudyResults& results) {
    std::vector<ReferenceState> all;
    each_reference(results, [&](const StudyCase& study_case, const CaseResult&, bool converged) {
        std::string name;
        for (const char* key : {"input", "view", "tf"}) {
            if (study_case.has(key)) name += (name.empty() ? "" : ", ") + spaced(as_text(study_case.values.at(key)));
        }
        all.push_back({name, converged});
    });
    return all;
}

std::optional<StudyTable> setup_table(const StudyResults& results) {
    StudyTable table{
        .name = results.study.name + "_setup",
        .title = "Meshes, cameras and references",
        .caption =
            "Each picture is compared with its reference. The reference is refined level by level; each metric of it "
            "and the picture of the level before is the floor of that metric: errors below it are marked ≤, a PSNR "
            "or an SSIM above it ≥.",
        .columns = {"mesh", "cells", "points", "camera", "eye, target, up, field of view", "transfer function", "pixels",
                    "reference level", "converged", "last change (RMS)", "known to (dB)"},
        .rows = {}};
    std::vector<std::string> metrics;
    for (const CaseResult& result : results.results) {
        for (const auto& [key, value] : result.metrics) {
            if (key.starts_with("floor_") && std::ranges::find(metrics, key) == metrics.end()) metrics.push_back(key);
        }
    }
    for (const std::string& key : metrics) table.columns.push_back("floor of " + key.substr(6));
    each_reference(results, [&](const StudyCase& study_case, const CaseResult& result, bool converged) {
        const auto camera = result.notes.find("camera_used");
        auto& row = table.rows.emplace_back(std::vector<StudyTable::Cell>{
            spaced(study_case.text("input")), metric(result, "cells"), metric(result, "points"), camera_words(study_case),
            camera == result.notes.end() ? "–" : camera->second, light_words(study_case), size_words(study_case),
            metric(result, "reference_level"), std::string(converged ? "yes" : "no"), metric(result, "reference_change"),
            -20 * std::log10(metric(result, "reference_change"))});
        for (const std::string& key : metrics) row.emplace_back(metric(result, key));
    });
    if (table.rows.empty()) return {};
    return table;
}

}  // namespace subvol
