// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "shape_fitter.h"
#include "subvol/mesh_sets.h"

namespace subvol::detail {

/// The walls of a material in the limit, by vertices of level 2: all of them, and those that are drawn to its own surface.
struct FineWalls {
    Surface closed, own;
    std::vector<CellSide> sides;  ///< of the control mesh, for each two triangles of `own`
};

/// The walls of each material. Of the cells only those at walls are refined, where that gives points of the limit.
[[nodiscard]] std::vector<FineWalls> fine_walls(const HexMesh& mesh, std::span<const Index> materials,
                                                const SchemeOptions& scheme);

/// How far walls are from their targets; of no use once the work is cancelled.
[[nodiscard]] ShapeError error_of(const std::vector<FineWalls>& fine, const WallTargets& walls, const Progress* progress);

/// The sides of the mesh that are over holes of the targets, most of them, by cell and side.
[[nodiscard]] std::vector<CellSide> lids_of(const std::vector<FineWalls>& fine, const WallTargets& walls);

}  // namespace subvol::detail
