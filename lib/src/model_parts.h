#pragma once

#include <array>

#include "subvol/hex_mesh.h"

namespace subvol::model {

/// A block of parameters [-1,1]³, twisted about its z axis, then bent along an arc in the xz plane; the inverse is closed.
///
/// half_width: of the square cross-section, world
/// twist_rad:  the section at z is turned by twist·(z+1)
/// bend_rad:   the section at z stands at the angle bend·z, < π
/// radius:     of the arc, world
struct BentBlock {
    double half_width;
    double twist_rad;
    double bend_rad;
    double radius;

    [[nodiscard]] Vec3 position(const Vec3& parameter) const;
    [[nodiscard]] Vec3 parameter(const Vec3& x) const;
};

/// Whether a parameter lies in [-1,1]³, without tolerance.
[[nodiscard]] bool in_block(const Vec3& parameter);

/// A regular block of cells on the parameters [-1,1]³, point ids x fastest.
[[nodiscard]] HexMesh parameter_block(const std::array<Index, 3>& cells);

/// The mesh of each model; resolution as make_model has checked it.
[[nodiscard]] HexMesh make_twist(Index resolution);
[[nodiscard]] HexMesh make_pawn(Index resolution);
[[nodiscard]] HexMesh make_ball(Index resolution);

}  // namespace subvol::model
