// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/mesh_source.h"

namespace subvol {

/// The size and the quality of a mesh: the figures of `subvol info`.
struct MeshReport {
    std::size_t points = 0;
    std::size_t points_used = 0;
    std::size_t cells = 0;
    std::size_t edges = 0;
    std::size_t faces = 0;
    std::size_t boundary_faces = 0;
    std::size_t interior_edges = 0;
    std::map<int, std::size_t> interior_edge_valence;  // cells at an interior edge → the number of such edges
    std::size_t singular_nodes = 0;    // interior points where some irregular edges meet and their number is not 2
    std::size_t inverted_cells = 0;    // cells with a negative Jacobian at a corner
    std::size_t degenerate_cells = 0;  // cells with zero volume, or with an edge of zero length
    double min_scaled_jacobian = 0;    // over the corners of all cells: det of the unit edge vectors
    std::size_t nonmanifold_edges = 0;
    std::size_t nonmanifold_points = 0;  // boundary points, away from such edges, where several fans of boundary faces touch
    std::size_t nonmanifold_faces = 0;   // always 0: build_topology refuses other meshes
    double volume = 0;                   // of the trilinear cells, exact, world³
    Box bounds;
};

/// All of it, under the names that the command and Python have for it.
[[nodiscard]] Facts facts_of(const MeshReport& report);

/// Counts and measures a mesh. Of a mesh in pieces counts, extremes and bounds are those of the whole, the volume is the sum of
/// the pieces' volumes in their order.
///
/// throws: Error(InvalidInput) as `validate` and `build_topology`; what reading pieces throws; Error(Cancelled)
[[nodiscard]] MeshReport inspect(const MeshSource& source, Progress* progress = nullptr);

/// The figures of the same names in MeshReport, which depend only on the shapes of the cells.
struct ShapeReport {
    std::size_t inverted_cells = 0;
    std::size_t degenerate_cells = 0;
    double min_scaled_jacobian = 1;
    double volume = 0;
};

/// The numbers of the first cells with a negative Jacobian at a corner, ascending.
[[nodiscard]] std::vector<std::size_t> inverted_cells(const HexMesh& mesh, std::size_t at_most);

/// All of them after some points have moved. Only the cells about these are measured.
///
/// before: the places of the points before
/// known:  the numbers of the cells that were inverted then, ascending
[[nodiscard]] std::vector<std::size_t> inverted_cells(const HexMesh& moved, std::span<const Vec3> before,
                                                      std::span<const std::size_t> known);

/// The least at the corners of a cell, in VTK order: 1 for a cube, at most 0 where the cell is turned inside out or degenerate.
[[nodiscard]] double min_scaled_jacobian(const std::array<Vec3, 8>& corners);

/// The longest of a cell's twelve edges over the shortest: 1 for a cube. At most 1e9, also where an edge has no length.
[[nodiscard]] double aspect_ratio(const std::array<Vec3, 8>& corners);

/// cost: parallel; the same for any number of threads
[[nodiscard]] ShapeReport measure_cells(const HexMesh& mesh);

}  // namespace subvol
