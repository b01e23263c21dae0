// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// What is in a mesh and whether it is sound: the figures of `subvol info`.
struct MeshReport {
    std::size_t points = 0;
    std::size_t points_used = 0;
    std::size_t cells = 0;
    std::size_t edges = 0;
    std::size_t faces = 0;
    std::size_t boundary_faces = 0;
    std::size_t interior_edges = 0;
    std::map<int, std::size_t> interior_edge_valence;  // number of cells about an interior edge → how many such edges
    std::size_t singular_nodes = 0;    // interior points where some irregular edges meet and their number is not 2
    std::size_t inverted_cells = 0;    // cells with a negative Jacobian at a corner
    std::size_t degenerate_cells = 0;  // cells whose volume, or an edge of which, is zero
    double min_scaled_jacobian = 0;    // over the corners of all cells: det of the unit edge vectors
    std::size_t nonmanifold_edges = 0;
    std::size_t nonmanifold_faces = 0;  // always 0 in a mesh that could be read
    double volume = 0;                  // of the trilinear cells, exact, world³
    Box bounds;
};

/// Counts and measures a mesh.
///
/// throws: Error(InvalidInput) as `validate` and `build_topology`
[[nodiscard]] MeshReport inspect(const HexMesh& mesh);

/// The shapes of the cells of a mesh: the figures of the same names in MeshReport.
struct ShapeReport {
    std::size_t inverted_cells = 0;
    std::size_t degenerate_cells = 0;
    double min_scaled_jacobian = 1;
    double volume = 0;
};

/// cost: parallel; the same for any number of threads
[[nodiscard]] ShapeReport measure_cells(const HexMesh& mesh);

}  // namespace subvol
