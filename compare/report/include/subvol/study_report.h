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

struct ReportOptions {
    /// The machine and the programs that the studies ran with, by names such as "processor", "subvol", "commit", "date".
    ReportFacts host, versions;
    std::string command;  ///< the command that runs the studies again
    /// Names of inputs, and pages that draw them (`make_page`), as paths from the report's folder; linked to.
    ReportFacts pages{};
};

/// A demand of a study, and whether it is met.
struct Judgement {
    std::string words;      ///< the demand and the result, for people
    std::size_t cases = 0;  ///< how many cases it applies to
    std::size_t met = 0;    ///< how many of the cases meet it
    [[nodiscard]] bool all_met() const { return met == cases && cases > 0; }
};

[[nodiscard]] std::vector<Judgement> judge(const StudyResults& results);

/// A reference that cases were compared with.
struct ReferenceState {
    std::string name;  ///< names its mesh, camera and transfer function
    bool converged = true;
};

/// The references of a study, in the order of the cases that they are of.
[[nodiscard]] std::vector<ReferenceState> reference_states(const StudyResults& results);

struct StudyPlot {
    std::string name;  ///< the name of its files, without ending
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
