// SPDX-License-Identifier: Apache-2.0
#include "child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

#include "interrupt.h"
#include "subvol/error.h"

namespace subvol::cli {
namespace {

constexpr std::size_t kMaxOutput = 16 << 20;
constexpr int kLookForInterrupts_ms = 100;

struct Pipe {
    std::array<int, 2> ends{-1, -1};

    Pipe() {
        if (pipe2(ends.data(), O_CLOEXEC) != 0) {
            throw Error(ErrorCode::MissingCapability, std::generic_category().message(errno), "study");
        }
    }
    ~Pipe() {
        close_end(0);
        close_end(1);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    void close_end(std::size_t end) {
        if (ends[end] >= 0) close(ends[end]);
        ends[end] = -1;
    }
};

/// Reads both pipes to their end; passes an interrupt on to the child as a signal.
void drain(Pipe& out, Pipe& err, pid_t child, int signal, ChildResult& result) {
    bool passed_on = false;
    const pid_t whom = signal == SIGKILL ? -child : child;  // the child's group, as it cannot pass it on
    std::array<pollfd, 2> files{pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
    const std::array<std::string*, 2> texts{&result.out, &result.err};
    while (files[0].fd >= 0 || files[1].fd >= 0) {
        if (poll(files.data(), files.size(), kLookForInterrupts_ms) < 0 && errno != EINTR) return;
        if (!passed_on && interrupt_signal() != 0) passed_on = kill(whom, signal) == 0;
        for (std::size_t i = 0; i < 2; ++i) {
            if (files[i].fd < 0 || files[i].revents == 0) continue;
            std::array<char, 1 << 16> bytes;
            const ssize_t count = read(files[i].fd, bytes.data(), bytes.size());
            if (count > 0 && texts[i]->size() < kMaxOutput) texts[i]->append(bytes.data(), static_cast<std::size_t>(count));
            if (count == 0 || (count < 0 && errno != EINTR)) files[i].fd = -1;
        }
    }
}

}  // namespace

ChildResult run_self(const std::vector<std::string>& arguments) {
    // A child ends with its parent and leaves no unfinished file either. Not SIGTERM, which `drain` may just have passed
    // on: a second one would end it at once.
    return run_program("/proc/self/exe", arguments, {.orphaned = SIGPIPE});
}

ChildResult run_program(const std::string& path, const std::vector<std::string>& arguments, const ChildOptions& options) {
    constexpr int kFile = 3;
    Pipe out, err;
    std::string name = path == "/proc/self/exe" ? "subvol" : path;
    std::vector<std::string> copies = arguments;
    std::vector<char*> argv{name.data()};
    for (std::string& argument : copies) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) throw Error(ErrorCode::MissingCapability, std::generic_category().message(errno), "study");
    if (child == 0) {   // only calls that are safe between fork and exec
        setpgid(0, 0);  // so that Ctrl-C reaches it only once, through us
        prctl(PR_SET_PDEATHSIG, options.orphaned);
        if (getppid() != parent) _exit(127);  // the parent has ended meanwhile
        dup2(out.ends[1], STDOUT_FILENO);
        dup2(err.ends[1], STDERR_FILENO);
        if (options.no_input) {
            if (const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC); nothing >= 0) dup2(nothing, STDIN_FILENO);
        }
        if (options.file == kFile) (void)fcntl(kFile, F_SETFD, 0);  // dup2 would leave it closed by exec
        if (options.file >= 0) dup2(options.file, kFile);
        execv(path.c_str(), argv.data());
        _exit(127);
    }
    out.close_end(1);
    err.close_end(1);
    const WaitsForChild waits;
    ChildResult result;
    drain(out, err, child, options.interrupted, result);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
    return result;
}

}  // namespace subvol::cli
