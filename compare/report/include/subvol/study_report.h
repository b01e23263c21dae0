// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "subvol/plot.h"
#include "subvol/study_run.h"

namespace subvol {

/// Facts under their names, in the order in which they are shown.
using ReportFacts = std::vector<std::pair<std::string, std::string>>;

/// host, versions: the machine and the programs that the studies ran with, by names such as "processor", "subvol", "commit",
///                 "date"
/// command:        runs them again
/// pages:          of inputs, their names and pages that draw them (`make_page`), as paths from the report's folder; linked to
struct ReportOptions {
    ReportFacts host, versions;
    std::string command;
    ReportFacts pages{};
};

/// A demand of a study, and whether it is met.
///
/// words: the demand and the result, for people; cases: how many it applies to; met: how many of them meet it
struct Judgement {
    std::string words;
    std::size_t cases = 0;
    std::size_t met = 0;
    [[nodiscard]] bool all_met() const { return met == cases && cases > 0; }
};

[[nodiscard]] std::vector<Judgement> judge(const StudyResults& results);

/// A reference that cases were compared with. name: of its mesh, camera and transfer function
struct ReferenceState {
    std::string name;
    bool converged = true;
};

/// The references of a study, in the order of the cases that they are of.
[[nodiscard]] std::vector<ReferenceState> reference_states(const StudyResults& results);

/// name: of its files, without ending
struct StudyPlot {
    std::string name;
    Plot plot;
};

/// The plots of a study, each with the cases that its specification selects; as many as it has panels.
[[nodiscard]] std::vector<StudyPlot> make_plots(const StudyResults& results);

/// The report on studies as one HTML page that needs no other file (but those that `pages` names) and no network: summary,
/// tables, plots, pictures beside their references with a slider, hardware and versions. Only the slider needs scripts.
///
/// folder: the studies' pictures are in folder/NAME, references in folder/references; the page names pictures that are missing
[[nodiscard]] std::string report_html(std::span<const StudyResults> studies, const std::filesystem::path& folder,
                                      const ReportOptions& options);

}  // namespace subvol
