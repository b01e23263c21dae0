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

std::string camera_words(const StudyCase& of) {
    const std::string camera = of.has("camera") ? of.text("camera") : "";
    return camera.empty() || camera == of.text("view") ? of.text("view") : of.text("view") + ": " + camera;
}

std::string size_words(const StudyCase& of) {
    if (!of.has("width") || !of.has("height")) return "";
    return as_text(of.values.at("width")) + " × " + as_text(of.values.at("height"));
}

std::string light_words(const StudyCase& of) {
    std::string words = of.has("tf") ? of.text("tf") : "";
    if (of.has("tf.colors") && of.text("tf.colors") != words) words += ": " + of.text("tf.colors");
    if (of.has("tf.opacity")) words += ", opacity " + of.text("tf.opacity");
    if (of.has("tf.opacity_unit")) words += " per " + as_text(of.values.at("tf.opacity_unit"));
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
        const StudyCase& of = results.study.cases[i];
        const CaseResult& result = results.results[i];
        const auto reference = result.notes.find("reference");
        if (reference == result.notes.end() || !known.insert(reference->second).second) continue;
        const double change = metric(result, "reference_change");
        table.rows.push_back({spaced(of.text("input")), metric(result, "cells"), metric(result, "points"), camera_words(of),
                              light_words(of), size_words(of), metric(result, "reference_level"), change,
                              -20 * std::log10(change)});
    }
    if (table.rows.empty()) return {};
    return table;
}

}  // namespace subvol
