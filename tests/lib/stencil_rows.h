// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "subvol/refine.h"

namespace subvol::test {

/// One row of a subdivision matrix: parent point ids, ascending, with their weights (sum 1).
using StencilRow = std::vector<std::pair<Index, double>>;

/// The stencils of one refinement step, one row a point of the child, in the numbering of `refine`.
inline std::vector<StencilRow> stencils(const Topology& topology, const SchemeOptions& scheme = {}) {
    const CsrMatrix matrix = refinement_tables(topology, {.scheme = scheme}).levels.front().csr();
    std::vector<StencilRow> result(matrix.offsets.size() - 1);
    for (std::size_t r = 0; r < result.size(); ++r) {
        for (std::size_t i = matrix.offsets[r]; i < matrix.offsets[r + 1]; ++i) {
            result[r].emplace_back(matrix.columns[i], matrix.weights[i]);
        }
    }
    return result;
}

}  // namespace subvol::test
