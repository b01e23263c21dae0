// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/stencil_table.h"
#include "subvol/topology.h"

namespace subvol {

/// levels: 0 to 10
struct RefineOptions {
    SchemeOptions scheme{};
    int levels = 1;
    Progress* progress = nullptr;
};

/// Refines a mesh `levels` times; each level splits a cell into 8. Positions and all attributes follow the scheme.
///
/// Numbering: the parent's used points in their order, then one point an edge, a face, a cell, in their topology's order.
/// Child k of cell c is 8c + k, at corner k of its parent and turned as its parent is.
/// returns: the level-`levels` mesh; level 0 is the mesh without its unused points
/// throws:  Error(InvalidInput) as `validate` and `build_topology`, or if the result needs more points than Index can number
/// cost:    parallel; bitwise the same for any number of threads; independent of the order of the cells
/// source:  [mnmq2007] with the masks of docs/schemes.md; irregular edges, boundaries and creases of MCQ are ours (MCQ-G)
[[nodiscard]] HexMesh refine(const HexMesh& mesh, const RefineOptions& options = {});

/// Refines some cells of a mesh, and of the others only what their rules need: two layers around.
///
/// cells:   which, without repetition (what a predicate chose); descendants k·8^levels … of cells[k] come in this order
/// returns: the level-`levels` mesh of these cells alone, bitwise as `refine` of the whole mesh has it; its points stand in the
///          order of that mesh. Creases and sharp faces of the part are kept.
/// throws:  Error(InvalidInput) as `refine` (creases are looked at only where they matter), or if a cell does not exist or is
/// named twice cost:    of the cells asked for and their surroundings, besides one pass over the mesh
[[nodiscard]] HexMesh refine_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options = {});

/// A refinement computed once for any number of applications: a control mesh that moves, or many fields.
///
/// levels: level l (from 0) makes the points of level l+1 from those of level l
/// cells, creases, sharp_faces: of the finest level
struct RefinementTables {
    std::size_t control_points = 0;
    std::vector<StencilTable> levels;
    std::vector<std::array<Index, 8>> cells;
    std::vector<std::array<Index, 2>> creases;
    std::vector<std::array<Index, 4>> sharp_faces;

    [[nodiscard]] std::size_t points() const { return levels.empty() ? control_points : levels.back().rows(); }

    /// Data of the control points (point-major) taken to the finest level: points() × channels values, all written.
    ///
    /// throws: Error(InvalidInput) if a size is wrong
    void apply(std::span<const double> control, std::size_t channels, std::span<double> fine) const;
    void apply(std::span<const float> control, std::size_t channels, std::span<float> fine) const;
    [[nodiscard]] std::vector<double> apply(std::span<const double> control, std::size_t channels) const;
    [[nodiscard]] std::vector<float> apply(std::span<const float> control, std::size_t channels) const;

    /// One table from the control points to the finest level.
    [[nodiscard]] StencilTable over_control_points() const;
    [[nodiscard]] std::size_t bytes() const;
};

/// The tables of `refine`, in the same numbering; `refine` gives bitwise what they give. scheme.crease_angle_deg is not used:
/// tag creases before.
[[nodiscard]] RefinementTables refinement_tables(const Topology& control, const RefineOptions& options = {});

}  // namespace subvol
