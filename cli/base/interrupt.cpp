// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
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

/// The files are removed last: other threads still run, and may open one.
[[noreturn]] void end_now() {
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

}  // namespace

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
