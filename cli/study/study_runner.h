// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "subvol/study_report.h"
#include "subvol/study_run.h"

namespace subvol::cli {

/// The machine: processor, cores, memory, system.
[[nodiscard]] ReportFacts study_host();

/// The versions of this program and of what it was built with.
[[nodiscard]] ReportFacts study_versions();

/// Runs each case in a separate process, so that its peak memory can be measured and a crash does not end other cases.
///
/// Finished references are kept in one folder for all studies; each is made once.
class StudyRunner {
public:
    /// folder:  of the output of all studies
    /// threads: of one case; reference_threads: of a reference
    StudyRunner(std::filesystem::path folder, int threads, int reference_threads)
        : folder_(std::move(folder)), threads_(threads), reference_threads_(reference_threads) {}

    /// study: the name of its folder
    [[nodiscard]] CaseResult run(const StudyCase& item, const std::string& study);

private:
    void make_reference(const StudyCase& reference);
    [[nodiscard]] CaseResult in_child(const StudyCase& item, const std::string& study, int threads) const;

    std::filesystem::path folder_;
    int threads_, reference_threads_;
    std::mutex mutex_;
    std::map<std::string, std::string> references_;  // references tried in this run, with their failures or ""
};

/// The child process's part: runs a case given as JSON. study: empty for a reference
[[nodiscard]] CaseResult run_given_case(const std::string& json, const std::filesystem::path& folder, const std::string& study);

}  // namespace subvol::cli
