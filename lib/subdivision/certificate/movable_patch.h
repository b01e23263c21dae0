// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/refine.h"
#include "subvol/scheme.h"

namespace subvol::detail {

/// How a point may move.
struct Freedom {
    double edge = 1;   ///< its shortest edge
    double reach = 0;  ///< the longest way from its start; 0 where it stays
    Mat3 weight{1.0};  ///< symmetric; of the way in its edge, squared
    bool on_boundary = false;
};

/// Bad cells are to become sound, kept ones to stay sound; those around only shape them.
enum class CellRole : std::uint8_t { Around, Kept, Bad };

struct PatchCell {
    CellRole role = CellRole::Around;
    double share = 0;  ///< part of the cell's volume that the determinants of its children are to be at least
};

/// A part of a mesh whose points move as little as possible,
///
///     min Σ wᵀW w,   w = (x − start) / edge,   so that   d ≥ share
///
/// at all corners of the children of `levels` generations, d being the determinant there as a part of it. What is too small is
/// punished by its square, by Gauss-Newton steps with a weight that grows.
class MovablePatch {
public:
    MovablePatch(const HexMesh& patch, const SchemeOptions& scheme, int levels, std::vector<Vec3> start,
                 std::vector<Freedom> freedom, const std::vector<PatchCell>& cells);

    /// The new points. goes_on: called before each step with the part of the work that is done, 0 to 1; false ends it; may
    /// throw
    [[nodiscard]] std::vector<Vec3> move(const std::function<bool(double)>& goes_on);

    /// What was done so far, in tests of cells that take about as long.
    [[nodiscard]] std::size_t tests() const { return static_cast<std::size_t>(tests_); }

private:
    /// A corner of a child: its points and what its determinant has to be, in `volume`.
    struct Corner {
        std::array<Index, 4> points;
        double volume, least;
    };
    /// A corner that is too small: how its determinant changes with its points.
    struct Active {
        std::size_t corner;
        double lack;
        std::array<Vec3, 4> gradient;
    };

    /// The change of the points of active corners with the points that move, in edges.
    struct ActiveMatrix {
        CsrMatrix matrix, transpose;
        std::vector<std::array<Index, 4>> corners;  ///< the rows of each corner's points
    };

    [[nodiscard]] std::vector<Vec3> fine(const std::vector<Vec3>& points) const;
    [[nodiscard]] std::vector<Active> lacking(const std::vector<Vec3>& points) const;
    [[nodiscard]] double cost(const std::vector<Vec3>& points, const std::vector<Active>& lacks, double weight) const;
    [[nodiscard]] std::vector<Vec3> step(const std::vector<Vec3>& points, const std::vector<Active>& lacks, double weight);
    [[nodiscard]] ActiveMatrix matrix_of(const std::vector<Active>& lacks) const;
    void make_corners(const HexMesh& patch, const std::vector<PatchCell>& cells);

    RefinementTables tables_;
    std::vector<CsrMatrix> rows_;  // of the tables
    std::vector<Vec3> points_, start_;
    std::vector<Freedom> freedom_;
    std::vector<Corner> corners_;
    double tests_ = 0;
};

}  // namespace subvol::detail
