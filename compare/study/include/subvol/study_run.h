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

/// The result of a case.
struct CaseResult {
    std::map<std::string, double> metrics{};     ///< reproducible: the same in every run
    std::map<std::string, double> costs{};       ///< seconds, cpu_seconds, peak_bytes: different in every run
    std::map<std::string, std::string> files{};  ///< names relative to the study's folder
    std::map<std::string, std::string> notes{};  ///< for example a device, or warnings
    std::string failure{};                       ///< a sentence; empty if the case succeeded
};

/// Computes a case. Any exception except Error(Cancelled) becomes the case's failure. Called from several threads at once if
/// there are several jobs.
using CaseWork = std::function<CaseResult(const StudyCase&)>;

struct StudyRunOptions {
    std::filesystem::path folder;  ///< created if necessary; gets cases/ID.json for each case, results.csv, costs.csv
    int jobs = 1;                  ///< cases that run at the same time; 1 for a timed study
    bool fresh = false;            ///< run all cases, even those that an earlier run of this version finished
    /// Called for each case as it ends, one at a time; `ran` is false if an earlier run finished it.
    std::function<void(const StudyCase&, const CaseResult&, bool ran)> finished{};
    Progress* progress = nullptr;
};

struct StudyResults {
    Study study;
    std::vector<CaseResult> results;  ///< one per case, in the order of the cases
    std::size_t ran = 0;              ///< number of cases run by this call
    std::size_t failed = 0;           ///< number of failures among all cases
};

/// Runs the cases of a study that an earlier run of this version has not finished. Each case's file is written as soon as it is
/// done, and appears whole or not at all: a run that is killed loses only the cases that were running. A failed case is kept
/// with its message, and tried again by the next run.
///
/// throws: Error(Io) if the folder cannot be written to, Error(Cancelled)
[[nodiscard]] StudyResults run_study(const Study& study, const CaseWork& work, const StudyRunOptions& options);

/// What earlier runs of this version have finished in a study's folder. The study of the result has only these cases.
[[nodiscard]] StudyResults finished_results(const Study& study, const std::filesystem::path& folder);

/// Writes the file of a case, and reads it again.
///
/// returns: nothing if there is no such file, it is damaged, belongs to another case or was written by another version of this
///          library, the case failed, or files of its result are missing in `folder`
void write_case(const std::filesystem::path& file, const StudyCase& study_case, const CaseResult& result);
[[nodiscard]] std::optional<CaseResult> read_finished_case(const std::filesystem::path& file, const StudyCase& study_case,
                                                           const std::filesystem::path& folder);

/// A result as a JSON object and back.
///
/// throws: Error(InvalidInput) if the text is not a result
[[nodiscard]] std::string to_json(const CaseResult& result);
[[nodiscard]] CaseResult case_result_from_json(std::string_view json);

/// Comma-separated values: a line per case, in the study's order. Results are the values, the metrics and the failure, the same
/// bytes in every run, interrupted or not; costs are what was measured.
[[nodiscard]] std::string results_csv(const StudyResults& results);
[[nodiscard]] std::string costs_csv(const StudyResults& results);

}  // namespace subvol
