// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

namespace subvol::detail {

/// The amount of work that the device gets at a time, for example tiles: adapted so that it takes about 10 to 50 ms. A picture
/// can then be cancelled soon, and no driver resets a device that seems to hang. Pictures must not depend on the amount.
class GlPace {
public:
    GlPace(std::size_t first, std::size_t least, std::size_t most)
        : amount_(std::clamp(first, least, most)), least_(least), most_(most) {}

    [[nodiscard]] std::size_t amount() const { return amount_; }

    /// seconds: that the last amount took
    /// returns: whether the next one differs
    bool took(double seconds) {
        const std::size_t before = amount_;
        if (seconds > kMost_s) amount_ = std::max(amount_ / 2, least_);
        if (seconds < kMost_s / 5) amount_ = std::min(2 * amount_, most_);
        return amount_ != before;
    }

private:
    static constexpr double kMost_s = 0.05;

    std::size_t amount_, least_, most_;
};

}  // namespace subvol::detail
