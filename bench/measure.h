// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

#include <algorithm>

#include "subvol/detail/stopwatch.h"

namespace subvol::bench {

/// The shortest of several runs, in seconds of wall time.
template <class Work>
double seconds_of(const Work& work, int repeats) {
    double best = 1e30;
    for (int i = 0; i < repeats; ++i) {
        const detail::Stopwatch watch;
        work();
        best = std::min(best, watch.seconds());
    }
    return best;
}

/// The peak memory of the process.
inline double peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace subvol::bench
