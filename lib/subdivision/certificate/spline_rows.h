// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <array>
#include <cstddef>
#include <vector>

namespace subvol::detail {

/// Rows over the points of a window, each in one piece of memory.
using RowsXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using SparseRowsXd = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Rows for the 4×4×4 points or Bernstein coefficients of a tricubic piece, in the order (4 i + j) 4 + k.

/// Multiplies the index along an axis.
[[nodiscard]] RowsXd along_axis(const Eigen::Matrix4d& by, const RowsXd& rows, Eigen::Index axis);

/// From the points of a uniform cubic spline to its Bézier points.
[[nodiscard]] Eigen::Matrix4d bezier_of_spline();

/// From cubic Bézier points to the coefficients of the derivative, raised to degree 3 again.
[[nodiscard]] Eigen::Matrix4d derivative_of_bezier();

/// From the coefficients on [0, 1] to those on a half.
[[nodiscard]] Eigen::Matrix4d half_of_bezier(bool upper);

/// Tricubic pieces whose points are weighted sums of those of a window. They have most of their points in common.
struct SplinePieces {
    SparseRowsXd rows;                                 ///< from the window to all points
    std::vector<std::array<Eigen::Index, 64>> points;  ///< of each piece, as rows of these

    /// The 64 rows of a piece. of_points: a row for each point
    template <class Rows>
    [[nodiscard]] Rows of(std::size_t piece, const Rows& of_points) const {
        Rows result(64, of_points.cols());
        for (Eigen::Index p = 0; p < 64; ++p) result.row(p) = of_points.row(points[piece][static_cast<std::size_t>(p)]);
        return result;
    }
};

/// rows: of each piece, from the window to its 64 points
[[nodiscard]] SplinePieces spline_pieces(const std::vector<RowsXd>& rows);

}  // namespace subvol::detail
