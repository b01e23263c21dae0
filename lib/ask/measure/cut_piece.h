// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "box_polynomial.h"
#include "subvol/limit_level.h"
#include "subvol/region.h"

namespace subvol::detail {

/// A box in the parameters of a piece, [0,1]³.
struct PieceBox {
    Vec3 lower{0.0}, upper{1.0};

    [[nodiscard]] Vec3 at(const Vec3& in_box) const { return lower + in_box * (upper - lower); }
    [[nodiscard]] double volume() const { return (upper.x - lower.x) * (upper.y - lower.y) * (upper.z - lower.z); }
};

/// A place of a piece with what it counts for in an integral over the piece's parameters.
struct PieceNode {
    Vec3 at;
    double weight;
};

/// One face of a region over a box of a piece.
struct FaceInBox {
    /// Linear in the place, so exact; for a sphere the depth behind a plane that touches it: never less than the sphere's
    BoxPolynomial depth;
    const Region* sphere;  ///< null for a plane
};

/// How parts of space cut a piece of the limit. All statements are proved for the piece, as a polynomial lies between its
/// Bézier coefficients.
class CutPiece {
public:
    /// regions: referred to, parts of space
    explicit CutPiece(std::span<const Region> regions) : regions_(regions) {}

    void take(const LimitPieces& pieces, std::size_t piece);

    enum class Place { Outside, Inside, Cut };
    /// Shrinks a box to what may lie in the regions.
    [[nodiscard]] Place narrow(PieceBox& box) const;

    /// The faces that cut a box. touching: in [0,1]³ of the box, where the planes that stand for a sphere touch it
    [[nodiscard]] std::vector<FaceInBox> faces_in(const PieceBox& box, const Vec3& touching) const;

    /// How far inside all regions a place of the piece lies (world).
    [[nodiscard]] double depth_at(const Vec3& at) const { return depth(regions_, place_at(at)); }
    [[nodiscard]] Vec3 place_at(const Vec3& at) const;
    /// Of the place by the parameters, column by column.
    [[nodiscard]] Mat3 jacobian_at(const Vec3& at) const;

    /// The points of Gauss in the part of a box that lies in the regions. The box is cut into lines; where these cross a face
    /// is calculated, and so is where the face leaves the box, line by line and plane by plane:
    ///
    ///     ┌──────────┐    The points lie between the faces, whatever the distance of these. What is left as an error is a
    ///     │· · ╱     │    part of the boxes with edges between two faces, and with places where a face turns away from
    ///     │· ·╱      │    all lines.
    ///     │· ╱       │
    ///     └──────────┘
    ///
    /// returns: the part of the lines that meet the regions: where it is small, the box is too large for them
    [[nodiscard]] double add_nodes(const PieceBox& box, std::vector<PieceNode>& nodes) const;

private:
    struct Lines;

    [[nodiscard]] std::array<BoxPolynomial, 3> position_in(const PieceBox& box) const;
    [[nodiscard]] BoxPolynomial depth_in(const std::array<BoxPolynomial, 3>& position, const Region& region,
                                         std::size_t face) const;

    std::span<const Region> regions_;
    Vec3 origin_{0.0};
    std::array<BoxPolynomial, 3> position_{};  // from the origin
};

}  // namespace subvol::detail
