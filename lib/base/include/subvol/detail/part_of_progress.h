// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "subvol/progress.h"

namespace subvol::detail {

/// One of several equal parts of long work, whose progress is shown as that of the whole: one stage, whose fraction grows from
/// part to part. A part may have several stages of its own; its fraction is the largest that one of them has reached.
class PartOfProgress : public Progress {
public:
    /// whole: null: nobody sees it
    /// stage: of the whole
    /// part:  from 0
    PartOfProgress(Progress* whole, std::string stage, std::size_t part, std::size_t parts)
        : whole_(whole), stage_(std::move(stage)), part_(part), parts_(parts) {}

    void report(std::string_view, double fraction) override {
        done_ = std::max(done_, std::min(fraction, 1.0));
        if (whole_) whole_->report(stage_, (static_cast<double>(part_) + done_) / static_cast<double>(parts_));
    }
    [[nodiscard]] bool cancelled() const override { return whole_ && whole_->cancelled(); }

private:
    Progress* whole_;
    std::string stage_;
    std::size_t part_, parts_;
    double done_ = 0;
};

}  // namespace subvol::detail
