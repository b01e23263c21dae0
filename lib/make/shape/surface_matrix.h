// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/scheme.h"
#include "subvol/stencil_table.h"
#include "subvol/surface.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The walls of one material: the rows of their points, and triangles by the numbers of these rows.
struct WallRows {
    std::vector<Index> rows;
    std::vector<std::array<Index, 3>> triangles;

    [[nodiscard]] Surface surface(std::span<const Vec3> points) const;
};

/// The limit of the walls at the points of level 1 as rows of weights over the control points, and triangles between these
/// points.
class SurfaceMatrix {
public:
    /// materials: as of `wall_of`
    SurfaceMatrix(const Topology& control, std::span<const Index> materials, const SchemeOptions& scheme);

    [[nodiscard]] std::size_t rows() const { return matrix_.offsets.size() - 1; }
    /// Of each material, one at least.
    [[nodiscard]] const std::vector<WallRows>& walls() const { return walls_; }

    /// The row of a control point on a wall.
    [[nodiscard]] Index row_of(Index control) const { return rows_of_points_[control]; }
    /// For each crease of the control mesh the rows of one end, the middle and the other end.
    [[nodiscard]] const std::vector<std::array<Index, 3>>& crease_rows() const { return crease_rows_; }

    [[nodiscard]] std::vector<Vec3> apply(std::span<const Vec3> control) const;
    /// The transpose; the same bits for any number of threads.
    [[nodiscard]] std::vector<Vec3> transposed(std::span<const Vec3> values) const;
    /// The sums of the squares of each column times the weights of the rows: the diagonal of AᵀWA.
    [[nodiscard]] std::vector<double> squares(std::span<const double> weights) const;

private:
    std::size_t columns_ = 0;
    CsrMatrix matrix_, transpose_;
    std::vector<WallRows> walls_;
    std::vector<std::array<Index, 3>> crease_rows_;
    std::vector<Index> rows_of_points_;
};

}  // namespace subvol::detail
