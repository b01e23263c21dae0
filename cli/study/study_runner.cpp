// SPDX-License-Identifier: Apache-2.0
#include "study_runner.h"

#include <sys/utsname.h>
#include <tbb/global_control.h>
#include <tbb/version.h>
#include <unistd.h>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <set>

#include "child_process.h"
#include "commit.h"
#include "study_work.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/version.h"
#include "text.h"

namespace subvol::cli {

namespace {

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with("model name")) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

/// The date of the report; SOURCE_DATE_EPOCH sets it.
std::string today() {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t now = epoch ? std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
    std::array<char, 16> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%d", std::gmtime(&now));
    return text.data();
}

std::string opengl() {
    std::vector<std::string> names;
    for (const GlDevice& device : gl_devices()) names.push_back(device.renderer);
    return names.empty() ? "none" : join(names);
}

}  // namespace

ReportFacts study_host() {
    utsname system{};
    uname(&system);
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return {{"processor", processor()},
            {"cores", text(sysconf(_SC_NPROCESSORS_ONLN))},
            {"threads used", text(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism))},
            {"memory", text(std::round(memory / (1 << 30)), " GiB")},
            {"OpenGL", opengl()},
            {"system", text(system.sysname, ' ', system.release, ' ', system.machine)}};
}

ReportFacts study_versions() {
    return {{"subvol", SUBVOL_VERSION},
            {"commit", SUBVOL_COMMIT},
            {"date", today()},
            {"oneTBB", TBB_runtime_version()},
            {"compiler", __VERSION__}};
}
namespace {

constexpr const char* kReferences = "references";

/// Whether the child ended because of a signal to stop, either by itself or by its own handler.
bool interrupted(const ChildResult& ended) {
    constexpr int kBySignal = 128;
    const int signal = ended.signal != 0 ? ended.signal : ended.code - kBySignal;
    return signal == SIGINT || signal == SIGTERM || signal == SIGHUP;
}

/// The last line of the program's error output, without the program's name.
std::string last_error(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    text = text.substr(text.rfind('\n') + 1);
    const std::string self = "subvol: ";
    return text.starts_with(self) ? text.substr(self.size()) : text;
}

}  // namespace

CaseResult StudyRunner::run(const StudyCase& item, const std::string& study) {
    if (const auto reference = reference_of(item)) make_reference(*reference);
    return in_child(item, study, threads_);
}

void StudyRunner::make_reference(const StudyCase& reference) {
    const std::lock_guard lock(mutex_);  // one at a time, because each uses all threads
    if (const auto known = references_.find(reference.id); known != references_.end()) {
        if (known->second.empty()) return;
        throw Error(ErrorCode::InvalidInput, known->second, "its reference");
    }
    const std::filesystem::path file = folder_ / kReferences / (reference.id + ".json");
    std::string& failure = references_[reference.id];
    if (read_finished_case(file, reference, folder_ / kReferences)) return;
    try {
        std::filesystem::create_directories(folder_ / kReferences);
        write_case(file, reference, in_child(reference, "", reference_threads_));
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;
        failure = error.what();
        throw Error(error.code(), failure, "its reference");
    }
}

CaseResult StudyRunner::in_child(const StudyCase& item, const std::string& study, int threads) const {
    std::vector<std::string> arguments{"study",          "--case", to_json(item), "-o",
                                       folder_.string(), "--json", "--threads",   std::to_string(threads)};
    if (!study.empty()) arguments.insert(arguments.end(), {"--case-of", study});
    const ChildResult ended = run_self(arguments);
    if (interrupted(ended)) throw Error(ErrorCode::Cancelled, "interrupted");
    if (ended.signal != 0) {
        throw Error(ErrorCode::MissingCapability,
                    text("the case was ended by signal ", ended.signal, " (", strsignal(ended.signal), ")"));
    }
    if (ended.code != 0) throw Error(ErrorCode::InvalidInput, last_error(ended.err));
    return case_result_from_json(ended.out);
}

CaseResult run_given_case(const std::string& json, const std::filesystem::path& folder, const std::string& study) {
    const StudyCase item = study_case_from_json(json);
    const CasePlace place{folder / study, folder / kReferences};
    return study.empty() ? run_reference(item, place) : run_case(item, place);
}

}  // namespace subvol::cli
