// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mixed_boundary.h"
#include "mixed_split.h"
#include "subvol/refine_mixed.h"

namespace subvol::detail {

/// A level with its boundary. The mesh has cells and creases alone.
struct MixedLevel {
    MixedMesh cells;
    MixedBoundary boundary;
    std::size_t points = 0;
};

struct MixedStep {
    MixedLevel child;
    StencilTable table;
};

/// The next level and the weights of its points.
[[nodiscard]] MixedStep refine_level(const MixedLevel& parent, const SplitNumbers& numbers, TetScheme scheme);

/// The level of a mesh, checked.
[[nodiscard]] MixedLevel level_of(const MixedMesh& mesh, TetScheme scheme, std::optional<double> crease_angle_deg);

}  // namespace subvol::detail
