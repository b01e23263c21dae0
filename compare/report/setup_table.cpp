// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

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

}  // namespace

std::optional<StudyTable> setup_table(const StudyResults& results) {
    StudyTable table{.name = results.study.name + "_setup",
                     .title = "Meshes, cameras and references",
                     .caption =
                         "Each picture is compared with its reference. The reference is refined level by level; the RMS of its "
                         "last change says how well the figures are known: errors below it are marked ≤, a PSNR above it ≥.",
                     .columns = {"mesh", "cells", "points", "camera", "transfer function", "pixels", "reference level",
                                 "last change (RMS)", "known to (dB)"},
                     .rows = {}};
    std::set<std::string> known;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        const StudyCase& study_case = results.study.cases[i];
        const CaseResult& result = results.results[i];
        const auto reference = result.notes.find("reference");
        if (reference == result.notes.end() || !known.insert(reference->second).second) continue;
        const double change = metric(result, "reference_change");
        table.rows.push_back({spaced(study_case.text("input")), metric(result, "cells"), metric(result, "points"),
                              camera_words(study_case), light_words(study_case), size_words(study_case),
                              metric(result, "reference_level"), change, -20 * std::log10(change)});
    }
    if (table.rows.empty()) return {};
    return table;
}

}  // namespace subvol
