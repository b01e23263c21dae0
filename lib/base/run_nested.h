// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace subvol::detail {

/// Runs work with parallel loops of its own from within a parallel loop.
///
/// A thread that waits for a loop of the work takes up no other part of the outer one meanwhile, and its memory with it. And
/// when another part of the outer loop throws, the work still runs to its end: TBB would leave its loops half done without a
/// word.
template <class Work>
void run_nested(const Work& work) {
    tbb::this_task_arena::isolate([&] {
        tbb::task_group_context own(tbb::task_group_context::isolated);
        tbb::task_group(own).run_and_wait(work);
    });
}

}  // namespace subvol::detail
