// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "subvol/study_run.h"

namespace subvol::cli {

/// Runs cases in processes of their own: each has its own peak of memory, and one that breaks down takes no other with it.
///
/// Finished references are in a folder of their own, for all studies; each is made once.
class StudyRunner {
public:
    /// folder:  of all studies' output
    /// threads: of one case; reference_threads: of a reference, while nothing else is measured
    StudyRunner(std::filesystem::path folder, int threads, int reference_threads)
        : folder_(std::move(folder)), threads_(threads), reference_threads_(reference_threads) {}

    /// study: its folder's name
    [[nodiscard]] CaseResult run(const StudyCase& of, const std::string& study);

private:
    void make_reference(const StudyCase& reference);
    [[nodiscard]] CaseResult in_child(const StudyCase& of, const std::string& study, int threads) const;

    std::filesystem::path folder_;
    int threads_, reference_threads_;
    std::mutex mutex_;
    std::map<std::string, std::string> references_;  // done in this run, and how they failed
};

/// The other side: does the work of a case given as JSON. study: empty: it is a reference
[[nodiscard]] CaseResult run_given_case(const std::string& json, const std::filesystem::path& folder, const std::string& study);

}  // namespace subvol::cli
