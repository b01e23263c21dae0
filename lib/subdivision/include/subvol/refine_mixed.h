// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "subvol/mixed_mesh.h"
#include "subvol/names.h"
#include "subvol/progress.h"
#include "subvol/stencil_table.h"

namespace subvol {

/// Tetoct:    tetrahedral-octahedral subdivision [shw2004]
/// Boxspline: box splines over tetrahedra [cmq2002], of meshes of tetrahedra and octahedra only
/// Linear:    the split alone
///
/// The boundary is Loop's surface [loop1987] for the first two, and Catmull-Clark's where it is made of quads.
enum class TetScheme { Tetoct, Boxspline, Linear };

template <>
struct NameTable<TetScheme> {
    static constexpr Name<TetScheme> rows[] = {
        {TetScheme::Tetoct, "tetoct"}, {TetScheme::Boxspline, "boxspline"}, {TetScheme::Linear, "linear"}};
};

inline constexpr int kMostTetLevels = 8;

struct MixedRefineOptions {
    TetScheme scheme = TetScheme::Tetoct;
    int levels = 1;                            ///< 0 to kMostTetLevels
    std::optional<double> crease_angle_deg{};  ///< boundary edges bent by more than this become creases too; (0,180], 180: none
    Progress* progress = nullptr;
};

/// A refinement that is computed once and applied any number of times.
struct MixedTables {
    std::size_t control_points = 0;
    std::vector<StencilTable> levels;  ///< level l (from 0) makes the points of level l+1 from those of level l
    MixedMesh fine;                    ///< the cells and creases of the finest level, without points and attributes

    [[nodiscard]] std::size_t points() const { return levels.empty() ? control_points : levels.back().rows(); }

    /// Takes data of the control points (point-major) to the finest level.
    ///
    /// throws: Error(InvalidInput) if the size is wrong
    [[nodiscard]] std::vector<double> apply(std::span<const double> control, std::size_t channels) const;
};

/// The tables of a refinement. A tetrahedron becomes 4 tetrahedra and an octahedron, an octahedron 6 octahedra and 8
/// tetrahedra, a prism 8 prisms, a hexahedron 8 hexahedra, a pyramid 6 pyramids and 4 tetrahedra.
///
/// Numbering: the parent's points in their order, then one for each edge, each quad, each octahedron and each hexahedron, each
/// kind in the order of the sorted corners. It does not depend on the order of the cells, and neither do the weights.
///
/// throws: Error(InvalidInput) as `validate`, if a face has more than two cells, a crease is not on the boundary, options are
///         out of range, or Boxspline meets a prism, pyramid or hexahedron (cut them: `in_tetrahedra`)
/// cost:   parallel; bitwise the same for any number of threads
[[nodiscard]] MixedTables refinement_tables(const MixedMesh& mesh, const MixedRefineOptions& options = {});

/// The refined mesh with its attributes: all follow the same weights.
[[nodiscard]] MixedMesh refine(const MixedMesh& mesh, const MixedRefineOptions& options = {});

/// The limits of the vertices as weights of the vertices around them: for each, the left eigenvector of the refinement of its
/// cells, to 1e-13.
///
/// throws: as `refinement_tables`. If two ways lead from a vertex to another inside its cells (for example an edge, and through
///         an octahedron), which happens in no refined mesh: Error(InvalidInput); refine once first
[[nodiscard]] StencilTable limit_table(const MixedMesh& mesh, TetScheme scheme);

/// The mesh with its points and attributes moved to the limit. Linear: as it is
[[nodiscard]] MixedMesh on_limit(MixedMesh mesh, TetScheme scheme);

/// The control values whose limit at the vertices has the given points and attributes: v ← v + (given − limit of v), until
/// nothing moves by more than `tolerance` of the range, or `most_steps` times.
struct MixedInterpolation {
    MixedMesh mesh;
    int steps = 0;    ///< steps that were made
    double left = 0;  ///< the largest remaining part of the range of an attribute, or of the box's longest side
};
[[nodiscard]] MixedInterpolation interpolate_vertices(const MixedMesh& given, TetScheme scheme, double tolerance = 1e-6,
                                                      int most_steps = 60);

/// The level of a mesh on the limit that passes through the mesh's points and values.
struct MixedVolume {
    MixedMesh mesh;
    double left = 0;  ///< as in MixedInterpolation
};

/// Interpolates the mesh with its creases, refines it and puts the vertices on the limit: between them the volume is taken as
/// linear.
///
/// tolerance, most_steps: as of `interpolate_vertices`
/// throws:                as `refine`, `limit_table`
[[nodiscard]] MixedVolume volume_through(const MixedMesh& given, const MixedRefineOptions& options, double tolerance = 1e-4,
                                         int most_steps = 100);

/// The control cell of each cell of a level. Both are counted through the tetrahedra, octahedra, prisms, pyramids and
/// hexahedra.
///
/// throws: Error(InvalidInput) if the level is out of range
[[nodiscard]] std::vector<Index> control_cells(const MixedMesh& control, int levels);

}  // namespace subvol
