// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "subvol/progress.h"

namespace subvol::detail {

/// Passes reports on, and wants to stop when time is up.
class Deadline : public Progress {
public:
    Deadline(Progress* listener, double seconds) : listener_(listener), start_(Clock::now()), seconds_(seconds) {}

    void report(std::string_view stage, double fraction) override {
        if (listener_) listener_->report(stage, fraction);
    }
    void picture(const Image& image) override {
        if (listener_) listener_->picture(image);
    }
    [[nodiscard]] bool cancelled() const override { return stopped() || (armed_ && elapsed() > seconds_); }

    /// From now on the time counts; before there is a picture it does not.
    void arm() { armed_ = true; }
    [[nodiscard]] bool stopped() const { return listener_ && listener_->cancelled(); }
    [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
    using Clock = std::chrono::steady_clock;

    Progress* listener_;
    Clock::time_point start_;
    double seconds_;
    bool armed_ = false;
};

}  // namespace subvol::detail
