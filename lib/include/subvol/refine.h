#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/topology.h"

namespace subvol {

enum class Scheme { Mcq, Linear };

struct RefineOptions {
    Scheme scheme = Scheme::Mcq;
    int levels = 1;                            // ≥ 0
    double tension = 1.0 / 16.0;               // ω of MCQ
    std::optional<double> crease_angle_deg{};  // boundary edges bent more than this become creases too; (0,180)
    Progress* progress = nullptr;
};

/// Refines a mesh `levels` times; each level splits a cell into 8. Positions and all attributes follow the scheme.
///
/// Numbering: the parent's used points in their order, then one point an edge, a face, a cell, in their topology's order.
/// Child k of cell c is 8c + k, at corner k of its parent and turned as its parent is.
/// returns: the level-`levels` mesh; level 0 is the mesh without its unused points
/// throws:  Error(InvalidInput) as `validate` and `build_topology`, or if the result needs more than 2³²−2 points
/// cost:    parallel; bitwise the same for any number of threads; independent of the order of the cells
/// source:  [mnmq2007] with the masks of SCIENCE §1.2; irregular edges, boundaries and creases are ours (MCQ-G, §1.5)
[[nodiscard]] HexMesh refine(const HexMesh& mesh, const RefineOptions& options = {});

/// One row of a subdivision matrix: parent point ids, ascending, with their weights (sum 1).
using StencilRow = std::vector<std::pair<Index, double>>;

/// The stencils of one refinement step, in the numbering of `refine`: rows for the edge, face and cell points.
[[nodiscard]] std::vector<StencilRow> stencils(const Topology& topology, const RefineOptions& options = {});

}  // namespace subvol
