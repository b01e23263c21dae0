// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "subvol/certificate.h"

namespace subvol::detail {

/// Determinants ∂x/∂u at places of a cell.
struct CellSamples {
    FoldPlace least;         ///< the smallest one and where it is
    std::size_t places = 0;  ///< number of places
    double size = 0;         ///< sum of the magnitudes
};

/// Samples the limit of cells: at corners, in the middle of edges and sides, at places inside, and then nearer and nearer to
/// the smallest determinant and to the three smallest ones beside the lengths of the derivatives. One that is negative is so
/// with a tolerance a thousand times finer, too.
///
/// cells: of the mesh, each once; cost: about 2 ms a cell, parallel; the same bits for any number of threads
[[nodiscard]] std::vector<CellSamples> sample_folds(const HexMesh& mesh, std::span<const Index> cells,
                                                    const SchemeOptions& scheme, Progress* progress);

/// The verdicts of `check_folds` for some cells of a mesh, ascending; cost: that of these cells
[[nodiscard]] std::vector<FoldVerdict> fold_verdicts(const HexMesh& mesh, std::span<const Index> cells,
                                                     const FoldOptions& options);

}  // namespace subvol::detail
