// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/stencil_table.h"
#include "subvol/topology.h"

namespace subvol {

struct RefineOptions {
    SchemeOptions scheme{};
    int levels = 1;  ///< 0 to 10
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(RefineOptions& options);

/// Refines a mesh `levels` times; each level splits a cell into 8. Positions and all attributes follow the scheme.
///
/// Numbering: the parent's used points in their order, then one point per edge, per face and per cell, in the order of their
/// topology. Child k of cell c is 8c + k; it lies at corner k of its parent and has its orientation.
/// returns: the level-`levels` mesh; level 0 is the mesh without its unused points
/// throws:  Error(InvalidInput) as `validate` and `build_topology`, or if the result needs more points than Index can number
/// cost:    parallel; bitwise the same for any number of threads; independent of the order of the cells
/// source:  [mnmq2007] with the masks of docs/schemes.md; irregular edges, boundaries and creases of MCQ are ours (MCQ-G)
[[nodiscard]] HexMesh refine(const HexMesh& mesh, const RefineOptions& options = {});

/// Refines some cells of a mesh; of the others only what their rules need, the two layers around them.
///
/// cells:   without repetition; the descendants of cells[k] are k·8^levels to (k+1)·8^levels − 1
/// returns: the level-`levels` mesh of these cells alone, with the same bits as `refine` of the whole mesh; its points are in
///          the order of that mesh. Creases and sharp faces of the part are kept.
/// throws:  Error(InvalidInput) as `refine` (creases are checked only where they matter), or if a cell does not exist or is
///          listed twice
/// cost:    that of the cells and their surroundings, and one pass over the mesh
[[nodiscard]] HexMesh refine_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options = {});

/// A refinement that is computed once and applied any number of times: for a control mesh that moves, or for many fields.
struct RefinementTables {
    std::size_t control_points = 0;
    std::vector<StencilTable> levels;               ///< level l (from 0) makes the points of level l+1 from those of level l
    std::vector<std::array<Index, 8>> cells;        ///< cells of the finest level
    std::vector<std::array<Index, 2>> creases;      ///< creases of the finest level
    std::vector<std::array<Index, 4>> sharp_faces;  ///< sharp faces of the finest level

    [[nodiscard]] std::size_t points() const { return levels.empty() ? control_points : levels.back().rows(); }

    /// Takes data of the control points (point-major) to the finest level: points() × channels values, all written.
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

/// The tables of `refine`, in the same numbering; applied, they give the same bits as `refine`, but roundings about edges of 32
/// or more cells, where `refine` uses sums over the ring. scheme.crease_angle_deg is not used: tag creases before.
[[nodiscard]] RefinementTables refinement_tables(const Topology& control, const RefineOptions& options = {});

}  // namespace subvol
