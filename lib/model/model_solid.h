// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "model_deformation.h"
#include "model_shapes.h"
#include "subvol/hex_mesh.h"
#include "subvol/model.h"

namespace subvol::model {

/// A solid in a block of lattice cells that is then deformed.
///
/// distance:    like a signed distance, positive inside, of a place in the straight block
/// transition:  the density is tanh(distance / transition)
/// half:        half the block's edges; the lattice has about cubic cells
/// main:        the axis along which the resolution counts cells
/// deformation: of the straight block; its Jacobian is positive there
struct Solid {
    double (*distance)(const Vec3& q);
    double transition;
    Vec3 half;
    int main;
    std::span<const Deformation> deformation;
};

// Most solids are drawn in the cells of their default lattice: a length of 1 is a cell. The density goes from -.76 to .76 over
// four of them, and edges are rounded, so that the lattice resolves a surface; parts are at least three cells thick.
inline constexpr double kCellTransition = 1.9;
inline constexpr Blend kCellBlend{.rounding = 0.64};

/// resolution: cells along solid.main; the others in proportion, at least 1
[[nodiscard]] HexMesh make_solid(const Solid& solid, Index resolution);

}  // namespace subvol::model
