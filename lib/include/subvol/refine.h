#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/stencil_table.h"
#include "subvol/topology.h"

namespace subvol {

/// Mcq: through the control points [mnmq2007]; CatmullClark: its generalisation to solids [mj1996]; Bsxw: trilinear split and
/// averaging [bsxw2002]; Linear: the trilinear split alone
enum class Scheme { Mcq, CatmullClark, Bsxw, Linear };

/// Whether a scheme's volume goes through its control points.
[[nodiscard]] bool interpolates(Scheme scheme);

struct RefineOptions {
    Scheme scheme = Scheme::Mcq;
    int levels = 1;                            // 0 to 10
    double tension = 1.0 / 16.0;               // ω of MCQ: 0 is the trilinear split; cubics are reproduced at 1/16 only
    std::optional<double> crease_angle_deg{};  // boundary edges bent more than this become creases too; (0,180)
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

/// The tables of `refine`, in the same numbering; `refine` gives bitwise what they give. options.crease_angle_deg is not used:
/// tag creases before.
[[nodiscard]] RefinementTables refinement_tables(const Topology& control, const RefineOptions& options = {});

/// Tags the smooth boundary edges whose two faces meet at more than `angle_deg`.
///
/// throws: Error(InvalidInput) if the angle is not in (0,180)
void tag_creases(HexMesh& mesh, double angle_deg);

/// One row of a subdivision matrix: parent point ids, ascending, with their weights (sum 1).
using StencilRow = std::vector<std::pair<Index, double>>;

/// The stencils of one refinement step, one row a point of the child, in the numbering of `refine`.
[[nodiscard]] std::vector<StencilRow> stencils(const Topology& topology, const RefineOptions& options = {});

}  // namespace subvol
