// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Locates points in one hexahedron. A point is inside if one of the six tetrahedra of `split_cell` contains it, so that
/// neighbouring cells agree. Its parameters are found by inverting the trilinear map, or, where that fails, the linear map of
/// the tetrahedron. Left-handed, folded and flat cells are allowed; tetrahedra without volume contain nothing.
class CellLocator {
public:
    CellLocator(const HexMesh& mesh, Index cell);

    /// The first tetrahedron that contains x (world), including its faces up to rounding errors.
    [[nodiscard]] std::optional<std::size_t> find_tetrahedron(const Vec3& x) const;

    /// The weights of the 8 corners at x, which sum to 1. Near a bent face some may be outside [0,1].
    [[nodiscard]] std::array<double, 8> weights(std::size_t tetrahedron, const Vec3& x) const;

    /// The gradient with respect to world position of the field with these values at the 8 corners.
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
