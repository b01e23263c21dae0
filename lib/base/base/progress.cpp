// SPDX-License-Identifier: Apache-2.0
#include "subvol/progress.h"

#include "subvol/error.h"

namespace subvol {

void report_progress(Progress* progress, std::string_view stage, double fraction) {
    if (!progress) return;
    if (progress->cancelled()) throw Error(ErrorCode::Cancelled, "stopped in " + std::string(stage));
    progress->report(stage, fraction);
}

void report_progress(Progress* progress, std::string_view stage, std::size_t done, std::size_t all) {
    report_progress(progress, stage, static_cast<double>(done) / static_cast<double>(all));
}

}  // namespace subvol
