// SPDX-License-Identifier: Apache-2.0
#include "subvol/study_run.h"
#include "subvol/detail/atomic_file.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace fs = std::filesystem;

namespace {

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder)) throw Error(ErrorCode::Io, "the folder cannot be created", folder.string());
}

fs::path case_file(const fs::path& folder, const StudyCase& study_case) {
    return folder / "cases" / (study_case.id + ".json");
}

/// The state that threads share.
class Run {
public:
    Run(const Study& study, const CaseWork& work, const StudyRunOptions& options) : work_(work), options_(options) {
        all_.study = study;
        all_.results.resize(study.cases.size());
    }

    StudyResults finish() {
        const std::size_t jobs = all_.study.timed ? 1 : static_cast<std::size_t>(std::max(options_.jobs, 1));
        take_over();
        run_with(std::min(jobs, open_.size()));
        if (stopped_) std::rethrow_exception(stopped_);
        report_progress(options_.progress, all_.study.name, 1);
        for (const CaseResult& result : all_.results) all_.failed += result.failure.empty() ? 0 : 1;
        return std::move(all_);
    }

private:
    void take_over() {
        for (std::size_t i = 0; i < all_.study.cases.size(); ++i) {
            const StudyCase& study_case = all_.study.cases[i];
            auto known = options_.fresh
                             ? std::nullopt
                             : read_finished_case(case_file(options_.folder, study_case), study_case, options_.folder);
            if (!known) {
                open_.push_back(i);
                continue;
            }
            all_.results[i] = std::move(*known);
            if (options_.finished) options_.finished(study_case, all_.results[i], false);
        }
    }

    /// Runs open cases in several threads, one of which is this one.
    void run_with(std::size_t threads) {
        std::vector<std::jthread> others;
        try {
            while (others.size() + 1 < threads) others.emplace_back([this] { run_open(); });
        } catch (const std::system_error&) {  // the system has no more threads: continue with fewer
        }
        run_open();
    }

    void run_open() {
        for (std::size_t next = next_++; next < open_.size(); next = next_++) {
            const StudyCase& study_case = all_.study.cases[open_[next]];
            try {
                report_done();
                const CaseResult result = outcome(study_case);
                write_case(case_file(options_.folder, study_case), study_case, result);
                done(open_[next], result);
            } catch (...) {  // cancelled, or the folder cannot be written to: not the failure of a case
                const std::lock_guard lock(mutex_);
                if (!stopped_) stopped_ = std::current_exception();
                next_ = open_.size();
                return;
            }
        }
    }

    CaseResult outcome(const StudyCase& study_case) const {
        try {
            return work_(study_case);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;
            return {.failure = error.what()};
        } catch (const std::exception& error) {
            return {.failure = error.what()};
        }
    }

    void report_done() {
        const std::lock_guard lock(mutex_);
        const std::size_t done = all_.results.size() - open_.size() + all_.ran;
        report_progress(options_.progress,
                        all_.study.name + ", case " + std::to_string(std::min(done + 1, all_.results.size())) + " of " +
                            std::to_string(all_.results.size()),
                        static_cast<double>(done) / static_cast<double>(all_.results.size()));
    }

    void done(std::size_t index, const CaseResult& result) {
        const std::lock_guard lock(mutex_);
        all_.results[index] = result;
        ++all_.ran;
        if (options_.finished) options_.finished(all_.study.cases[index], result, true);
    }

    const CaseWork& work_;
    const StudyRunOptions& options_;
    StudyResults all_;
    std::vector<std::size_t> open_;
    std::atomic<std::size_t> next_ = 0;
    std::mutex mutex_;
    std::exception_ptr stopped_;
};

}  // namespace

StudyResults run_study(const Study& study, const CaseWork& work, const StudyRunOptions& options) {
    make_folder(options.folder / "cases");
    StudyResults results = Run(study, work, options).finish();
    write_text_file(options.folder / "results.csv", results_csv(results));
    write_text_file(options.folder / "costs.csv", costs_csv(results));
    return results;
}

StudyResults finished_results(const Study& study, const fs::path& folder) {
    StudyResults results{.study = study, .results = {}};
    results.study.cases.clear();
    for (const StudyCase& study_case : study.cases) {
        auto known = read_finished_case(case_file(folder, study_case), study_case, folder);
        if (!known) continue;
        results.study.cases.push_back(study_case);
        results.results.push_back(std::move(*known));
    }
    return results;
}

}  // namespace subvol
