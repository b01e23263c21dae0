// SPDX-License-Identifier: Apache-2.0
#include "subvol/progress.h"

#include "subvol/error.h"

namespace subvol {

void report_progress(Progress* progress, std::string_view stage, double fraction) {
    if (!progress) return;
    if (progress->cancelled()) throw Error(ErrorCode::Cancelled, "stopped in " + std::string(stage));
    progress->report(stage, fraction);
}

}  // namespace subvol
