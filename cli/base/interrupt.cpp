// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "subvol/detail/atomic_file.h"

namespace subvol::cli {
namespace {

constexpr int kBySignal = 128;  // as shells count

volatile std::sig_atomic_t interrupted = 0;
volatile std::sig_atomic_t extensions = 0;
std::atomic<int> children = 0;
std::atomic<bool> speaks = false, has_spoken = false;  // whoever is first says the last words
bool another_speaks = false;                           // another process, for all

struct LastWords {
    int signal;
    std::array<char, 512> words{};
};
std::array<LastWords, 3> last_words{{{SIGINT}, {SIGTERM}, {SIGHUP}}};

void start_timer() {
    const itimerval grace{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = 1000 * kGrace_ms}};
    setitimer(ITIMER_REAL, &grace, nullptr);
}

void write_all(int stream, std::string_view words) {
    (void)!write(stream, words.data(), words.size());
}

#ifdef __linux__
std::atomic<int> held_threads = 0;

void hold_thread(int /*signal*/) {
    ++held_threads;
    for (;;) pause();
}

/// The number of other threads, each of which gets the signal. Nothing here allocates: a thread may be held in an allocation.
int signal_other_threads(int signal) {
    const int folder = open("/proc/self/task", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return 0;
    const pid_t self = gettid();
    int others = 0;
    alignas(dirent64) std::array<char, 4096> entries;
    for (ssize_t bytes = 0; (bytes = getdents64(folder, entries.data(), entries.size())) > 0;) {
        for (ssize_t at = 0; at < bytes;) {
            const auto& entry = *reinterpret_cast<const dirent64*>(&entries[static_cast<std::size_t>(at)]);
            at += entry.d_reclen;
            const pid_t thread = std::atoi(&entry.d_name[0]);  // 0: "." and ".."
            if (thread != 0 && thread != self && tgkill(getpid(), thread, signal) == 0) ++others;
        }
    }
    close(folder);
    return others;
}

/// All other threads stand still from here on, but for one that waits for a disk: none makes a file, or makes again by its
/// name what is being removed. Of threads that come here at once, one goes on.
void hold_other_threads() {
    constexpr int kTries = 200;
    constexpr useconds_t kPause_us = 500;
    const int signal = SIGRTMIN + 5;
    struct sigaction hold {};
    hold.sa_handler = hold_thread;
    sigfillset(&hold.sa_mask);
    sigset_t others = hold.sa_mask;
    sigdelset(&others, signal);
    sigaction(signal, &hold, nullptr);
    pthread_sigmask(SIG_BLOCK, &others, nullptr);  // another signal here would wait for what this thread does
    static std::atomic<bool> ends = false;
    while (ends.exchange(true)) pause();
    for (int k = 0; k < kTries && signal_other_threads(signal) > held_threads; ++k) usleep(kPause_us);
}
#else
void hold_other_threads() {
}
#endif

/// The files are removed last, when no other thread can make one any more.
[[noreturn]] void end_now() {
    hold_other_threads();
    detail::remove_unfinished_files();
    _exit(kBySignal + interrupted);
}

/// Some stages cannot stop in time: libraries that read and write files, a mesh of millions of cells that is freed.
void on_timer(int /*signal*/) {
    constexpr int kMostExtensions = 4;
    if (children > 0 && extensions < kMostExtensions) {
        extensions = extensions + 1;
        return start_timer();
    }
    if (speaks.exchange(true)) {
        if (!has_spoken && extensions < kMostExtensions) {
            extensions = extensions + 1;
            return start_timer();
        }
        end_now();
    }
    if (another_speaks) end_now();
    write_all(STDERR_FILENO, isatty(STDERR_FILENO) != 0 ? "\r\033[Ksubvol: cancelled\n" : "subvol: cancelled\n");
    for (const LastWords& last : last_words) {
        if (last.signal == interrupted) write_all(STDOUT_FILENO, last.words.data());
    }
    end_now();
}

void on_interrupt(int signal) {
    interrupted = signal;
    std::signal(signal, SIG_DFL);
    start_timer();
}

/// Nobody reads any more what is written, as after "| head": the program ends without a word, as it would without this, but
/// leaves no unfinished file.
void on_closed_pipe(int signal) {
    interrupted = signal;
    end_now();
}

constexpr int kEnvironment = 3;

[[noreturn]] void end_after_failure(std::string_view sentence) {
    hold_other_threads();
    detail::remove_unfinished_files();
    write_all(STDERR_FILENO, sentence);
    _exit(kEnvironment);
}

[[noreturn]] void on_terminate() {
    end_after_failure("subvol: a library failed; memory or threads may be short\n");
}

[[noreturn]] void on_abort(int /*signal*/) {
    on_terminate();
}

void on_crash(int signal) {
    hold_other_threads();
    detail::remove_unfinished_files();
    write_all(STDERR_FILENO, "subvol: the program or a library crashed; memory may be short\n");
    std::signal(signal, SIG_DFL);
    sigset_t this_one;
    sigemptyset(&this_one);
    sigaddset(&this_one, signal);
    pthread_sigmask(SIG_UNBLOCK, &this_one, nullptr);
    raise(signal);
}

}  // namespace

void catch_failures() {
    std::set_terminate(on_terminate);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they report where it happened
    std::signal(SIGABRT, on_abort);
    // A stack that has overflowed has no room for a handler.
    static std::array<char, std::size_t{1} << 16> memory;
    const stack_t stack{.ss_sp = memory.data(), .ss_flags = 0, .ss_size = memory.size()};
    sigaltstack(&stack, nullptr);
    struct sigaction crash {};
    crash.sa_handler = on_crash;
    crash.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) sigaction(signal, &crash, nullptr);
#endif
}

void catch_interrupts(bool silent) {
    another_speaks = silent;
    std::signal(SIGALRM, on_timer);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        if (std::signal(signal, on_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    if (std::signal(SIGPIPE, on_closed_pipe) == SIG_IGN) std::signal(SIGPIPE, SIG_IGN);
}

void say_when_interrupted(const std::function<std::string(int code)>& json) {
    for (LastWords& last : last_words) {
        const std::string words = json(kBySignal + last.signal);
        if (words.size() < last.words.size()) *std::ranges::copy(words, last.words.begin()).out = '\0';
    }
}

void say_at_last(const std::function<void()>& say) {
    static bool ours = false;                        // words may be followed by others: that these could not be written
    while (!ours && speaks.exchange(true)) pause();  // until the timer ends the program
    ours = true;
    say();
    has_spoken = true;
}

WaitsForChild::WaitsForChild() {
    ++children;
}

WaitsForChild::~WaitsForChild() {
    --children;
}

int interrupt_signal() {
    return interrupted;
}

}  // namespace subvol::cli
