// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Where points lie in one hexahedron. Its six tetrahedra (`split_cell`) decide what is inside, so neighbours agree; within,
/// the place is the inverse of the trilinear map, or of the tetrahedron's linear one where that has no clear inverse.
/// Left-handed, folded and flat cells are allowed; tetrahedra without volume hold nothing.
class CellLocator {
public:
    CellLocator(const HexMesh& mesh, Index cell);

    /// The first tetrahedron that holds x (world), faces included to the rounding of the arithmetic.
    [[nodiscard]] std::optional<std::size_t> find_tetrahedron(const Vec3& x) const;

    /// The weights of the 8 corners at x, which sum to 1. Close to a bent face some may leave [0,1].
    [[nodiscard]] std::array<double, 8> weights(std::size_t tetrahedron, const Vec3& x) const;

    /// The gradient by world position of what has these values at the 8 corners.
    [[nodiscard]] Vec3 gradient(std::size_t tetrahedron, const Vec3& x, const std::array<double, 8>& values) const;

private:
    // Barycentric coordinate k > 0 of p (relative to the cell's origin) is gradients[k-1] · (p - corner 0).
    struct Tetrahedron {
        std::array<std::size_t, 4> corners;
        Vec3 first;
        std::array<Vec3, 3> gradients;
        double tolerance;

        [[nodiscard]] std::array<double, 4> barycentric(const Vec3& p) const;
        [[nodiscard]] bool holds(const Vec3& p) const;
    };

    void add_tetrahedron(const std::array<std::size_t, 4>& corners);
    [[nodiscard]] Vec3 position(const Vec3& uvw) const;
    [[nodiscard]] Mat3 jacobian(const Vec3& uvw) const;
    [[nodiscard]] std::optional<Vec3> invert(const Vec3& start, const Vec3& p) const;
    [[nodiscard]] std::optional<Vec3> parameters_at(const Tetrahedron& tetrahedron, const Vec3& p) const;

    Vec3 origin_;
    double size_ = 0;                 // the longest side of the bounding box
    std::array<Vec3, 8> corners_;     // relative to the origin
    std::array<Vec3, 8> polynomial_;  // of 1, u, v, w, uv, vw, wu, uvw
    std::array<Tetrahedron, 6> tetrahedra_;
    std::size_t tetrahedron_count_ = 0;
};

}  // namespace subvol::detail
