// SPDX-License-Identifier: Apache-2.0
#include "spline_rows.h"

#include <map>

namespace subvol::detail {

RowsXd along_axis(const Eigen::Matrix4d& by, const RowsXd& rows, Eigen::Index axis) {
    const Eigen::Index stride = axis == 0 ? 16 : axis == 1 ? 4 : 1;
    RowsXd result = RowsXd::Zero(rows.rows(), rows.cols());
    for (Eigen::Index k = 0; k < 64; ++k) {
        const Eigen::Index at = k / stride % 4;
        for (Eigen::Index i = 0; i < 4; ++i) {
            if (by(at, i) != 0) result.row(k) += by(at, i) * rows.row(k + (i - at) * stride);
        }
    }
    return result;
}

Eigen::Matrix4d bezier_of_spline() {
    Eigen::Matrix4d by;
    by << 1, 4, 1, 0, 0, 4, 2, 0, 0, 2, 4, 0, 0, 1, 4, 1;
    return by / 6;
}

Eigen::Matrix4d derivative_of_bezier() {
    Eigen::Matrix4d by;
    by << -3, 3, 0, 0, -1, -1, 2, 0, 0, -2, 1, 1, 0, 0, -3, 3;
    return by;
}

Eigen::Matrix4d half_of_bezier(bool upper) {
    Eigen::Matrix4d lower;
    lower << 8, 0, 0, 0, 4, 4, 0, 0, 2, 4, 2, 0, 1, 3, 3, 1;
    return (upper ? Eigen::Matrix4d(lower.reverse()) : lower) / 8;
}

SplinePieces spline_pieces(const std::vector<RowsXd>& rows) {
    SplinePieces pieces;
    std::map<std::vector<double>, Eigen::Index> numbers;  // of points by their weights
    for (const RowsXd& piece : rows) {
        auto& points = pieces.points.emplace_back();
        for (Eigen::Index p = 0; p < 64; ++p) {
            const auto row = piece.row(p);
            points[static_cast<std::size_t>(p)] =
                numbers.try_emplace({row.begin(), row.end()}, static_cast<Eigen::Index>(numbers.size())).first->second;
        }
    }
    RowsXd all(static_cast<Eigen::Index>(numbers.size()), rows.empty() ? 0 : rows[0].cols());
    for (const auto& [weights, number] : numbers) {
        all.row(number) = Eigen::Map<const Eigen::RowVectorXd>(weights.data(), all.cols());
    }
    pieces.rows = all.sparseView();
    return pieces;
}

}  // namespace subvol::detail
