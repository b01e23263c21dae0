// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <utility>

namespace subvol::detail {

/// Wall time in seconds since it was made or last restarted.
class Stopwatch {
public:
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    /// returns: the seconds until now
    double restart() {
        const auto before = std::exchange(start_, Clock::now());
        return std::chrono::duration<double>(start_ - before).count();
    }

private:
    using Clock = std::chrono::steady_clock;

    Clock::time_point start_ = Clock::now();
};

}  // namespace subvol::detail
