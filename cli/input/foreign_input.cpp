// SPDX-License-Identifier: Apache-2.0
// A file of another program becomes the text of a .vtu:
//
//     FILE ── python3 -c CONVERTER FILE /dev/fd/3 ──► a file without a name ──► text
//                     └── what read it, what is left out, or an error, as an object on its standard output
//
// The file between has no name, so that nothing remains of it however this program or the child ends. The child ends when this
// program is interrupted or ends. It has a time limit of its own, and a reader that crashes ends a process below the child
// alone.
#include "foreign_input.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "child_process.h"
#include "interrupt.h"
#include "subvol/error.h"
#include "subvol/foreign_files.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr const char* kDebiansPython = "/usr/bin/python3";

// Runs the program that follows as an argument, which imports nothing from the current folder: not even what a program does
// before its first line, such as __future__.
constexpr const char* kRunIsolated = "import sys; sys.path[:] = filter(None, sys.path); exec(sys.argv.pop(1))";

constexpr int kUnwritten = 4;  // the converter's exit code

/// A file of this process that has no name any more.
class NamelessFile {
public:
    NamelessFile() {
        std::error_code none;
        const std::filesystem::path folder = std::filesystem::temp_directory_path(none);
        std::string name = ((none ? std::filesystem::path("/tmp") : folder) / "subvol-XXXXXX").string();
        number_ = mkostemp(name.data(), O_CLOEXEC);
        if (number_ < 0) {
            throw Error(ErrorCode::Io, "a temporary file cannot be made: " + std::generic_category().message(errno),
                        folder.string(), "TMPDIR names a folder for it");
        }
        unlink(name.c_str());
    }
    ~NamelessFile() { close(number_); }
    NamelessFile(const NamelessFile&) = delete;
    NamelessFile& operator=(const NamelessFile&) = delete;

    [[nodiscard]] int number() const { return number_; }

    [[nodiscard]] std::string text() const {
        struct stat about {};
        if (fstat(number_, &about) != 0) return {};
        std::string text(static_cast<std::size_t>(about.st_size), '\0');
        std::size_t done = 0;
        while (done < text.size()) {
            const ssize_t count = pread(number_, text.data() + done, text.size() - done, static_cast<off_t>(done));
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) break;
            done += static_cast<std::size_t>(count);
        }
        text.resize(done);
        return text;
    }

private:
    int number_ = -1;
};

/// The programs python3 to ask, in order.
std::vector<std::string> interpreters() {
    std::vector<std::string> found;
    const char* path = std::getenv("PATH");
    std::string folders = path == nullptr ? "" : path;
    for (std::size_t begin = 0; begin < folders.size() && found.empty();) {
        const std::size_t end = std::min(folders.find(':', begin), folders.size());
        const std::string file = folders.substr(begin, end - begin) + "/python3";
        if (file.starts_with('/') && access(file.c_str(), X_OK) == 0) found.push_back(file);
        begin = end + 1;
    }
    std::error_code none;
    // Folders, because the program of a virtual environment is a link to Debian's, and finds other packages.
    const auto folder = [](const std::filesystem::path& file) { return file.parent_path(); };
    const bool same = !found.empty() && std::filesystem::equivalent(folder(found.front()), folder(kDebiansPython), none);
    if (!same && access(kDebiansPython, X_OK) == 0) found.emplace_back(kDebiansPython);
    return found;
}

/// The object that the converter prints; an error in its form if it printed none.
nlohmann::json answer_of(const ChildResult& ended) {
    nlohmann::json answer = nlohmann::json::parse(ended.out, nullptr, false);
    if (answer.is_object()) return answer;
    const std::size_t last = ended.err.find_last_not_of('\n');
    const std::string words = last == std::string::npos ? "" : ended.err.substr(0, last + 1);
    const std::string line = words.substr(words.find_last_of('\n') + 1);
    const std::string how = ended.signal != 0 ? text("by signal ", ended.signal) : text("with exit code ", ended.code);
    return {{"message", "python3 ended " + how + (line.empty() ? "" : ": " + line)}, {"allowed", ""}, {"missing", {""}}};
}

ErrorCode code_of(int ended) {
    if (ended == 2) return ErrorCode::InvalidInput;
    return ended == kUnwritten ? ErrorCode::Io : ErrorCode::MissingCapability;
}

ForeignFile file_of(const nlohmann::json& answer) {
    ForeignFile file;
    file.times = answer.at("times").get<std::vector<double>>();
    if (!answer.contains("by")) return file;  // only the times
    file.warnings.push_back(text("read by ", answer.at("by").get<std::string>(), " (", answer.at("program").get<std::string>(),
                                 "); ", answer.at("left").get<std::string>(), " not read"));
    for (const auto& warning : answer.at("warnings")) file.warnings.push_back(warning);
    return file;
}

ForeignFile convert(const std::filesystem::path& path, const ForeignRequest& request) {
    std::vector<std::string> words{"-c", kRunIsolated, std::string(foreign_program()),
                                   std::filesystem::absolute(path).string()};
    if (request.only_times) words.emplace_back("--times");
    if (!request.only_times) words.emplace_back("/dev/fd/3");
    if (request.step) words.insert(words.end(), {"--step", std::to_string(*request.step)});
    const ForeignFormat& format = *foreign_format(path);
    Error error(ErrorCode::MissingCapability,
                "is a file of " + format.program + ", which " + format.by + " reads, and there is no python3 to run it",
                path.string(), "Debian: " + format.packages);
    for (const std::string& python : interpreters()) {
        const NamelessFile made;
        const ChildResult ended =
            run_program(python, words, {.file = made.number(), .no_input = true, .interrupted = SIGKILL, .orphaned = SIGKILL});
        if (interrupt_signal() != 0) throw Error(ErrorCode::Cancelled, "cancelled");
        const nlohmann::json answer = answer_of(ended);
        if (answer.contains("times")) {
            ForeignFile file = file_of(answer);
            if (!request.only_times) file.vtu = made.text();
            return file;
        }
        const bool lacks = !answer.at("missing").empty();
        const Error found(code_of(ended.code), answer.at("message").get<std::string>(), path.string(),
                          answer.at("allowed").get<std::string>());
        // What one says of the file is more than what the next one lacks.
        if (error.code() == ErrorCode::MissingCapability || found.code() != ErrorCode::MissingCapability) error = found;
        if (!lacks) break;
    }
    throw error;
}

}  // namespace

void read_foreign_inputs() {
    // The completion of a shell asks for the fields of a file while somebody types, and python3 takes its time.
    if (std::getenv("SUBVOL_COMPLETION") == nullptr) read_foreign_files(convert);
}

}  // namespace subvol::cli
