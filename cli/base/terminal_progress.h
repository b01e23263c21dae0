// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "subvol/progress.h"

namespace subvol::cli {

/// What a progress bar shows: the stage, a bar, the part that is done, and the time left or spent.
///
/// fraction: of the stage in [0,1]; 0 as long as it is not known
/// left:     the estimate of the time left, seconds; negative: not known
/// spent:    seconds since the stage began
[[nodiscard]] std::string progress_line(const std::string& stage, double fraction, double left, double spent);

/// Estimates the time left of a stage from how fast it went on lately.
class Pace {
public:
    /// seconds: since any start; not descending
    void add(double seconds, double fraction);
    void clear() { past_.clear(); }

    /// In seconds; negative while there is nothing to estimate it from.
    [[nodiscard]] double left() const;

private:
    struct Mark {
        double seconds, fraction;
    };
    std::deque<Mark> past_;
};

/// A progress bar on standard error; an interrupt cancels the work. The bar goes on between reports, so that a stage which
/// reports nothing still shows that time passes.
class TerminalProgress : public Progress {
public:
    explicit TerminalProgress(bool visible);
    ~TerminalProgress() override;
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    void report(std::string_view stage, double fraction) override;
    [[nodiscard]] bool cancelled() const override;

    /// From now on stages are those of one of several parts, as "frame 3 of 120"; the bar is that of all parts, and the time
    /// left is estimated from those that are done. Empty: no longer.
    void begin_part(const std::string& name, std::size_t index, std::size_t count);

    /// What can be done if the work turns out to be long. `say` gets one sentence, once, as soon as the estimate is more than
    /// ten seconds.
    void hint_at(std::string quicker, std::function<void(const std::string&)> say);

    /// Erases the bar, so that a line can be printed.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    void keep_drawing(const std::stop_token& stop);
    void draw();
    void hint(double now);
    [[nodiscard]] static std::string_view kind(std::string_view stage);
    [[nodiscard]] double now() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    bool visible_;
    Clock::time_point start_ = Clock::now();

    std::condition_variable_any stopped_;
    std::mutex mutex_;  // guards what follows
    bool active_ = false;
    bool drawn_ = false;
    std::string stage_;
    double fraction_ = 0;
    double stage_start_ = 0;
    double last_draw_ = -1;
    Pace pace_;
    std::string part_;
    double part_begin_ = 0, part_size_ = 1, part_done_ = 0;
    std::string quicker_;
    std::function<void(const std::string&)> say_;
    std::jthread drawer_;
};

}  // namespace subvol::cli
