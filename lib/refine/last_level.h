// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/refine.h"

namespace subvol::detail {

/// A refined mesh with the topology of the level before it, which tells all about it.
struct LastLevel {
    HexMesh mesh;  // without cells: child_cells(parent) are they
    Topology parent;
};

/// As `refine`, for a valid mesh and its topology. options.levels: ≥ 1; creases have been tagged
[[nodiscard]] LastLevel refine_without_cells(HexMesh control, Topology topology, const RefineOptions& options);

}  // namespace subvol::detail
