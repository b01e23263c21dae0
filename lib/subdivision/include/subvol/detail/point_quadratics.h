// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "subvol/mixed_mesh.h"

namespace subvol::detail {

/// The points at the other ends of the edges, and of the shortest diagonals of octahedra, of each point.
class PointNeighbors {
public:
    explicit PointNeighbors(const MixedMesh& mesh);

    template <class Call>
    void each(Index p, const Call& call) const {
        for (std::size_t i = offsets_[p]; i < offsets_[p + 1]; ++i) call(pairs_[i][1]);
    }

private:
    std::vector<std::size_t> offsets_;
    std::vector<std::array<Index, 2>> pairs_;  // of a point and a neighbour, sorted
};

/// The quadratic f + g·d + ½ dᵀHd around a point.
struct PointQuadratic {
    Vec3 gradient{0.0};              ///< g, world⁻¹
    std::array<double, 6> second{};  ///< H as xx, xy, xz, yy, yz, zz, world⁻²
};

/// The quadratics with the least sum of squares at the neighbours of a point p, each weighted by 1/|d|²; where there are fewer
/// than 14, at theirs too.
///
/// found: one for each channel of each attribute; 0 where the neighbours are all at the point
void fit_quadratics(const MixedMesh& mesh, const PointNeighbors& neighbors, Index p, std::vector<PointQuadratic>& found);

}  // namespace subvol::detail
