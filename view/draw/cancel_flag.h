// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <string_view>
#include <utility>

#include "subvol/progress.h"

namespace subvol::detail {

/// Ends work that nobody waits for any longer, when a flag is set.
///
/// listen: gets what is reported; empty: nobody
class CancelFlag : public Progress {
public:
    explicit CancelFlag(const std::atomic<bool>& wanted, std::function<void(std::string_view, double)> listen = {})
        : wanted_(wanted), listen_(std::move(listen)) {}
    void report(std::string_view stage, double fraction) override {
        if (listen_) listen_(stage, fraction);
    }
    [[nodiscard]] bool cancelled() const override { return wanted_; }

private:
    const std::atomic<bool>& wanted_;
    std::function<void(std::string_view, double)> listen_;
};

}  // namespace subvol::detail
