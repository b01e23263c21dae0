// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/hex_mesh.h"

namespace subvol::model {

/// Whether a parameter lies in [-1,1]³, without tolerance.
[[nodiscard]] bool in_block(const Vec3& parameter);

/// A regular block of cells on the parameters [-1,1]³, point ids x fastest.
[[nodiscard]] HexMesh parameter_block(const std::array<Index, 3>& cells);

/// The mesh of each model that is not a Solid; resolution as make_model has checked it.
[[nodiscard]] HexMesh make_twist(Index resolution);
[[nodiscard]] HexMesh make_ball(Index resolution);
[[nodiscard]] HexMesh make_nozzle(Index resolution);

}  // namespace subvol::model
