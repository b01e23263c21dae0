// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "subvol/progress.h"
#include "subvol/study.h"

namespace subvol {

/// What came of a case.
///
/// metrics: the same every time
/// costs:   seconds, cpu_seconds, peak_bytes: other ones every time
/// files:   names relative to the study's folder
/// notes:   a device, warnings
/// failure: a sentence; empty: the case is done
struct CaseResult {
    std::map<std::string, double> metrics{};
    std::map<std::string, double> costs{};
    std::map<std::string, std::string> files{};
    std::map<std::string, std::string> notes{};
    std::string failure{};
};

/// Does the work of a case. What it throws, but for Error(Cancelled), is the case's failure. Called from several threads at
/// once if there are several jobs.
using CaseWork = std::function<CaseResult(const StudyCase&)>;

/// folder:   made if need be; cases/ID.json for each case, results.csv, costs.csv
/// jobs:     cases that run at the same time; a timed study has one
/// fresh:    nothing is taken over from an earlier run
/// finished: told of each case as it ends, one at a time; ran: it was not taken over
struct StudyRunOptions {
    std::filesystem::path folder;
    int jobs = 1;
    bool fresh = false;
    std::function<void(const StudyCase&, const CaseResult&, bool ran)> finished{};
    Progress* progress = nullptr;
};

/// results: one a case, in their order
/// ran:     cases that were run now; failed: of all of them
struct StudyResults {
    Study study;
    std::vector<CaseResult> results;
    std::size_t ran = 0;
    std::size_t failed = 0;
};

/// Runs the cases of a study that an earlier run has not finished. Each case is written as soon as it is done, beside and
/// renamed: a run that is killed loses what was running. A failed case is kept with its message, and tried again by the next
/// run.
///
/// throws: Error(Io) if the folder cannot be written to, Error(Cancelled)
[[nodiscard]] StudyResults run_study(const Study& study, const CaseWork& work, const StudyRunOptions& options);

/// One file of a case, and back; none if there is no such file, or not of this case, or it failed or is damaged, or files of
/// its result in `folder` are gone.
void write_case(const std::filesystem::path& file, const StudyCase& of, const CaseResult& result);
[[nodiscard]] std::optional<CaseResult> read_finished_case(const std::filesystem::path& file, const StudyCase& of,
                                                           const std::filesystem::path& folder);

/// A result as a JSON object and back.
///
/// throws: Error(InvalidInput) if the text is no result
[[nodiscard]] std::string to_json(const CaseResult& result);
[[nodiscard]] CaseResult case_result_from_json(std::string_view json);

/// Comma-separated values: a line a case, in the study's order. Results have the values, the metrics and the failure, and are
/// the same bytes for every run, interrupted or not; costs have what is measured.
[[nodiscard]] std::string results_csv(const StudyResults& results);
[[nodiscard]] std::string costs_csv(const StudyResults& results);

}  // namespace subvol
