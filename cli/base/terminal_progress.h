// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "subvol/progress.h"

namespace subvol::cli {

/// A progress bar on standard error; an interrupt cancels the work.
class TerminalProgress : public Progress {
public:
    explicit TerminalProgress(bool visible) : visible_(visible) {}
    ~TerminalProgress() override { clear(); }
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    void report(std::string_view stage, double fraction) override;
    [[nodiscard]] bool cancelled() const override;

    /// Erases the bar, so that a line can be printed.
    void clear();

private:
    bool visible_;
    bool drawn_ = false;
    std::string stage_;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace subvol::cli
