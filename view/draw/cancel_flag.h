// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string_view>

#include "subvol/progress.h"

namespace subvol::detail {

/// Ends work that nobody waits for any longer, when a flag is set.
class CancelFlag : public Progress {
public:
    explicit CancelFlag(const std::atomic<bool>& wanted) : wanted_(wanted) {}
    void report(std::string_view, double) override {}
    [[nodiscard]] bool cancelled() const override { return wanted_; }

private:
    const std::atomic<bool>& wanted_;
};

}  // namespace subvol::detail
