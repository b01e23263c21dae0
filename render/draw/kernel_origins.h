// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/hex_mesh.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

/// The function with its knots of opacities and of colours moved down.
[[nodiscard]] TransferFunction less(TransferFunction function, const std::array<double, 2>& origins);

/// Moves the values of the opacities and those of the colours down.
void move_down(HexMesh& mesh, const std::array<double, 2>& origins);

/// The value that those of kernels are relative to, in 32-bit floats: the middle of a transfer function's range, where it is so
/// narrow that floats would round away what one sees in it (101325 ± .01); else 0, and values keep their bits.
[[nodiscard]] double origin_for(double low, double high);

}  // namespace subvol::detail
