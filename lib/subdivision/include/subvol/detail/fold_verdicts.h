// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/certificate.h"

namespace subvol::detail {

/// The verdicts of `check_folds` for some cells of a mesh.
///
/// cells: ascending
/// cost:  that of these cells
[[nodiscard]] std::vector<FoldVerdict> fold_verdicts(const HexMesh& mesh, std::span<const Index> cells,
                                                     const FoldOptions& options);

}  // namespace subvol::detail
