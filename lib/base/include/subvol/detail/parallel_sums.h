// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

/// Sums into `size` places: body(i, sums) adds what i in [0, count) gives. The numbers are cut into eight runs with sums of
/// their own, which are added in order, so that the result has the same bits for any number of threads.
template <class Body>
std::vector<double> parallel_sums(std::size_t size, std::size_t count, const Body& body) {
    std::array<std::vector<double>, 8> runs;
    tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t r) {
        runs[r].assign(size, 0);
        for (std::size_t i = count * r / runs.size(); i < count * (r + 1) / runs.size(); ++i) body(i, runs[r]);
    });
    parallel_each(size, [&](std::size_t i) {
        for (std::size_t r = 1; r < runs.size(); ++r) runs[0][i] += runs[r][i];
    });
    return std::move(runs[0]);
}

}  // namespace subvol::detail
