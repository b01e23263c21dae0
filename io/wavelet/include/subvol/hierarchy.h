// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A point that was added to a grid: linear extrapolation. Its value is that of `base`, plus for each axis steps[a] times the
/// difference from `before[a]` to `base`.
struct PaddedPoint {
    Index base = 0;
    std::array<Index, 3> before{};
    std::array<double, 3> steps{};
};

/// A mesh as the level `levels` of a coarser one.
struct MeshHierarchy {
    HexMesh coarse;  ///< its points, which are points of the mesh, cells, creases and sharp faces; no attributes
    int levels = 0;
    /// For each point of refine(coarse, levels) the point of the mesh; `mesh points + k` is padded[k]
    std::vector<Index> points;
    /// For each cell of refine(coarse, levels) the cell of the mesh; kNone for cells that were added
    std::vector<Index> cells;
    std::vector<PaddedPoint> padded;
};

struct HierarchyOptions {
    int levels = 6;  ///< the most levels to find, 1 to 10
    /// Add layers of cells to a structured grid whose counts cannot be halved twice, at most half as many cells as it has
    bool pad = true;
};

/// Finds the coarsest mesh whose refinement has the cells of a mesh: those of `refine`, of grids with even counts, and of all
/// meshes that are made of blocks with even counts. Of a mesh that `refine` made it is the mesh that was refined, in the same
/// numbering and orientation.
///
/// throws: Error(InvalidInput) as `validate` and `build_topology`, or if there is no such mesh; says what is in the way
/// cost:   O(n) for each level; the same for any number of threads
[[nodiscard]] MeshHierarchy find_hierarchy(const HexMesh& mesh, const HierarchyOptions& options = {});

/// Values at the points of a mesh in the order of its hierarchy, with those of added points.
///
/// throws: Error(InvalidInput) if there are fewer values than points
[[nodiscard]] std::vector<double> in_hierarchy(const MeshHierarchy& hierarchy, std::span<const double> values,
                                               std::size_t channels);

}  // namespace subvol
