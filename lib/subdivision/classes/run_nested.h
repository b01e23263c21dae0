// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace subvol::detail {

/// Runs work that has parallel loops, from within a parallel loop.
///
/// While a thread waits for one of these inner loops, it does not start another part of the outer loop, which would need memory
/// too. And if another part of the outer loop throws, the work is still completed: TBB would cancel its loops silently.
template <class Work>
void run_nested(const Work& work) {
    tbb::this_task_arena::isolate([&] {
        tbb::task_group_context own(tbb::task_group_context::isolated);
        tbb::task_group(own).run_and_wait(work);
    });
}

}  // namespace subvol::detail
