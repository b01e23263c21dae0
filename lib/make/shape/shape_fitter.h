// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "mesh_walls.h"
#include "sharp_pulls.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/fit_shape.h"
#include "subvol/mesh_sets.h"
#include "subvol/refine.h"
#include "subvol/topology.h"
#include "surface_distances.h"
#include "surface_matrix.h"

namespace subvol::detail {

class ShapeEnergy;

/// What the cells of a mesh should be like.
struct CellAims {
    std::vector<double> sides;    ///< of each cell, if it were not distorted at all
    std::vector<double> weights;  ///< of the distortion of each cell: 1, or more where it has to be less
};

/// A mesh and the surfaces that the walls of its materials are fitted to.
struct WallTargets {
    std::span<const Index> materials;     ///< as of `wall_of`
    std::span<const WallTarget> targets;  ///< of each material; the surfaces are referred to
};

/// The walls of a limit and the surfaces that they are fitted to.
class ShapeFitter {
public:
    /// progress: asked whether the work is cancelled: the steps end then, and what they return is of no use
    ShapeFitter(const Topology& control, const WallTargets& walls, const SchemeOptions& scheme,
                const Progress* progress = nullptr);

    /// Creases are drawn to sharp edges of the surface, too, by `relaxed`.
    ///
    /// paths: the creases of the control mesh; sharp: referred to
    void follow(const SharpEdges& sharp, const SharpPaths& paths) { sharp_ = SharpPulls(sharp, paths, matrix_); }

    /// The distances of creases from sharp edges: root mean square and largest.
    [[nodiscard]] std::array<double, 2> sharp_error(const std::vector<Vec3>& control) const {
        return sharp_.error(matrix_.apply(control));
    }

    /// A Gauss-Newton step: the new control points.
    ///
    /// stiffness: the weight of differences of the ways along edges, beside that of the distances about a control point, 1
    [[nodiscard]] std::vector<Vec3> step(const std::vector<Vec3>& control, double stiffness) const;

    [[nodiscard]] ShapeError error(const std::vector<Vec3>& control) const;

    /// The places of the boundary and the surface whose distances are above `far`.
    [[nodiscard]] std::vector<Vec3> places_beyond(const std::vector<Vec3>& control, double far) const;

    /// The points with less distorted cells and the boundary nearer to the surface, by quasi-Newton steps. Cells that are
    /// turned inside out are turned back where they can be.
    ///
    /// The distortion is that of the children of cells; of the linear scheme that of the cells. Flat corners of control cells
    /// are raised besides (flatness.h).
    ///
    /// weight: of the squares of distances in sides, about each control point of the boundary, beside the distortion of a
    ///         corner
    ///
    /// source: [garanzha2021]
    [[nodiscard]] std::vector<Vec3> relaxed(const std::vector<Vec3>& control, const CellAims& cells, double weight) const;

private:
    friend class ShapeEnergy;

    void keep_sound(const std::vector<Vec3>& control, std::vector<Vec3>& ways) const;
    [[nodiscard]] std::vector<Pull> pulls(const std::vector<Vec3>& control) const;
    /// What forces on the places are at the control points. force: of a pull
    template <class Force>
    [[nodiscard]] std::vector<Vec3> gathered(const std::vector<Pull>& pulls, const Force& force) const {
        const std::vector<double> sums =
            parallel_sums(3 * matrix_.rows(), pulls.size(), [&](std::size_t k, std::vector<double>& to) {
                const Vec3 f = force(pulls[k]);
                for (std::size_t i = 0; i < 3; ++i) {
                    const double weight = pulls[k].weights[static_cast<int>(i)];
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        to[3 * pulls[k].points[i] + axis] += weight * f[static_cast<int>(axis)];
                    }
                }
            });
        std::vector<Vec3> forces(matrix_.rows());
        for (std::size_t p = 0; p < forces.size(); ++p) forces[p] = {sums[3 * p], sums[3 * p + 1], sums[3 * p + 2]};
        return matrix_.transposed(forces);
    }
    [[nodiscard]] std::vector<Vec3> solved(const std::vector<Pull>& pulls, double stiffness) const;

    std::vector<std::array<Index, 8>> cells_;
    FlatArray<std::array<Index, 2>> edges_;
    IndexRows point_edges_;
    std::size_t boundary_points_;
    RefinementTables children_;
    SurfaceMatrix matrix_;
    std::deque<SurfaceDistances> distances_;  // of each material
    const Progress* progress_;
    SharpPulls sharp_;
};

struct FinishedShape {
    HexMesh mesh;
    std::vector<double> volumes;  ///< what the limit of each material fills
    std::vector<CellSide> lids;   ///< sides that are over holes of the surfaces, most of them
};

/// The end of a fit: folds are mended if that is asked for, and the report gets what is known in the end.
[[nodiscard]] FinishedShape finished(HexMesh mesh, const WallTargets& walls, const FitShapeOptions& options,
                                     FitShapeReport& report);

/// `shape_error`, of no use once the work is cancelled.
[[nodiscard]] ShapeError error_until(const HexMesh& mesh, const WallTargets& walls, const SchemeOptions& scheme,
                                     const Progress* progress);

}  // namespace subvol::detail
